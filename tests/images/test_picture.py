"""Picture files: exact values, errors for bad files, atomic writes."""

from __future__ import annotations

import os
import struct
import time
import types
import zlib
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from basrelief import images
from basrelief.errors import InputError
from basrelief.images import (
    encode_png,
    picture_size,
    read_picture,
    srgb_decode,
    srgb_encode,
    write_data,
    write_picture,
)


def ramp(height: int = 5, width: int = 7, channels: int = 3) -> np.ndarray:
    """Every texel and channel differs, all within 0 to 1."""
    count = height * width * channels
    return (np.arange(count, dtype=np.float32) / count).reshape(height, width, channels)


def png(width: int, height: int, kind: int, bits: int, rows: bytes, *extra: bytes) -> bytes:
    """A PNG file made by hand, so that tests do not depend on the writer that they test."""

    def chunk(name: bytes, body: bytes) -> bytes:
        check = struct.pack(">I", zlib.crc32(name + body))
        return struct.pack(">I", len(body)) + name + body + check

    head = struct.pack(">IIBBBBB", width, height, bits, kind, 0, 0, 0)
    others = b"".join(chunk(each[:4], each[4:]) for each in extra)
    data = chunk(b"IDAT", zlib.compress(rows))
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + others + data + chunk(b"IEND", b"")


# --- the sRGB curve


def test_srgb_has_the_values_of_the_standard() -> None:
    linear = np.array([0.0, 0.0031308, 0.18, 0.5, 1.0])
    by_hand = [0.0, 0.04044994, 0.46135613, 0.73535698, 1.0]
    assert srgb_encode(linear) == pytest.approx(by_hand, abs=1e-7)


def test_srgb_decode_inverts_every_eight_bit_code() -> None:
    codes = np.arange(256)
    there_and_back = srgb_encode(srgb_decode(codes / 255)) * 255
    assert np.abs(there_and_back - codes).max() < 1e-4


# --- reading


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16])
@pytest.mark.parametrize("channels", [1, 2, 3, 4])
@pytest.mark.parametrize("suffix", [".png", ".tif"])
def test_integers_keep_every_bit(tmp_path: Path, dtype: type, channels: int, suffix: str) -> None:
    most = np.iinfo(dtype).max
    pixels = np.random.default_rng(1).integers(0, most, (5, 7, channels), dtype, endpoint=True)
    back = read_picture(write_data(tmp_path / f"a{suffix}", pixels))
    assert back.pixels.dtype == dtype
    assert (back.pixels == pixels).all()


@pytest.mark.parametrize("suffix", [".exr", ".tif"])
def test_floats_keep_every_bit(tmp_path: Path, suffix: str) -> None:
    pixels = (ramp(channels=3) * 40 - 20).astype(np.float32)
    back = read_picture(write_data(tmp_path / f"a{suffix}", pixels))
    assert back.pixels.dtype == np.float32
    assert (back.pixels == pixels).all()


def test_half_floats_become_float32(tmp_path: Path) -> None:
    back = read_picture(write_picture(tmp_path / "a.exr", ramp(), bits=16))
    assert back.pixels.dtype == np.float32
    assert (back.pixels == ramp().astype(np.float16).astype(np.float32)).all()


def test_palette_is_expanded(tmp_path: Path) -> None:
    palette = b"PLTE" + bytes([10, 20, 30, 200, 100, 50])
    file = tmp_path / "palette.png"
    file.write_bytes(png(3, 2, 3, 8, b"\0\0\1\0" + b"\0\1\1\0", palette))
    pixels = read_picture(file).pixels
    assert pixels.shape == (2, 3, 3)
    assert pixels[0, 1].tolist() == [200, 100, 50]
    assert pixels[1, 2].tolist() == [10, 20, 30]


def test_alpha_is_neither_multiplied_nor_divided(tmp_path: Path) -> None:
    file = tmp_path / "alpha.png"
    file.write_bytes(png(2, 1, 6, 8, b"\0" + bytes([200, 100, 50, 0, 8, 4, 2, 16])))
    back = read_picture(file)
    assert back.pixels[0].tolist() == [[200, 100, 50, 0], [8, 4, 2, 16]]
    assert back.channels == ("R", "G", "B", "A")
    assert back.alpha is not None
    assert back.alpha[0].tolist() == [[0], [16]]
    assert back.opaque.shape == (1, 2, 3)


