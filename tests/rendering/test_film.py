"""Films decode to the drawn frames: number, rate, colours, transparency, and atomic writing."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
import tracemalloc
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import psutil
import pytest

import basrelief
from basrelief.engine import choose_device
from basrelief.errors import InputError
from basrelief.images import encode_light, read_picture, srgb_decode
from basrelief.material import describe
from basrelief.rendering.film import check_film, frames, write_film
from basrelief.rendering.frame import Frame
from basrelief.scene import BACKGROUND, Object, Orbit, Scene
from basrelief.scene.motion import Lighting, Orbiting, Scrolling
from helpers.command_line import (
    COMMAND,
    done,
    environment,
    interruptible,
    refused,
    run,
    write_heights,
)

SIZE = (48, 30)
COUNT = 7
FAST = {"size": (32, 20), "samples": 1, "device": "cpu"}
DRAW = ("--size", "32x20", "--samples", "1", "--device", "cpu")


# --- frames made by hand --------------------------------------------------------------------------


def frame(color: np.ndarray) -> Frame:
    height, width = color.shape[:2]
    return Frame(
        color.astype(np.float32),
        np.ones((height, width), np.float32),
        np.zeros((height, width, 2), np.float32),
        np.ones((height, width), np.bool_),
        np.zeros((height, width), np.int32),
        "made up",
    )


def gradient(number: int, count: int = COUNT, size: tuple[int, int] = SIZE) -> np.ndarray:
    """Red grows to the right, green downwards, blue with time; the top left corner is orange."""
    width, height = size
    codes = np.empty((height, width, 3))
    # never halfway between two codes, where the result would depend on the last bit
    codes[:, :, 0] = np.linspace(25.4, 229.4, width)
    codes[:, :, 1] = np.linspace(51.0, 178.4, height)[:, None]
    codes[:, :, 2] = 38.25 + 153.0 * number / count
    codes[:8, :12] = (229.4, 114.75, 25.4)
    return np.dstack([srgb_decode(codes / 255.0), np.ones((height, width))])


def with_hole(number: int) -> np.ndarray:
    """The gradient with a transparent corner and a half-transparent strip."""
    color = gradient(number)
    color[16:, :20, 3] = 0.0
    color[16:, 20:26, 3] = 0.5
    return color


class ReadFilm(NamedTuple):
    """A decoded film: its pictures in sRGB, (…, 4), and their durations in seconds."""

    pictures: list[np.ndarray]
    seconds: list[float]


def read_film(path: Path) -> ReadFilm:
    return read_webp(path) if path.suffix == ".webp" else read_video(path)


def read_video(path: Path) -> ReadFilm:
    """Decode with FFmpeg by the colour tags of the file."""
    import av

    with av.open(str(path)) as file:
        coded = list(file.decode(video=0))
    # swscale: bicubic, with interpolated chroma and rounding
    pictures = [each.reformat(format="rgba", interpolation=0x42004).to_ndarray() for each in coded]
    return ReadFilm(pictures, [float(each.duration * each.time_base) for each in coded])


def read_webp(path: Path) -> ReadFilm:
    """Decode from the chunks of the file (RFC 9649, 2024), each frame as a still picture."""
    data = path.read_bytes()
    assert (data[:4], data[8:12]) == (b"RIFF", b"WEBP")
    found = dict(chunks(data[12:], but=b"ANMF"))
    width, height = (1 + int.from_bytes(found[b"VP8X"][k : k + 3], "little") for k in (4, 7))
    assert found[b"ANIM"][4:] == b"\0\0"  # loops without end
    canvas, film = np.zeros((height, width, 4)), ReadFilm([], [])
    for name, body in chunks(data[12:]):
        if name == b"ANMF":
            left, top, w, h, ms = (
                int.from_bytes(body[k : k + 3], "little") for k in range(0, 15, 3)
            )
            area = np.s_[2 * top : 2 * top + h + 1, 2 * left : 2 * left + w + 1]
            composite_onto(
                canvas[area], read_still(body[16:], path.with_suffix(".part.webp")), body[15]
            )
            film.pictures.append(np.rint(canvas).astype(np.uint8))
            film.seconds.append(ms / 1000)
            if body[15] & 1:
                canvas[area] = 0.0
    return film


def composite_onto(area: np.ndarray, picture: np.ndarray, flags: int) -> None:
    share = np.ones_like(picture[:, :, 3:]) if flags & 2 else picture[:, :, 3:] / 255.0
    area[:] = picture * share + area * (1.0 - share)


def chunks(data: bytes, but: bytes = b"") -> Iterator[tuple[bytes, bytes]]:
    while data:
        length = int.from_bytes(data[4:8], "little")
        if data[:4] != but:
            yield data[:4], data[8 : 8 + length]
        data = data[8 + length + length % 2 :]


def read_still(body: bytes, file: Path) -> np.ndarray:
    """Decode the contents of an ANMF chunk as a still picture."""
    inside = dict(chunks(body))
    head = b""
    if b"ALPH" in inside:
        # 0x10: it has an alpha; the size is that of the VP8 key frame, 14 bits each at byte 6
        sides = [int.from_bytes(inside[b"VP8 "][k : k + 2], "little") & 0x3FFF for k in (6, 8)]
        head = b"VP8X\x0a\0\0\0\x10\0\0\0" + b"".join((s - 1).to_bytes(3, "little") for s in sides)
    file.write_bytes(b"RIFF" + (4 + len(head + body)).to_bytes(4, "little") + b"WEBP" + head + body)
    pixels = read_picture(file).pixels
    file.unlink()
    opaque = np.full((*pixels.shape[:2], 1), 255, np.uint8)
    return pixels if pixels.shape[2] == 4 else np.concatenate([pixels, opaque], 2)


# --- colours, sizes, rates ------------------------------------------------------------------------

CLOSE = {".mp4": (5.5, 8), ".gif": (12.0, 25), ".webp": (5.5, 8)}
"""Tolerances of colours in 255ths, on average and for 90 % of the pixels; the others are near the
corner, whose chroma is blurred. A flipped picture is off by 59 on average, the next frame by 20. A
GIF of so many colours is the worst case."""


@pytest.mark.parametrize("suffix", CLOSE)
@pytest.mark.parametrize("fps", [10.0, 30.0, 12.5])
def test_a_film_reads_back(suffix: str, fps: float, tmp_path: Path) -> None:
    path = tmp_path / f"film{suffix}"
    made = write_film(path, [frame(gradient(k)) for k in range(COUNT)], fps)
    assert (made.files, made.device) == ((path,), "made up")
    assert os.listdir(tmp_path) == [path.name]
    film = read_film(path)
    assert len(film.pictures) == COUNT
    tick = 0.01 if suffix == ".gif" else 0.001
    assert film.seconds == pytest.approx([1 / fps] * COUNT, abs=tick)
    assert sum(film.seconds) == pytest.approx(COUNT / fps, abs=0.6 * tick)
    mean, most = CLOSE[suffix]
    for number, picture in enumerate(film.pictures):
        assert picture.shape == (SIZE[1], SIZE[0], 4)
        off = np.abs(picture.astype(int) - encode_light(gradient(number)))
        assert off.mean((0, 1)).max() < mean
        assert np.percentile(off, 90) < most
        assert (picture[:, :, 3] == 255).all()


def test_mp4_tags_its_colours(tmp_path: Path) -> None:
    """In areas of constant chroma, colours match the still picture to 8-bit rounding."""
    import av

    even = np.empty((32, 48, 4))
    even[:] = (0.2, 0.5, 0.05, 1.0)
    even[:, 24:] = (0.7, 0.1, 0.3, 1.0)
    path = write_film(tmp_path / "a.mp4", [frame(even)] * 5, 30.0, quality=100).files[0]
    with av.open(str(path)) as file:
        codec: Any = file.streams.video[0].codec_context
        # ITU-T H.273: BT.709 primaries, the transfer of sRGB, the BT.709 matrix, limited range
        assert codec.color_primaries == codec.colorspace == 1
        assert (codec.color_trc, codec.color_range, codec.pix_fmt) == (13, 1, "yuv420p")
    data = path.read_bytes()
    assert data[data.index(b"nclx") + 4 :][:7] == b"\0\1\0\x0d\0\1\0"
    assert data.index(b"moov") < data.index(b"mdat")
    off = read_video(path).pictures[2].astype(int) - encode_light(even)
    assert np.abs(off[4:-4, [*range(4, 20), *range(28, 44)]]).max() <= 3


def test_quality_makes_smaller_films(tmp_path: Path) -> None:
    for suffix in (".mp4", ".webp"):
        size = {}
        for quality in (20, 90):
            path = tmp_path / f"{quality}{suffix}"
            write_film(path, [frame(gradient(k)) for k in range(COUNT)], quality=quality)
            size[quality] = path.stat().st_size
        assert size[20] < size[90]


def test_webp_without_loss(tmp_path: Path) -> None:
    path = write_film(
        tmp_path / "a.webp", [frame(gradient(k)) for k in range(3)], quality=100
    ).files[0]
    for number, picture in enumerate(read_webp(path).pictures):
        assert (picture == encode_light(gradient(number))).all()


def test_gif_loops(tmp_path: Path) -> None:
    path = write_film(tmp_path / "a.gif", [frame(gradient(k)) for k in range(3)]).files[0]
    assert b"NETSCAPE2.0\x03\x01\x00\x00" in path.read_bytes()


# --- transparency ---------------------------------------------------------------------------------


def test_mp4_is_composited_over_the_default_background(tmp_path: Path) -> None:
    path = write_film(tmp_path / "a.mp4", [frame(with_hole(k)) for k in range(3)]).files[0]
    behind = np.array(BACKGROUND)
    expected = encode_light(behind[None, None, :])[0, 0]
    for number, picture in enumerate(read_video(path).pictures):
        assert np.abs(picture[20:, 2:16, :3].astype(int) - expected).max() <= 4
        half = encode_light((gradient(number)[:, :, :3] + behind) / 2.0)
        assert np.abs(picture[20:, 22:24, :3].astype(int) - half[20:, 22:24]).mean() < 6


def test_gif_keeps_holes_and_webp_alpha(tmp_path: Path) -> None:
    drawn = [frame(with_hole(k)) for k in range(3)]
    for picture in read_video(write_film(tmp_path / "a.gif", drawn).files[0]).pictures:
        assert (picture[16:, :20, 3] == 0).all()
        assert (picture[:16, :, 3] == 255).all()
    for picture in read_webp(write_film(tmp_path / "a.webp", drawn).files[0]).pictures:
        assert (picture[:, :, 3] == encode_light(with_hole(0))[:, :, 3]).all()


# --- pictures with numbers ------------------------------------------------------------------------


@pytest.mark.parametrize("suffix", [".png", ".jpg", ".exr"])
def test_pictures_with_numbers(suffix: str, tmp_path: Path) -> None:
    drawn = (frame(gradient(k)) for k in range(3))
    made = write_film(tmp_path / f"a.b{suffix}", drawn, count=3, quality=100)
    assert [file.name for file in made.files] == [f"a.b-000{k}{suffix}" for k in (1, 2, 3)]
    assert sorted(os.listdir(tmp_path)) == [file.name for file in made.files]
    for number, file in enumerate(made.files):
        frame(gradient(number)).save(tmp_path / f"still{suffix}", quality=100)
        assert file.read_bytes() == (tmp_path / f"still{suffix}").read_bytes()


@pytest.mark.parametrize(
    ("count", "first"),
    [
        (9999, "a-0001.png"),
        (10_000, "a-00001.png"),
        (100_000, "a-000001.png"),
        (None, "a-000001.png"),
    ],
)
def test_numbers_sort(count: int | None, first: str, tmp_path: Path) -> None:
    drawn = (frame(gradient(k)) for k in range(1))
    made = write_film(tmp_path / "a.png", drawn, count=count)
    assert made.files[0].name == first


def test_one_frame_is_a_picture(tmp_path: Path) -> None:
    for name in ("a.png", "a.webp"):
        made = write_film(tmp_path / name, [frame(gradient(0))])
        assert made.files == (tmp_path / name,)
        assert read_picture(tmp_path / name).pixels.shape == (SIZE[1], SIZE[0], 3)


# --- whole or not at all --------------------------------------------------------------------------


def failing(error: BaseException) -> Iterator[Frame]:
    yield from (frame(gradient(k)) for k in range(3))
    raise error


@pytest.mark.parametrize("suffix", CLOSE)
@pytest.mark.parametrize("error", [KeyboardInterrupt(), InputError("no"), ZeroDivisionError()])
def test_a_film_that_fails_leaves_nothing(
    error: BaseException, suffix: str, tmp_path: Path
) -> None:
    old = tmp_path / f"old{suffix}"
    old.write_text("old")
    for path in (old, tmp_path / f"new{suffix}"):
        with pytest.raises(type(error)):
            write_film(path, failing(error))
    assert os.listdir(tmp_path) == [old.name]
    assert old.read_text() == "old"


def test_finished_pictures_stay(tmp_path: Path) -> None:
    with pytest.raises(KeyboardInterrupt):
        write_film(tmp_path / "a.png", failing(KeyboardInterrupt()), count=7)
    assert sorted(os.listdir(tmp_path)) == [f"a-000{k}.png" for k in (1, 2, 3)]


def test_a_long_gif_takes_no_more_memory(tmp_path: Path) -> None:
    """Two passes over frames of a quarter of a megabyte keep none in memory."""
    few = [frame(gradient(k, 8, (320, 200))) for k in range(8)]
    memory: list[int] = []

    def drawn() -> Iterator[Frame]:
        for number in range(150):
            memory.append(psutil.Process().memory_info().rss)
            yield few[number % 8]

    write_film(tmp_path / "a.gif", drawn(), count=150)
    assert psutil.Process().memory_info().rss - memory[30] < 15e6


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs Linux's full disk")
@pytest.mark.parametrize("suffix", CLOSE)
def test_a_full_disk(suffix: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("basrelief.rendering.film._ffmpeg_path", lambda path: "/dev/full")
    noise = np.random.default_rng(1).uniform(0.0, 1.0, (9, 64, 64, 4))
    with pytest.raises(InputError, match=r"cannot be written \(.*; choose another place"):
        write_film(tmp_path / f"a{suffix}", [frame(each) for each in noise])
    assert os.listdir(tmp_path) == []


def test_unequal_frames(tmp_path: Path) -> None:
    drawn = [frame(gradient(0)), frame(gradient(0, size=(24, 30)))]
    with pytest.raises(InputError, match="unequal size"):
        write_film(tmp_path / "a.mp4", drawn)
    with pytest.raises(InputError, match="no frames"):
        write_film(tmp_path / "a.mp4", [])
    assert os.listdir(tmp_path) == []


def test_a_name_with_a_colon_is_a_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    write_film("http:a.mp4", [frame(gradient(k)) for k in range(3)])
    assert os.listdir() == ["http:a.mp4"]


# --- drawing --------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def material() -> basrelief.Material:
    return basrelief.sample("bricks", 32)


def test_frames_are_the_pictures_of_their_moments(material: basrelief.Material) -> None:
    scene = Scene((Object(material),), camera=Orbit(20.0, 40.0, 2.0))
    drawn = list(frames(scene, [Orbiting()], count=4, **FAST))
    for number, each in enumerate(drawn):
        still = basrelief.render(scene.with_camera(Orbit(20.0 + 90.0 * number, 40.0, 2.0)), **FAST)
        assert (each.color == still.color).all()
    assert not (drawn[0].color == drawn[1].color).all()


def test_scrolling_shifts_the_maps(material: basrelief.Material) -> None:
    """The maps shift by a quarter of the shape per second."""
    obj = Object(material, shape="cylinder", tiling=(3.0, 1.0))
    start, *_, last = frames(Scene((obj,)), [Scrolling()], count=9, fps=8.0, **FAST)
    moved = Object(material, shape="cylinder", tiling=(3.0, 1.0), shift=(0.75, 0.0))
    assert np.abs(last.color - basrelief.render(Scene((moved,)), **FAST).color).max() < 1e-5
    assert np.abs(last.color - start.color).max() > 0.05


def test_arguments_of_render(material: basrelief.Material) -> None:
    """`frames` takes a material and options as `render` does, and reports progress of the film."""
    shares: list[float] = []
    drawn = frames(
        material, [Lighting()], count=3, technique="steep", progress=shares.append, **FAST
    )
    still = basrelief.render(material, technique="steep", **FAST)
    assert (next(drawn).color == still.color).all()
    assert len(list(drawn)) == 2
    assert shares == sorted(shares)
    assert shares[-1] == pytest.approx(1.0)
    with pytest.raises(InputError, match="no option"):
        frames(material, count=3, colour=2, **FAST)


def test_only_one_frame_is_kept(material: basrelief.Material) -> None:
    """Forty frames of 0.4 MB take the memory of a few."""
    size = (160, 100)
    drawn = frames(material, count=40, size=size, samples=1, device="cpu")
    next(drawn)
    tracemalloc.start()
    for _ in drawn:
        pass
    most = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert most < 8 * 33 * size[0] * size[1]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"count": 0}, "0 frames: give 1 to 100000"),
        ({"count": 100_001}, "100001 frames: give 1 to 100000"),
        ({"count": 3, "fps": 0.0}, "0 frames a second: give 0.1 to 240"),
        ({"count": 3, "fps": 1e9}, "frames a second: give 0.1 to 240"),
        ({"count": 3, "fps": float("nan")}, "nan frames a second"),
        ({"count": 9, "camera": Orbit(0.0, 10.0, 0.3), "shape": "box"}, "inside the box"),
    ],
)
def test_invalid_films_are_refused_on_the_call(
    options: dict[str, Any], message: str, material: basrelief.Material
) -> None:
    with pytest.raises(InputError, match=message):
        frames(material, **options)


def test_a_camera_that_moves_behind_a_plane_is_refused(material: basrelief.Material) -> None:
    """Half a turn around an upright plane ends behind it."""
    from basrelief.scene import rotated

    scene = Scene((Object(material, transform=rotated("y", 0.0)),), camera=Orbit(0.0, 10.0))
    with pytest.raises(InputError, match="behind the plane"):
        frames(scene, count=12)


# --- the command line -----------------------------------------------------------------------------


@pytest.fixture(scope="module")
def bumps(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_heights(tmp_path_factory.mktemp("maps") / "bumps")


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize("file", ["a.mp4", "a.gif", "a.webp"])
def test_a_film_by_command(file: str, bumps: Path, here: Path) -> None:
    printed = done("render", bumps, *DRAW, "--frames", "5", "--fps", "20", "-o", file)
    assert printed == f"{file}  (cpu: {choose_device('cpu').adapter})\n"
    assert os.listdir() == [file]
    film = read_film(Path(file))
    assert (len(film.pictures), film.pictures[0].shape) == (5, (20, 32, 4))
    assert sum(film.seconds) == pytest.approx(0.25, abs=0.002)


def test_pictures_by_command(bumps: Path, here: Path) -> None:
    """The default name is one that `load` does not read as a map."""
    motions = ("--motion", "orbit,turns=-0.5", "--motion", "scroll,u=0,v=0.5")
    printed = done("render", bumps, *DRAW, "--frames", "3", "--fps", "2", *motions)
    names = [f"bumps-relief-basrelief-000{k}.png" for k in (1, 2, 3)]
    assert printed.startswith(f"{names[0]} … {names[2]}  (cpu: ")
    assert sorted(os.listdir()) == names
    material = basrelief.load(bumps)
    drawn = frames(material, [Orbiting(-0.5), Scrolling(0.0, 0.5)], count=3, fps=2.0, **FAST)
    for name, each in zip(names, drawn, strict=True):
        assert (read_picture(name).pixels == encode_light(each.color[:, :, :3])).all()


def test_rendered_pictures_in_a_folder_are_ignored(tmp_path: Path) -> None:
    folder = write_heights(tmp_path / "bumps")
    before = describe(basrelief.load(folder))["maps"]
    done("render", folder, *DRAW, "--frames", "2", "-o", folder / "bumps-relief-basrelief.png")
    assert len(os.listdir(folder)) == 3
    assert describe(basrelief.load(folder))["maps"] == before


def test_a_note_where_transparency_is_lost(bumps: Path, here: Path) -> None:
    arguments = ("render", bumps, *DRAW, "--frames", "2", "--background", "none", "-o")
    outcome = run(*arguments, "a.mp4")
    assert outcome.code == 0
    assert outcome.err.startswith("note: MP4 has no transparency")
    assert run(*arguments, "a.webp").err == ""


REFUSED = {
    "--frames 0": "0 frames: give 1 to 100000",
    "--frames 1000000": "1000000 frames: give 1 to 100000",
    "--frames 3 --fps 0": "0 frames a second: give 0.1 to 240",
    "--frames 3 --fps 1e9": "1e+09 frames a second: give 0.1 to 240",
    "--frames 3 --motion spin": "--motion spin: begin with orbit, light, scroll",
    "--frames 3 --motion scroll,w=1": "--motion scroll: there is no parameter w; there are u, v",
    "--frames 3 --motion light,turns=1e9": "turns is 1e+09: give a number from -1000 to 1000",
    "--motion orbit": "--motion orbit: a single picture has no motion; add --frames 120",
    "-o a.mp4": "a.mp4: a film has more than one picture; give it more, as --frames 120",
    "--frames 3 -o a.mov": "a.mov: .mov names no film; use one of .mp4 .gif .webp .png",
    "--frames 3 -o a": "a: no suffix names no film; use one of .mp4 .gif .webp .png",
    "--frames 3 -o a.mp4 --size 33x20": "a.mp4: sides are even in .mp4 films; take the size 34x20",
    "--frames 3 -o a.webp --size 20000x2": "a.webp: .webp films are at most 16383 pixels a side",
    "--frames 3 -o a.gif --fps 60": "a.gif: .gif films show at most 50 frames a second",
    "--frames 3 -o a.mp4 --bits 16": "a.mp4: .mp4 films hold 8 bits a channel, not 16",
    "--frames 3 -o no/a.gif": "no/a.gif: the folder no does not exist; make it first",
    "--frames 3 -o no/a.png": "no/a-0001.png: the folder no does not exist; make it first",
    "--frames 3 -o a.mp4 --samples 0": "0 samples a pixel: give 1 to 1024",
}


@pytest.mark.parametrize("arguments", REFUSED)
def test_invalid_films_are_refused(arguments: str, bumps: Path, here: Path) -> None:
    line = refused("render", bumps, *DRAW, *arguments.split())
    assert line.startswith(REFUSED[arguments])
    assert os.listdir() == []


def test_without_pyav(bumps: Path, here: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "av", None)
    for file in ("a.mp4", "a.gif", "a.webp"):
        line = refused("render", bumps, *DRAW, "--frames", "3", "-o", file)
        assert line.startswith(f"{file}: {file[1:]} films need PyAV")
        assert "pip install 'basrelief[film]'" in line
        assert "numbered pictures" in line
    assert os.listdir() == []
    done("render", bumps, *DRAW, "--frames", "2", "-o", "a.png")
    done("render", bumps, *DRAW, "-o", "a.webp")


def test_without_the_codec(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("av.codecs_available", {"gif"})
    check_film(tmp_path / "a.gif", 3, 30.0, SIZE)
    with pytest.raises(InputError, match="built without libx264"):
        check_film(tmp_path / "a.mp4", 3, 30.0, SIZE)


def test_ctrl_c(bumps: Path, here: Path) -> None:
    """Interrupt a long film after its first bytes are on disk."""
    arguments = ("render", bumps, *DRAW, "--frames", "100000")
    with subprocess.Popen(
        [*COMMAND, *map(str, arguments), "-o", "a.mp4"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        env={**os.environ, **environment()},
        start_new_session=True,
        preexec_fn=interruptible,
    ) as process:
        while not os.listdir() and process.poll() is None:
            time.sleep(0.01)
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=60)
    assert (process.returncode, out) == (130, b"")
    assert err == b"basrelief: interrupted; no unfinished file is left\n"
    assert os.listdir() == []


@pytest.mark.parametrize("suffix", [".png", ".exr"])
def test_a_frame_may_change_once_it_is_taken(suffix: str, tmp_path: Path) -> None:
    """One frame in several colours, as numbered pictures, which threads write."""
    same = frame(gradient(0))

    def shades() -> Iterator[Frame]:
        for number in range(8):
            same.color[:, :, :3] = number / 8
            yield same

    files = write_film(tmp_path / f"a{suffix}", shades(), count=8).files
    shown = [float(read_picture(file).pixels[0, 0, 0]) for file in files]
    wanted = encode_light(np.full((1, 8, 3), np.arange(8)[None, :, None] / 8))[0, :, 0]
    assert shown == pytest.approx(wanted if suffix == ".png" else np.arange(8) / 8)


def test_what_is_no_frame_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="a film is of Frames, not of ndarray"):
        write_film(tmp_path / "a.mp4", [np.zeros((4, 4, 3))] * 3)  # type: ignore[list-item]
    with pytest.raises(InputError, match="give them as a list"):
        write_film(tmp_path / "a.mp4", frame(gradient(0)))  # type: ignore[arg-type]
