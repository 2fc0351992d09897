"""Films: a scene in motion drawn frame by frame, and its files.

    moving = frames("materials/rock", [Orbiting()], count=120)
    write_film("rock.mp4", moving, count=120)

Numbered pictures need nothing more; MP4, GIF and animated WebP need PyAV, the extra `film`.
"""

from __future__ import annotations

import itertools
import operator
import tempfile
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from basrelief.engine import Engine
from basrelief.errors import InputError
from basrelief.images import WRITABLE, check_place, check_target, encode_light, write_whole
from basrelief.material import Material
from basrelief.rendering.frame import Frame
from basrelief.rendering.render import Progress, render, scene_of
from basrelief.scene import BACKGROUND, Object, Scene
from basrelief.scene.motion import Moment, Motion, Orbiting, apply_motions

__all__ = ["FILMS", "Written", "check_film", "frames", "write_film"]

Light = NDArray[np.float32]
"""A picture, (height, width, 4), linear, alpha last and not multiplied in."""

_MOST_FRAMES = 100_000
"""Almost an hour at 30 frames a second."""
_MOST_A_SECOND = 240.0
"""Faster than screens show."""
_CHECKED = 360
"""Moments at which the camera is looked at before the first frame is drawn."""


# --- drawing -------------------------------------------------------------------------------------


