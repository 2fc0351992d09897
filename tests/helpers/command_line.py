"""Runs of the command line in tests, and folders of maps as its input."""

from __future__ import annotations

import contextlib
import io
import os
import signal
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple
from unittest import mock

import numpy as np
import pytest

import basrelief
from basrelief.cli.main import main
from basrelief.engine.cache import cache_folder
from basrelief.images import write_data

COMMAND = [sys.executable, "-m", "basrelief.cli"]
FILE_NAMES = {
    "base_color": "Color",
    "normal": "NormalGL",
    "height": "Height",
    "occlusion": "AmbientOcclusion",
    "roughness": "Roughness",
    "metallic": "Metalness",
    "emission": "Emission",
    "opacity": "Opacity",
}


class Outcome(NamedTuple):
    """Exit code and output of a command."""

    code: int
    out: str
    err: str


def run(*arguments: str | Path) -> Outcome:
    """Run a command in this process."""
    out, err = io.StringIO(), io.StringIO()
    with (
        mock.patch.object(sys, "argv", ["basrelief", *map(str, arguments)]),
        mock.patch.dict(os.environ, environment()),
        contextlib.redirect_stdout(out),
        contextlib.redirect_stderr(err),
        pytest.raises(SystemExit) as end,
    ):
        main()
    assert isinstance(end.value.code, int)
    return Outcome(end.value.code, out.getvalue(), err.getvalue())


def interruptible() -> None:
    """Let Ctrl-C stop a child process, even if the tests run in the background."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def done(*arguments: str | Path) -> str:
    """Output of a command that has to succeed."""
    outcome = run(*arguments)
    assert outcome.code == 0, outcome.err
    return outcome.out


def refused(*arguments: str | Path) -> str:
    """The error message of a command that has to fail: one line, and two of an excerpt if any."""
    outcome = run(*arguments)
    assert outcome.code == 2, outcome
    assert outcome.out == ""
    assert outcome.err.startswith("basrelief: ")
    assert outcome.err.endswith("\n")
    _, *excerpt = outcome.err.splitlines()
    assert not excerpt or (len(excerpt) == 2 and all(e.startswith("    ") for e in excerpt))
    return outcome.err.removeprefix("basrelief: ").rstrip()


def run_apart(*arguments: str | Path, **variables: str) -> subprocess.CompletedProcess[str]:
    """Run a command in a separate process."""
    return subprocess.run(
        [*COMMAND, *map(str, arguments)],
        capture_output=True,
        text=True,
        env={**os.environ, **environment(), **variables},
        timeout=120,
    )


def environment() -> dict[str, str]:
    """Environment with the shared cache of all tests and their processes."""
    return {"BASRELIEF_CACHE": str(cache_folder())}


def write_map(folder: Path, kind: str, pixels: np.ndarray, name: str = "wall") -> Path:
    """Write a map under a file name that identifies it."""
    suffix = "exr" if pixels.dtype == np.float32 else "png"
    return write_data(folder / f"{name}_{FILE_NAMES[kind]}.{suffix}", pixels)


def write_material(folder: Path, size: int = 24) -> Path:
    """Write a folder with all eight maps."""
    folder.mkdir()
    maps = {kind: each.pixels for kind, each in basrelief.sample("tiles", size).maps()}
    maps["height"] = maps["height"] // 2 + 5000  # leaves room for --stretch-height
    noise = np.random.default_rng(3)
    maps["metallic"] = noise.integers(0, 90, (size, size, 1), np.uint8)
    maps["emission"] = noise.integers(0, 40, (size, size, 3), np.uint8)
    maps["opacity"] = noise.integers(150, 255, (size, size, 1), np.uint8)
    for kind, pixels in maps.items():
        write_map(folder, kind, pixels)
    return folder


def write_heights(folder: Path, pixels: np.ndarray | None = None) -> Path:
    """Write a folder with only a height map."""
    folder.mkdir()
    if pixels is None:
        pixels = np.random.default_rng(5).integers(0, 65535, (6, 8, 1), np.uint16)
    write_map(folder, "height", pixels)
    return folder
