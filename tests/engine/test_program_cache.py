"""Cached programs: read again, recompiled when damaged, compiled without a usable folder."""

from __future__ import annotations

import hashlib
import os
import subprocess
import sys

import numpy as np
import pytest

from basrelief.engine import cache
from basrelief.engine import cpu as cpu_module
from basrelief.engine.cpu import CpuEngine
from basrelief.lang import Buffer
from basrelief.lang.program import Program
from helpers.comparing import write_module

SOURCE = """
@struct
class Result:
    x: float
    n: int

@struct
class Settings:
    gain: float

@shader
def entry(pixel: IVec2, settings: Settings) -> Result:
    total = 0.0
    for k in range(pixel.x % 7):
        if k == pixel.y:
            break
        total = total + sin(float(k) * settings.gain) / float(pixel.y + 1)
    return Result(total, pixel.x * pixel.y)
"""


@pytest.fixture(scope="module")
def module(folder):
    return write_module(folder, SOURCE)


@pytest.fixture
def place(tmp_path, monkeypatch):
    """Path of an empty cache folder, which does not exist yet."""
    folder = tmp_path / "deep" / "cache"
    monkeypatch.setenv("BASRELIEF_CACHE", str(folder))
    return folder


@pytest.fixture
def compilations(monkeypatch):
    """Keys of the programs that are compiled instead of read from the cache."""
    done: list[str] = []
    compiling = cpu_module._object_code

    def counted(program, lanes):
        done.append(program.key)
        return compiling(program, lanes)

    monkeypatch.setattr(cpu_module, "_object_code", counted)
    return done


def run(module, lanes=8, threads=1, size=(9, 4)):
    engine = CpuEngine(lanes=lanes, threads=threads)
    planes = engine.run(Program(module.entry), {"settings": module.Settings(0.7)}, size)
    return {name: plane.tobytes() for name, plane in planes.items()}


def test_a_program_is_compiled_once(module, place, compilations):
    first = run(module)
    assert len(list(place.iterdir())) == 1
    assert run(module) == first
    assert len(compilations) == 1
    run(module, lanes=4)
    assert len(compilations) == 2


def test_programs_age_out(module, place, compilations, monkeypatch):
    """Programs of an older version are removed like any that are not used."""
    run(module, lanes=8)
    (used,) = place.iterdir()
    older = place / cache.key_of("cpu", "an older version")
    size = used.stat().st_size
    older.write_bytes(bytes(10 * size))
    os.utime(used, (1000, 1000))
    os.utime(older, (2000, 2000))
    monkeypatch.setattr(cache, "LIMIT", 11 * size)
    run(module, lanes=8)  # read, so used last
    run(module, lanes=4)
    run(module, lanes=16)
    assert not older.exists()
    assert used.exists()
    run(module, lanes=8)
    assert len(compilations) == 3


def flip_a_bit(raw: bytes) -> bytes:
    middle = len(raw) // 2
    return raw[:middle] + bytes([raw[middle] ^ 16]) + raw[middle + 1 :]


def with_digest(rest: bytes) -> bytes:
    return hashlib.sha256(rest).digest() + rest