def frames(
    what: Scene | Object | Material | str | Path,
    motions: Sequence[Motion] = (Orbiting(),),
    *,
    count: int,
    fps: float = 30.0,
    size: tuple[int, int] = (1280, 720),
    samples: int = 4,
    device: str | Engine = "auto",
    progress: Progress | None = None,
    **options: Any,
) -> Iterator[Frame]:
    """Draw the frames of a film, each when it is asked for; no more than one is kept.

    `count` frames, 1 to 100 000, `fps` of them a second, up to 240. `motions` act one after the
    other on the scene; all else is as in `render`. `progress` is called with the share, 0 to 1,
    of the whole film. Raises InputError at once for what can be known at once, a camera that
    comes into an object among it.
    """
    _check_count(count)
    seconds = 1.0 / float(_rate(fps))
    scene = scene_of(what, options)

    def at(number: int) -> Scene:
        return apply_motions(scene, motions, Moment(number / count, number * seconds, size))

    for number in range(0, count, -(-count // _CHECKED)):
        at(number).check_camera()

    def drawn() -> Iterator[Frame]:
        for number in range(count):
            told = _share_of_all(progress, number, count)
            yield render(at(number), size=size, samples=samples, device=device, progress=told)

    return drawn()


def _share_of_all(progress: Progress | None, number: int, count: int) -> Progress | None:
    return progress and (lambda share: progress((number + share) / count))


def _check_count(count: int) -> None:
    if not 1 <= count <= _MOST_FRAMES:
        raise InputError(f"{count} frames: give 1 to {_MOST_FRAMES}")


def _rate(fps: float) -> Fraction:
    """Frames a second as films count them: 29.97 is 30 000 ÷ 1001."""
    if not 0.1 <= fps <= _MOST_A_SECOND:
        raise InputError(f"{fps:g} frames a second: give 0.1 to {_MOST_A_SECOND:g}")
    return Fraction(fps).limit_denominator(1001)


# --- writing -------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Written:
    """The files of a film in their order, one for a film as such, and the device that drew it."""

    files: tuple[Path, ...]
    device: str


@dataclass(frozen=True)
class _Film:
    """What a kind of film file can hold, and how it is written.

    `codec` is FFmpeg's name. `write` gets the file, its pictures, their size, the rate, and the
    quality, 1 to 100.
    """

    codec: str
    write: Callable[[Path, Iterator[Light], tuple[int, int], Fraction, int], None]
    longest_side: int
    fastest: float = _MOST_A_SECOND
    even: bool = False


def write_film(
    path: str | Path,
    frames: Iterable[Frame],
    fps: float = 30.0,
    *,
    count: int | None = None,
    bits: int | None = None,
    quality: int = 95,
) -> Written:
    """Write a film as the suffix says.

    `.mp4` (H.264), `.gif` and `.webp` are one file, written whole or not at all; those two loop for
    ever. Any other suffix is that of `Image.save`: pictures with numbers from 1, rock-0001.png and
    on, each whole; those that were done stay when the next fails. They have four digits, or as
    many as `count` needs (six where it is not said). Where `count` is 1, a `.webp` too is a
    picture, and none has a number.

    Colours are those of `Image.save`. MP4 has no transparency: frames are laid over `BACKGROUND`,
    and tagged as sRGB in BT.709, one colour for two by two pixels. GIF has 256 colours for the
    whole film, and pixels that are seen or not. `bits` are those of pictures; `quality` is 1 to
    100 (WebP at 100 is lossless).

    Raises InputError as `check_film` does, for frames of unequal size, and for a place that cannot
    be written.
    """
    path = Path(path)
    known = count if count is not None else operator.length_hint(frames)
    shown = iter(frames)
    first = next(shown, None)
    if first is None:
        raise InputError(f"{path}: a film of no frames; give one or more")
    size = (first.distance.shape[1], first.distance.shape[0])
    check_film(path, known or _MOST_FRAMES, fps, size, bits=bits, quality=quality)
    shown = itertools.chain([first], shown)
    kind = _film_for(path, known)
    if kind is None:
        files = _write_numbered(path, shown, known, bits=bits, quality=quality)
        return Written(files, first.device)
    pictures = _pictures(shown, size, path)
    write_whole(path, lambda partial: _through_av(kind, partial, pictures, size, fps, quality))
    return Written((path,), first.device)


def check_film(
    path: str | Path,
    count: int,
    fps: float,
    size: tuple[int, int],
    *,
    bits: int | None = None,
    quality: int = 95,
) -> None:
    """Raise InputError where `write_film` would refuse: before the work, not after.

    For a number of frames or a rate out of range, a suffix that names no format, a size that the
    format cannot hold (H.264 has even sides), PyAV that is missing, a folder that cannot be
    written.
    """
    path = Path(path)
    _check_count(count)
    rate = _rate(fps)
    kind = _film_for(path, count)
    suffix = path.suffix
    if kind is None:
        if count > 1 and suffix.lower() not in WRITABLE:
            known = " ".join(dict.fromkeys([*FILMS, *WRITABLE]))
            raise InputError(f"{path}: {suffix or 'no suffix'} names no film; use one of {known}")
        check_target(_numbered(path, 1, count), bits)
        return
    if count == 1:
        raise InputError(f"{path}: a film has more than one picture; give it more, as --frames 120")
    if bits not in (None, 8):
        raise InputError(f"{path}: {suffix} films hold 8 bits a channel, not {bits}")
    if not 1 <= quality <= 100:
        raise InputError(f"{path}: quality is 1 to 100, not {quality}")
    if max(size) > kind.longest_side:
        raise InputError(f"{path}: {suffix} films are at most {kind.longest_side} pixels a side")
    if kind.even and (size[0] % 2 or size[1] % 2):
        even = "x".join(str(side + side % 2) for side in size)
        raise InputError(f"{path}: sides are even in {suffix} films; take the size {even}")
    if rate > kind.fastest:
        raise InputError(f"{path}: {suffix} films show at most {kind.fastest:g} frames a second")
    _check_av(path, kind)
    check_place(path)


def _film_for(path: Path, count: int) -> _Film | None:
    """The kind of film that a path names, or None for pictures; one WebP frame is a picture."""
    suffix = path.suffix.lower()
    return None if suffix == ".webp" and count == 1 else FILMS.get(suffix)


def _check_av(path: Path, kind: _Film) -> None:
    try:
        import av
    except ImportError:
        raise InputError(
            f"{path}: {path.suffix} films need PyAV; pip install 'basrelief[film]', "
            "or write numbered pictures, as film.png"
        ) from None
    if kind.codec not in av.codecs_available:
        raise InputError(
            f"{path}: PyAV is built without {kind.codec} here; install its wheel: "
            "pip install --only-binary av 'basrelief[film]'"
        )


def _write_numbered(
    path: Path, shown: Iterator[Frame], count: int, *, bits: int | None, quality: int
) -> tuple[Path, ...]:
    return tuple(
        frame.save(_numbered(path, number, count), bits=bits, quality=quality)
        for number, frame in enumerate(shown, 1)
    )


def _numbered(path: Path, number: int, count: int) -> Path:
    """A frame's own name; names sort as their numbers do."""
    if count == 1:
        return path
    digits = max(4, len(str(count or _MOST_FRAMES)))
    return path.with_name(f"{path.stem}-{number:0{digits}d}{path.suffix}")


def _pictures(shown: Iterator[Frame], size: tuple[int, int], path: Path) -> Iterator[Light]:
    """What the frames show, all of one size."""
    for frame in shown:
        if frame.distance.shape != (size[1], size[0]):
            raise InputError(f"{path}: frames of unequal size make no film")
        yield frame.color


def _through_av(
    kind: _Film,
    partial: Path,
    pictures: Iterator[Light],
    size: tuple[int, int],
    fps: float,
    quality: int,
) -> None:
    """Write a film; what FFmpeg complains about is the file's trouble."""
    import av

    try:
        kind.write(partial, pictures, size, _rate(fps), quality)
    except av.FFmpegError as error:
        raise OSError(error.errno, error.strerror) from error


# --- MP4 -----------------------------------------------------------------------------------------

_BT709, _SRGB = 1, 13
"""Primaries and matrix; transfer: ITU-T H.273, Coding-independent code points, tables 2 to 4."""
_LIMITED, _FULL = 1, 2
"""FFmpeg's AVColorRange: luma 16 to 235, and 0 to 255."""
_EXACT_SCALING = 0x4 | 0x4000 | 0x40000
"""swscale: bicubic, chroma read at every pixel, rounded and not cut."""


def _write_mp4(
    path: Path, pictures: Iterator[Light], size: tuple[int, int], rate: Fraction, quality: int
) -> None:
    import av

    # x264's own scale, 51 the worst; 17, at the default of 95, is hard to tell from the original
    options = {"crf": f"{51.0 - 0.36 * quality:g}"}
    # the index goes before the pictures, so that a browser plays while it loads
    with av.open(_plain(path), "w", format="mp4", options={"movflags": "+faststart"}) as file:
        stream: Any = file.add_stream("libx264", rate=rate, options=options)
        stream.width, stream.height, stream.pix_fmt = *size, "yuv420p"
        codec = stream.codec_context
        codec.time_base = Fraction(1, rate.numerator)
        codec.color_primaries = codec.colorspace = _BT709
        codec.color_trc, codec.color_range = _SRGB, _LIMITED
        for number, picture in enumerate(pictures):
            frame = _frame(encode_light(_opaque(picture)), number, rate, codec.time_base)
            # the range is said by hand: swscale would take RGB for RGB, but YUV for any
            coded = frame.reformat(
                format="yuv420p", dst_colorspace=_BT709, interpolation=_EXACT_SCALING,
                src_color_range=_FULL, dst_color_range=_LIMITED,
            )  # fmt: skip
            file.mux(stream.encode(coded))
        file.mux(stream.encode(None))


def _opaque(picture: Light) -> Light:
    """The picture over the usual background."""
    alpha = picture[:, :, 3:]
    return picture[:, :, :3] * alpha + np.array(BACKGROUND, np.float32) * (1 - alpha)


# --- GIF -----------------------------------------------------------------------------------------

_HUNDREDTH = Fraction(1, 100)
"""GIF89a counts time in these."""


def _write_gif(
    path: Path, pictures: Iterator[Light], size: tuple[int, int], rate: Fraction, quality: int
) -> None:
    """Twice over the pictures, to find the palette and to use it; between, they lie on the disk."""
    import av

    with (
        tempfile.TemporaryFile(dir=path.parent) as kept,
        av.open(_plain(path), "w", format="gif", options={"loop": "0"}) as file,
    ):
        stream: Any = file.add_stream("gif", rate=rate)
        stream.width, stream.height, stream.pix_fmt = *size, "pal8"
        stream.codec_context.time_base = _HUNDREDTH
        palette = _palette(pictures, size, rate, kept)
        for frame in _with_palette(palette, _read_back(kept, size), size, rate):
            file.mux(stream.encode(frame))
        file.mux(stream.encode(None))


def _palette(
    pictures: Iterator[Light], size: tuple[int, int], rate: Fraction, kept: IO[bytes]
) -> Any:
    """The 256 colours that suit all pictures best, by median cut; the pictures go to `kept`."""
    graph, (source,) = _graph(size, "palettegen")
    for number, picture in enumerate(pictures):
        codes = encode_light(picture)
        kept.write(codes.tobytes())
        source.push(_frame(codes, number, rate, _HUNDREDTH))
        # asked for what it cannot have yet, the filter takes the picture in and lets it go
        list(_pulled(graph))
    source.push(None)
    palette = graph.pull().reformat(format="rgba")
    palette.pts, palette.time_base = 0, _HUNDREDTH
    return palette


def _with_palette(
    palette: Any, stored: Iterator[NDArray[np.uint8]], size: tuple[int, int], rate: Fraction
) -> Iterator[Any]:
    """The pictures in the colours of a palette, what lies between them scattered."""
    # an ordered pattern stands still where the picture does; scattered errors would swarm
    graph, (source, colors) = _graph(size, "paletteuse", "dither=bayer:bayer_scale=3", (16, 16))
    colors.push(palette)
    colors.push(None)
    for number, codes in enumerate(stored):
        source.push(_frame(codes, number, rate, _HUNDREDTH))
        yield from _pulled(graph)
    source.push(None)
    yield from _pulled(graph)


def _graph(
    size: tuple[int, int], name: str, options: str = "", *others: tuple[int, int]
) -> tuple[Any, list[Any]]:
    """One filter of FFmpeg's with a source for each of its pictures, and a sink."""
    import av.filter

    graph = av.filter.Graph()
    made, sink = graph.add(name, options), graph.add("buffersink")
    sources = [
        graph.add_buffer(width=width, height=height, format="rgba", time_base=_HUNDREDTH)
        for width, height in (size, *others)
    ]
    for number, source in enumerate(sources):
        source.link_to(made, 0, number)
    made.link_to(sink)
    graph.configure()
    return graph, sources


def _pulled(graph: Any) -> Iterator[Any]:
    """What a filter has ready."""
    import av

    while True:
        try:
            yield graph.pull()
        except (av.BlockingIOError, av.EOFError):
            return


def _read_back(kept: IO[bytes], size: tuple[int, int]) -> Iterator[NDArray[np.uint8]]:
    width, height = size
    kept.seek(0)
    while stored := kept.read(width * height * 4):
        yield np.frombuffer(stored, np.uint8).reshape(height, width, 4)


# --- WebP ----------------------------------------------------------------------------------------

_THOUSANDTH = Fraction(1, 1000)
"""WebP counts time in these."""


def _write_webp(
    path: Path, pictures: Iterator[Light], size: tuple[int, int], rate: Fraction, quality: int
) -> None:
    import av

    options = {"quality": f"{quality}", "lossless": f"{int(quality == 100)}"}
    with av.open(_plain(path), "w", format="webp", options={"loop": "0"}) as file:
        stream: Any = file.add_stream("libwebp_anim", rate=rate, options=options)
        stream.width, stream.height, stream.pix_fmt = *size, "bgra"
        stream.codec_context.time_base = _THOUSANDTH
        for number, picture in enumerate(pictures):
            frame = _frame(encode_light(picture), number, rate, _THOUSANDTH)
            file.mux(stream.encode(frame.reformat(format="bgra")))
        file.mux(stream.encode(None))


# --- what they share -----------------------------------------------------------------------------


def _frame(codes: NDArray[Any], number: int, rate: Fraction, tick: Fraction) -> Any:
    """A picture in sRGB, (height, width, 3 or 4), for FFmpeg, at its time in ticks."""
    import av

    layout = {3: "rgb24", 4: "rgba"}[codes.shape[2]]
    made: Any = av.VideoFrame.from_ndarray(np.ascontiguousarray(codes), layout)
    made.time_base = tick
    made.pts = round(number / rate / tick)
    made.duration = round((number + 1) / rate / tick) - made.pts
    return made


def _plain(path: Path) -> str:
    """A path that FFmpeg takes for no address, whatever colons are in it."""
    return str(path.absolute())


FILMS = {
    ".mp4": _Film("libx264", _write_mp4, longest_side=16384, even=True),
    # browsers slow a GIF down whose pictures stay less than two hundredths of a second
    ".gif": _Film("gif", _write_gif, longest_side=65535, fastest=50.0),
    ".webp": _Film("libwebp_anim", _write_webp, longest_side=16383),
}
"""Suffixes that are films, and how they are written."""