def test_a_gamma_chunk_changes_nothing(tmp_path: Path) -> None:
    file = tmp_path / "gamma.png"
    file.write_bytes(png(2, 1, 0, 8, b"\0\x40\x80", b"gAMA" + struct.pack(">I", 100000)))
    assert read_picture(file).pixels.ravel().tolist() == [0x40, 0x80]


@pytest.mark.parametrize(
    ("orientation", "corner"),
    [
        (1, (0, 0)),
        (2, (0, 6)),
        (3, (4, 6)),
        (4, (4, 0)),
        (5, (0, 0)),
        (6, (0, 4)),
        (7, (6, 4)),
        (8, (6, 0)),
    ],
)
def test_orientation_is_applied(tmp_path: Path, orientation: int, corner: tuple[int, int]) -> None:
    """The stored top left texel moves to the corner that TIFF 6.0 names for row 0, column 0."""
    import OpenImageIO

    pixels = np.zeros((5, 7, 1), np.uint8)
    pixels[0, 0] = 255
    spec = OpenImageIO.ImageSpec(7, 5, 1, "uint8")
    spec.attribute("Orientation", orientation)
    file = tmp_path / "rotated.tif"
    out = OpenImageIO.ImageOutput.create(str(file))
    assert out.open(str(file), spec)
    assert out.write_image(pixels)
    assert out.close()
    out.geterror()
    upright = read_picture(file).pixels
    assert upright.shape[:2] == ((5, 7) if orientation < 5 else (7, 5))
    assert np.argwhere(upright[:, :, 0]).tolist() == [list(corner)]


def test_size_is_read_from_the_header(tmp_path: Path) -> None:
    size = picture_size(write_data(tmp_path / "a.png", np.zeros((5, 7, 4), np.uint16)))
    assert (size.width, size.height, size.channels, size.bits) == (7, 5, 4, 16)


def test_missing_file_and_folder_are_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"none\.png: there is no such file"):
        read_picture(tmp_path / "none.png")
    with pytest.raises(InputError, match="is a folder"):
        read_picture(tmp_path)
    with pytest.raises(InputError, match="there is no such file"):
        read_picture("x" * 5000 + ".png")


@pytest.mark.parametrize("content", [b"", b"hello", b"\x89PNG\r\n\x1a\n", b"\xff\xd8\xff"])
@pytest.mark.parametrize("suffix", [".png", ".jpg", ".exr", ".tif", ".tga"])
def test_files_that_are_not_pictures_are_refused(
    tmp_path: Path, content: bytes, suffix: str
) -> None:
    file = tmp_path / f"a{suffix}"
    file.write_bytes(content)
    with pytest.raises(InputError, match=rf"a\{suffix}: .*(not a picture|damaged)") as caught:
        read_picture(file)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("suffix", [".png", ".jpg", ".exr", ".hdr", ".tif", ".webp"])
@pytest.mark.parametrize("share", [0.02, 0.3, 0.6, 0.9])
def test_cut_off_pictures_are_refused(tmp_path: Path, suffix: str, share: float) -> None:
    noise = np.random.default_rng(0).random((40, 50, 3), dtype=np.float32)
    file = write_picture(tmp_path / f"a{suffix}", noise)
    file.write_bytes(file.read_bytes()[: int(share * file.stat().st_size)])
    with pytest.raises(InputError, match=r"damaged|not a picture"):
        read_picture(file)