DAMAGE = {
    "truncated": lambda raw: raw[: len(raw) // 2],
    "cut short by one": lambda raw: raw[:-1],
    "empty": lambda raw: b"",
    "a few bytes": lambda raw: raw[:7],
    "one bit flipped": flip_a_bit,
    "first bit flipped": lambda raw: bytes([raw[0] ^ 1]) + raw[1:],
    "appended to": lambda raw: raw + b"\0",
    "a header that is no JSON": lambda raw: with_digest(b"no json\n" + raw[40:]),
    "no header at all": lambda raw: with_digest(b""),
    "zeros": lambda raw: bytes(len(raw)),
}


@pytest.mark.parametrize("damage", DAMAGE)
def test_a_damaged_entry_is_compiled_again(module, place, compilations, damage):
    whole = run(module)
    (entry,) = place.iterdir()
    raw = entry.read_bytes()
    entry.write_bytes(DAMAGE[damage](raw))
    assert run(module) == whole
    assert len(compilations) == 2
    assert entry.read_bytes() == raw
    assert len(list(place.iterdir())) == 1


def test_an_entry_that_is_a_folder(module, place, compilations):
    whole = run(module)
    (entry,) = place.iterdir()
    entry.unlink()
    entry.mkdir()
    assert run(module) == whole
    assert list(place.iterdir()) == [entry]


def test_a_path_that_is_a_file(module, tmp_path, monkeypatch):
    file = tmp_path / "file"
    file.write_text("not a folder")
    for path in (file, file / "below"):
        monkeypatch.setenv("BASRELIEF_CACHE", str(path))
        assert run(module)
    assert file.read_text() == "not a folder"


@pytest.mark.skipif(not hasattr(os, "geteuid"), reason="needs the permissions of POSIX")
def test_a_folder_that_cannot_be_written(module, place, compilations, monkeypatch):
    whole = run(module)
    (entry,) = place.iterdir()
    before = entry.read_bytes()

    def refused(*_args, **_options):
        raise PermissionError("read-only")

    # the superuser may write anywhere, so the refusal is simulated
    monkeypatch.setattr(cache.tempfile, "mkstemp", refused)
    assert run(module) == whole
    assert len(compilations) == 1
    assert run(module, lanes=4)
    assert len(compilations) == 2
    assert [p.read_bytes() for p in place.iterdir()] == [before]


def test_a_full_disk_leaves_no_incomplete_entry(place, monkeypatch):
    class Full:
        def __enter__(self):
            return self

        def __exit__(self, *_):
            return False

        def write(self, _):
            raise OSError(28, "no space left on device")

    def opened(handle, _mode):
        os.close(handle)
        return Full()

    monkeypatch.setattr(cache.os, "fdopen", opened)
    cache.write("key", {}, b"content")
    assert list(place.iterdir()) == []
    assert cache.read("key") is None


def test_an_interrupt_leaves_no_incomplete_entry_either(place, monkeypatch):
    def interrupted(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(cache.os, "replace", interrupted)
    with pytest.raises(KeyboardInterrupt):
        cache.write("key", {}, b"content")
    assert list(place.iterdir()) == []


def test_content_is_read_as_written(place):
    content = bytes(range(256)) * 3 + b"\n\n"
    cache.write("key", {"parameters": ["a\nb", "ü"]}, content)
    assert cache.read("key") == ({"parameters": ["a\nb", "ü"]}, content)
    assert cache.read("another") is None


def test_processes_at_once(folder, place):
    """Several processes compile one program at the same time: one entry, one result."""
    write_module(folder, SOURCE, "cached_source")
    script = """
import hashlib
import cached_source as m
from basrelief.engine.cpu import CpuEngine
from basrelief.lang.program import Program
planes = CpuEngine(8, 1).run(Program(m.entry), {"settings": m.Settings(0.7)}, (9, 4))
print(hashlib.sha256(b"".join(p.tobytes() for p in planes.values())).hexdigest())
"""
    environment = {"PYTHONPATH": str(folder), "BASRELIEF_CACHE": str(place)}
    running = [
        subprocess.Popen(
            [sys.executable, "-c", script], env=environment, stdout=subprocess.PIPE, text=True
        )
        for _ in range(3)
    ]
    results = {process.communicate(timeout=60)[0] for process in running}
    assert all(process.returncode == 0 for process in running)
    assert len(results) == 1
    assert len(results.pop()) == 65
    (entry,) = place.iterdir()
    assert entry.name.startswith("cpu-")


# --- determinism --------------------------------------------------------------------------------


@pytest.mark.parametrize("size", [(1, 1), (5, 3), (67, 19)])
def test_the_same_bytes_for_all_lanes_and_threads(module, size):
    results = {
        tuple(run(module, lanes, threads, size).items())
        for lanes in (4, 8, 16)
        for threads in (1, 2, 3)
    }
    assert len(results) == 1


def test_rows_equal_those_of_the_whole_picture(module):
    engine, size = CpuEngine(8, 2), (13, 67)
    program, values = Program(module.entry), {"settings": module.Settings(0.7)}
    whole = engine.run(program, values, size)
    rows = engine.run(program, values, size, (9, 31))
    for name, plane in whole.items():
        np.testing.assert_array_equal(rows[name], plane[9:31])


def test_values_that_are_missing_or_wrong(module):
    from basrelief.errors import DeviceError

    engine = CpuEngine(8, 1)
    program = Program(module.entry)
    with pytest.raises(DeviceError, match="entry needs a value for settings"):
        engine.run(program, {}, (1, 1))
    with pytest.raises(DeviceError, match="settings: expected Settings, not Buffer"):
        engine.run(program, {"settings": Buffer([module.Settings(1.0)])}, (1, 1))