def test_a_damaged_png_prints_nothing(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    file = write_picture(tmp_path / "a.png", ramp(40, 50))
    content = bytearray(file.read_bytes())
    content[len(content) // 2] ^= 0x55
    file.write_bytes(content)
    with pytest.raises(InputError, match="checksum"):
        read_picture(file)
    assert capfd.readouterr() == ("", "")


@settings(
    max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(
    suffix=st.sampled_from([".png", ".jpg", ".exr", ".hdr", ".tif", ".webp"]),
    hits=st.lists(st.tuples(st.floats(0, 1), st.integers(0, 255)), min_size=1, max_size=6),
    length=st.floats(0, 1),
)
def test_damaged_files_give_a_picture_or_one_clear_line(
    tmp_path: Path, suffix: str, hits: list[tuple[float, int]], length: float
) -> None:
    """Bytes after the header are changed, and the end may be missing."""
    whole = tmp_path / f"whole{suffix}"
    if not whole.exists():
        write_picture(whole, ramp(9, 11))
    content = bytearray(whole.read_bytes())
    start = min(64, len(content) - 1)  # an absurd size in the header is a memory error
    for where, value in hits:
        content[start + int(where * (len(content) - 1 - start))] = value
    file = tmp_path / f"damaged{suffix}"
    file.write_bytes(content[: max(1, int((0.5 + length) * len(content)))])
    problem = ""
    try:
        problem = "" if read_picture(file).pixels.size else "no pixels"
    except InputError as error:
        problem = str(error).replace(str(file), "", 1)
        assert len(problem) < len(str(error)), "the file is not named"  # noqa: PT017
    assert "\n" not in problem
    assert problem != "no pixels"


# --- writing


def test_png_is_encoded_and_rounded_to_the_nearest(tmp_path: Path) -> None:
    codes = np.arange(256)
    between = srgb_decode((codes[:-1] + np.array([[0.49], [0.51]])) / 255)
    light = np.repeat(between[:, :, None], 3, axis=2).astype(np.float32)
    stored = read_picture(write_picture(tmp_path / "a.png", light)).pixels
    assert (stored[0, :, 0] == codes[:-1]).all()
    assert (stored[1, :, 0] == codes[1:]).all()


def test_16_bits_are_encoded_the_same_way(tmp_path: Path) -> None:
    light = ramp()
    stored = read_picture(write_picture(tmp_path / "a.png", light, bits=16)).pixels
    assert stored.dtype == np.uint16
    assert np.abs(srgb_decode(stored / 65535) - light).max() < 2e-5


def test_alpha_is_stored_straight_and_unencoded(tmp_path: Path) -> None:
    light = np.full((1, 1, 4), 0.5, np.float32)
    stored = read_picture(write_picture(tmp_path / "a.png", light)).pixels
    assert stored[0, 0].tolist() == [188, 188, 188, 128]


def test_out_of_range_light_is_clipped_and_nan_is_black(tmp_path: Path) -> None:
    light = np.array([[[-1, 2, np.nan], [np.inf, -np.inf, 1]]], np.float32)
    stored = read_picture(write_picture(tmp_path / "a.png", light)).pixels
    assert stored[0].tolist() == [[0, 255, 0], [255, 0, 255]]


@pytest.mark.parametrize(
    ("suffix", "bits", "near"), [(".exr", 32, 0), (".exr", 16, 1e-3), (".tif", 32, 0)]
)
def test_float_formats_are_linear(tmp_path: Path, suffix: str, bits: int, near: float) -> None:
    light = ramp() * 3
    stored = read_picture(write_picture(tmp_path / f"a{suffix}", light, bits=bits)).pixels
    assert np.abs(stored - light).max() <= near * 3


def test_hdr_stays_linear_and_drops_alpha(tmp_path: Path) -> None:
    light = ramp(channels=4) + np.float32(0.5)
    stored = read_picture(write_picture(tmp_path / "a.hdr", light)).pixels
    assert stored == pytest.approx(light[:, :, :3], rel=0.01)


def test_exr_alpha_is_multiplied_in(tmp_path: Path) -> None:
    light = np.full((1, 1, 4), 0.5, np.float32)
    stored = read_picture(write_picture(tmp_path / "a.exr", light, bits=32)).pixels
    assert stored[0, 0].tolist() == [0.25, 0.25, 0.25, 0.5]
    assert (light == 0.5).all()


@pytest.mark.parametrize("suffix", [".jpg", ".JPEG", ".webp"])
def test_lossy_formats_come_close(tmp_path: Path, suffix: str) -> None:
    light = np.zeros((64, 96, 4), np.float32)
    light[:, :, 0] = np.linspace(0, 1, 96)
    light[:, :, 1] = np.linspace(1, 0, 64)[:, None]
    light[:, :, 3] = 1
    stored = read_picture(write_picture(tmp_path / f"a{suffix}", light)).opaque / 255
    assert np.abs(stored - srgb_encode(light[:, :, :3])).mean() < 0.01


def test_quality_changes_a_jpeg(tmp_path: Path) -> None:
    noise = np.random.default_rng(0).random((64, 64, 3), dtype=np.float32)
    small = write_picture(tmp_path / "a.jpg", noise, quality=20).stat().st_size
    assert small < write_picture(tmp_path / "b.jpg", noise, quality=98).stat().st_size / 2


def test_same_pixels_make_the_same_bytes_at_another_time(tmp_path: Path) -> None:
    files = [tmp_path / f"a{suffix}" for suffix in images.WRITABLE]
    before = [write_picture(file, ramp()).read_bytes() for file in files]
    time.sleep(1.1)  # files that hold the time of writing hold it in seconds
    after = [write_picture(file, ramp()).read_bytes() for file in files]
    changed = [file.name for file, one, two in zip(files, before, after, strict=True) if one != two]
    assert changed == []


def test_png_bytes_are_those_of_the_file(tmp_path: Path) -> None:
    assert encode_png(ramp()) == write_picture(tmp_path / "a.png", ramp()).read_bytes()


def test_unknown_suffix_lists_the_known(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"\.xyz.*\.png.*\.exr"):
        write_picture(tmp_path / "a.xyz", ramp())
    with pytest.raises(InputError, match="without suffix"):
        write_picture(tmp_path / "a", ramp())


@pytest.mark.parametrize(
    ("name", "options"),
    [("a.png", {"bits": 32}), ("a.jpg", {"bits": 16}), ("a.jpg", {"quality": 0})],
)
def test_impossible_settings_are_refused(
    tmp_path: Path, name: str, options: dict[str, int]
) -> None:
    with pytest.raises(InputError, match=r"bits|quality"):
        write_picture(tmp_path / name, ramp(), **options)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("shape", [(4, 4), (4, 4, 2), (4, 4, 5), (0, 4, 3)])
def test_impossible_arrays_are_refused(tmp_path: Path, shape: tuple[int, ...]) -> None:
    with pytest.raises(InputError, match="channels"):
        write_picture(tmp_path / "a.png", np.zeros(shape, np.float32))


def test_data_is_written_only_to_formats_that_store_it(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"\.png"):
        write_data(tmp_path / "a.jpg", np.zeros((2, 2, 1), np.uint8))
    with pytest.raises(InputError, match=r"\.exr"):
        write_data(tmp_path / "a.png", np.zeros((2, 2, 1), np.float32))
    with pytest.raises(InputError, match="int64"):
        write_data(tmp_path / "a.png", np.zeros((2, 2, 1), np.int64))


def test_paths_that_cannot_be_written_are_named(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    (tmp_path / "folder.png").mkdir()
    for place in ("none/a.png", "file/a.png"):
        with pytest.raises(InputError, match="does not exist"):
            write_picture(tmp_path / place, ramp())
    with pytest.raises(InputError, match="is a folder"):
        write_picture(tmp_path / "folder.png", ramp())
    with pytest.raises(InputError, match="cannot be written"):
        write_picture(tmp_path / f"{'x' * 300}.png", ramp())
    assert len(list(tmp_path.iterdir())) == 2


@pytest.mark.parametrize("problem", [OSError("full"), KeyboardInterrupt()])
def test_a_write_that_fails_leaves_the_old_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, problem: BaseException
) -> None:
    file = tmp_path / "a.png"
    file.write_text("old")

    def half(path: Path, _: bytes) -> None:
        path.write_text("half")
        raise problem

    monkeypatch.setattr(Path, "write_bytes", half)
    expected = InputError if isinstance(problem, OSError) else KeyboardInterrupt
    with pytest.raises(expected):
        write_picture(file, ramp())
    assert file.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [file]


def test_a_new_file_replaces_the_old(tmp_path: Path) -> None:
    file = tmp_path / "a.png"
    file.write_bytes(b"old")
    write_picture(file, ramp())
    assert read_picture(file).pixels.shape == (5, 7, 3)
    assert list(tmp_path.iterdir()) == [file]


@pytest.mark.parametrize("suffix", [".png", ".jpg", ".webp", ".exr", ".hdr", ".tif"])
def test_files_without_files_in_memory_are_the_same(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, suffix: str
) -> None:
    """As on macOS and Windows, by a temporary file, which has to have room."""
    first = write_picture(tmp_path / f"first{suffix}", ramp()).read_bytes()
    monkeypatch.delattr(os, "memfd_create", raising=False)
    assert write_picture(tmp_path / f"second{suffix}", ramp()).read_bytes() == first
    monkeypatch.setattr("shutil.disk_usage", lambda _: types.SimpleNamespace(free=1 << 10))
    with pytest.raises(InputError, match="no space left"):
        write_picture(tmp_path / f"third{suffix}", ramp())
    assert len(list(tmp_path.iterdir())) == 2


def test_a_gif_without_transparency_is_read(tmp_path: Path) -> None:
    """One red pixel; OpenImageIO names an alpha that the picture does not have."""
    colors = bytes([255, 0, 0, 0, 255, 0])
    head = b"GIF89a\x01\x00\x01\x00\x80\x00\x00" + colors
    (tmp_path / "a.gif").write_bytes(head + b",\0\0\0\0\x01\0\x01\0\0\x02\x02D\x01\0;")
    picture = read_picture(tmp_path / "a.gif")
    assert picture.opaque[0, 0].tolist() == [255, 0, 0]
