"""Films: a scene in motion, drawn frame by frame, and its files.

    moving = frames("materials/rock", [Orbiting()], count=120)
    write_film("rock.mp4", moving, count=120)

MP4, GIF and animated WebP need PyAV, the extra `film`; numbered pictures do not.
"""

from __future__ import annotations

import itertools
import operator
import tempfile
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import IO, Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from basrelief.engine import Engine
from basrelief.errors import InputError
from basrelief.images import WRITABLE, check_target, check_writable, write_whole
from basrelief.material import Material
from basrelief.rendering.frame import Frame
from basrelief.rendering.render import Progress, render, scene_of
from basrelief.rendering.video import video_picture
from basrelief.scene import Object, Scene
from basrelief.scene.motion import Moment, Motion, Orbiting, apply_motions
from basrelief.timings import step

__all__ = ["FILMS", "FilmFiles", "check_film", "frames", "write_film"]

_T = TypeVar("_T")
_MAX_FRAMES = 100_000
"""Almost an hour at 30 frames a second."""
_MAX_FPS = 240.0
"""Above the refresh rate of common screens."""
_CHECKED_MOMENTS = 360
"""Largest number of moments at which the camera is checked before the first frame is drawn."""
_WRITERS = 4
"""Number of pictures that are written at once."""


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
    """Draw the frames of a film lazily; no more than one is kept in memory.

    Parameters
    ----------
    what : Scene, Object, Material, path or str
        Initial scene, as for `render`.
    motions : sequence of Motion, default (Orbiting(),)
        Motions, applied one after the other.
    count : int
        Number of frames, 1 to 100 000.
    fps : float, default 30.0
        Frames per second, 0.1 to 240.
    size : (int, int), default (1280, 720)
        Width and height in pixels.
    samples : int, default 4
        Samples per pixel, 1 to 1024.
    device : {"auto", "cpu", "gpu"} or Engine, default "auto"
        Device that draws.
    progress : callable, optional
        Called with the finished fraction of the film, 0 to 1.
    **options
        Options of `Object` and `Scene`, and `preset`, as for `render`.

    Returns
    -------
    iterator of Frame

    Raises
    ------
    InputError
        On the call, before any frame is drawn: for values out of range, and for a camera that moves
        into an object.
    """
    _check_count(count)
    seconds = 1.0 / float(_rate(fps))
    scene = scene_of(what, options)

    def scene_at(number: int) -> Scene:
        return apply_motions(scene, motions, Moment(number / count, number * seconds, size))

    for number in range(0, count, -(-count // _CHECKED_MOMENTS)):
        scene_at(number).check_camera()

    def generate() -> Iterator[Frame]:
        for number in range(count):
            frame_progress = _frame_progress(progress, number, count)
            yield render(
                scene_at(number), size=size, samples=samples, device=device, progress=frame_progress
            )

    return generate()


def _frame_progress(progress: Progress | None, number: int, count: int) -> Progress | None:
    return progress and (lambda share: progress((number + share) / count))


def _check_count(count: int) -> None:
    if not 1 <= count <= _MAX_FRAMES:
        raise InputError(f"{count} frames: give 1 to {_MAX_FRAMES}")


def _rate(fps: float) -> Fraction:
    """Frame rate as a fraction, as film formats store it: 29.97 becomes 30 000 ÷ 1001."""
    if not 0.1 <= fps <= _MAX_FPS:
        raise InputError(f"{fps:g} frames a second: give 0.1 to {_MAX_FPS:g}")
    return Fraction(fps).limit_denominator(1001)


# --- writing -------------------------------------------------------------------------------------


@dataclass(frozen=True)
class FilmFiles:
    """The files of a film, in order, and the device that drew it.

    There is one file, except for numbered pictures.
    """

    files: tuple[Path, ...]
    device: str


@dataclass(frozen=True)
class _FilmFormat:
    """A film format: its codec, its writer and its limits.

    `codec` is FFmpeg's name. `picture` reads of a frame what `write` takes: the file, the pictures,
    their size, the frame rate, and the quality, 1 to 100. `even` tells whether the sides must be
    even.
    """

    codec: str
    picture: Callable[[Frame], NDArray[np.uint8]]
    write: Callable[[Path, Iterator[NDArray[np.uint8]], tuple[int, int], Fraction, int], None]
    longest_side: int
    max_fps: float = _MAX_FPS
    even: bool = False


def write_film(
    path: str | Path,
    frames: Iterable[Frame],
    fps: float = 30.0,
    *,
    count: int | None = None,
    bits: int | None = None,
    quality: int = 95,
) -> FilmFiles:
    """Write the frames of a film in the format of the suffix.

    Films of one file are written atomically. Numbered pictures are written one by one, and those
    that are finished stay if a later one fails.

    Parameters
    ----------
    path : path or str
        File to write. `.mp4` (H.264), `.gif` and `.webp` are films of one file, the last two in an
        endless loop. Any suffix of `Image.save` gives numbered pictures, `rock-0001.png` and so on.
        With a `count` of 1, a single picture without a number is written.
    frames : iterable of Frame
        Frames of equal size, as from `frames`.
    fps : float, default 30.0
        Frames per second, 0.1 to 240; at most 50 for GIF.
    count : int, optional
        Number of frames, 1 to 100 000. It sets the digits of numbered pictures: at least four, and
        six by default.
    bits : int, optional
        Bits per channel of pictures, as for `Image.save`.
    quality : int, default 95
        Quality of lossy formats, 1 to 100; WebP is lossless at 100.

    Returns
    -------
    FilmFiles
        The written `files`, in order, and the `device` that drew them.

    Raises
    ------
    InputError
        For values out of range, an unknown suffix, a missing PyAV, a size that the format cannot
        hold, frames of unequal size, and a file that cannot be written.

    Notes
    -----
    Colours are those of `Image.save`. MP4 has no transparency: frames are composited over
    `BACKGROUND`, and tagged as sRGB in BT.709 with chroma at half resolution. GIF has 256 colours
    for the whole film, and binary transparency.
    """
    path = Path(path)
    if isinstance(frames, Frame):
        raise InputError(f"{path}: a film is of several Frames; give them as a list")
    total = count if count is not None else operator.length_hint(frames)
    remaining = iter(frames)
    first = next(remaining, None)
    if first is None:
        raise InputError(f"{path}: a film of no frames; give one or more")
    if not isinstance(first, Frame):
        raise InputError(f"{path}: a film is of Frames, not of {type(first).__name__}")
    size = first.size
    check_film(path, total or _MAX_FRAMES, fps, size, bits=bits, quality=quality)
    remaining = itertools.chain([first], remaining)
    format = _film_for(path, total)
    if format is None:
        files = _write_numbered(path, remaining, total, bits=bits, quality=quality)
        return FilmFiles(files, first.device)
    pictures = _pictures(format, remaining, size, path)
    write_whole(path, lambda partial: _write_with_av(format, partial, pictures, size, fps, quality))
    return FilmFiles((path,), first.device)


def check_film(
    path: str | Path,
    count: int,
    fps: float,
    size: tuple[int, int],
    *,
    bits: int | None = None,
    quality: int = 95,
) -> None:
    """Raise InputError before drawing where `write_film` would fail.

    Checked are the number of frames, the frame rate, the suffix, the size (H.264 needs even sides),
    the presence of PyAV, and whether the folder can be written.
    """
    path = Path(path)
    _check_count(count)
    rate = _rate(fps)
    format = _film_for(path, count)
    suffix = path.suffix
    if format is None:
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
    if max(size) > format.longest_side:
        raise InputError(f"{path}: {suffix} films are at most {format.longest_side} pixels a side")
    if format.even and (size[0] % 2 or size[1] % 2):
        even = "x".join(str(side + side % 2) for side in size)
        raise InputError(f"{path}: sides are even in {suffix} films; take the size {even}")
    if rate > format.max_fps:
        raise InputError(f"{path}: {suffix} films show at most {format.max_fps:g} frames a second")
    _check_av(path, format)
    check_writable(path)


def _film_for(path: Path, count: int) -> _FilmFormat | None:
    """The film format of a path, or None for pictures; a single WebP frame is a picture."""
    suffix = path.suffix.lower()
    return None if suffix == ".webp" and count == 1 else FILMS.get(suffix)


def _check_av(path: Path, format: _FilmFormat) -> None:
    try:
        import av
    except ImportError:
        raise InputError(
            f"{path}: {path.suffix} films need PyAV; pip install 'basrelief[film]', "
            "or write numbered pictures, as film.png"
        ) from None
    if format.codec not in av.codecs_available:
        raise InputError(
            f"{path}: PyAV is built without {format.codec} here; install its wheel: "
            "pip install --only-binary av 'basrelief[film]'"
        )


def _drawn_ahead(remaining: Iterator[Frame], read: Callable[[Frame], _T]) -> Iterator[_T]:
    """The results of `read` for each frame, which is called on another thread, one frame ahead."""

    def next_read() -> tuple[_T] | None:
        frame = next(remaining, None)
        return None if frame is None else (read(frame),)

    with ThreadPoolExecutor(1) as pool:
        following = pool.submit(next_read)
        while (result := following.result()) is not None:
            following = pool.submit(next_read)
            yield result[0]


def _write_numbered(
    path: Path, remaining: Iterator[Frame], count: int, *, bits: int | None, quality: int
) -> tuple[Path, ...]:
    """Write each frame to a picture; several are written at once, while the next is drawn."""

    files: list[Path] = []
    with ThreadPoolExecutor(_WRITERS) as pool:
        writing: deque[Future[Path]] = deque()
        pictures = _drawn_ahead(remaining, lambda frame: frame.picture_writer(path, bits))
        for number, write in enumerate(pictures, 1):
            if len(writing) == _WRITERS:
                files.append(writing.popleft().result())
            target = _numbered(path, number, count)
            writing.append(pool.submit(write, target, quality))
        files += [each.result() for each in writing]
    return tuple(files)


def _numbered(path: Path, number: int, count: int) -> Path:
    """The file of a numbered picture; names sort in the order of the numbers."""
    if count == 1:
        return path
    digits = max(4, len(str(count or _MAX_FRAMES)))
    return path.with_name(f"{path.stem}-{number:0{digits}d}{path.suffix}")


def _pictures(
    format: _FilmFormat, remaining: Iterator[Frame], size: tuple[int, int], path: Path
) -> Iterator[NDArray[np.uint8]]:
    """The pictures that a format takes of the frames, which must be of one size."""

    def read(frame: Frame) -> NDArray[np.uint8]:
        if frame.size != size:
            raise InputError(f"{path}: frames of unequal size make no film")
        return format.picture(frame)

    return _drawn_ahead(remaining, read)


def _write_with_av(
    format: _FilmFormat,
    partial: Path,
    pictures: Iterator[NDArray[np.uint8]],
    size: tuple[int, int],
    fps: float,
    quality: int,
) -> None:
    """Write a film with PyAV; errors of FFmpeg become OSError."""
    import av

    try:
        format.write(partial, pictures, size, _rate(fps), quality)
    except av.FFmpegError as error:
        raise OSError(error.errno, error.strerror) from error


# --- MP4 -----------------------------------------------------------------------------------------

_BT709, _SRGB = 1, 13
"""Code points of the primaries and the matrix, and of the transfer function.

ITU-T H.273, Coding-independent code points, tables 2 to 4."""
_LIMITED = 1
"""FFmpeg's AVColorRange of luma from 16 to 235."""


_PRESET = "faster"
"""Preset of x264. On rendered materials "medium" takes 1.7 times as long, for films of 93 to 102 %
of the size."""


def _write_mp4(
    path: Path,
    pictures: Iterator[NDArray[np.uint8]],
    size: tuple[int, int],
    rate: Fraction,
    quality: int,
) -> None:
    import av

    # constant rate factor of x264, at worst 51; about 17, at the default of 95, looks lossless
    options = {"crf": f"{51.0 - 0.36 * quality:g}", "preset": _PRESET}
    # the index precedes the pictures, so that a browser can play the film while it loads
    with av.open(_ffmpeg_path(path), "w", format="mp4", options={"movflags": "+faststart"}) as file:
        stream: Any = file.add_stream("libx264", rate=rate, options=options)
        stream.width, stream.height, stream.pix_fmt = *size, "yuv420p"
        codec = stream.codec_context
        # several pictures at once; PyAV's default, slices of one, is half as fast
        codec.thread_type = "FRAME"
        codec.time_base = Fraction(1, rate.numerator)
        codec.color_primaries = codec.colorspace = _BT709
        codec.color_trc, codec.color_range = _SRGB, _LIMITED
        for number, picture in enumerate(pictures):
            with step("encode"):
                frame = _frame(picture, "yuv420p", number, rate, codec.time_base)
                file.mux(stream.encode(frame))
        with step("encode"):
            file.mux(stream.encode(None))


# --- GIF -----------------------------------------------------------------------------------------

_HUNDREDTH = Fraction(1, 100)
"""Time unit of GIF89a, in seconds."""


def _write_gif(
    path: Path,
    pictures: Iterator[NDArray[np.uint8]],
    size: tuple[int, int],
    rate: Fraction,
    quality: int,
) -> None:
    """Write a GIF in two passes, palette and coding; between them the pictures are on disk."""
    import av

    with (
        tempfile.TemporaryFile(dir=path.parent) as spool,
        av.open(_ffmpeg_path(path), "w", format="gif", options={"loop": "0"}) as file,
    ):
        stream: Any = file.add_stream("gif", rate=rate)
        stream.width, stream.height, stream.pix_fmt = *size, "pal8"
        stream.codec_context.time_base = _HUNDREDTH
        palette = _palette(pictures, size, rate, spool)
        with step("encode"):
            for frame in _with_palette(palette, _read_back(spool, size), size, rate):
                file.mux(stream.encode(frame))
            file.mux(stream.encode(None))


def _palette(
    pictures: Iterator[NDArray[np.uint8]], size: tuple[int, int], rate: Fraction, spool: IO[bytes]
) -> Any:
    """Palette of 256 colours for all pictures, by median cut; copies the pictures to `spool`."""
    graph, (source,) = _filter_graph(size, "palettegen")
    for number, picture in enumerate(pictures):
        spool.write(picture.tobytes())
        source.push(_frame(picture, "rgba", number, rate, _HUNDREDTH))
        # nothing is available yet, but pulling makes the filter consume and release the picture
        list(_available_frames(graph))
    source.push(None)
    palette = graph.pull().reformat(format="rgba")
    palette.pts, palette.time_base = 0, _HUNDREDTH
    return palette


def _with_palette(
    palette: Any, frame_bytes: Iterator[NDArray[np.uint8]], size: tuple[int, int], rate: Fraction
) -> Iterator[Any]:
    """The pictures in the colours of a palette, with ordered dithering."""
    # ordered dithering is static where the picture is static; error diffusion would flicker
    graph, (source, colors) = _filter_graph(
        size, "paletteuse", "dither=bayer:bayer_scale=3", (16, 16)
    )
    colors.push(palette)
    colors.push(None)
    for number, codes in enumerate(frame_bytes):
        source.push(_frame(codes, "rgba", number, rate, _HUNDREDTH))
        yield from _available_frames(graph)
    source.push(None)
    yield from _available_frames(graph)


def _filter_graph(
    size: tuple[int, int], name: str, options: str = "", *others: tuple[int, int]
) -> tuple[Any, list[Any]]:
    """A graph of one FFmpeg filter with a source for each input, and a sink."""
    import av.filter

    graph = av.filter.Graph()
    filter_node, sink = graph.add(name, options), graph.add("buffersink")
    sources = [
        graph.add_buffer(width=width, height=height, format="rgba", time_base=_HUNDREDTH)
        for width, height in (size, *others)
    ]
    for number, source in enumerate(sources):
        source.link_to(filter_node, 0, number)
    filter_node.link_to(sink)
    graph.configure()
    return graph, sources


def _available_frames(graph: Any) -> Iterator[Any]:
    """The frames that a filter graph has ready."""
    import av

    while True:
        try:
            yield graph.pull()
        except (av.BlockingIOError, av.EOFError):
            return


def _read_back(spool: IO[bytes], size: tuple[int, int]) -> Iterator[NDArray[np.uint8]]:
    width, height = size
    spool.seek(0)
    while frame_bytes := spool.read(width * height * 4):
        yield np.frombuffer(frame_bytes, np.uint8).reshape(height, width, 4)


# --- WebP ----------------------------------------------------------------------------------------

_THOUSANDTH = Fraction(1, 1000)
"""Time unit of WebP, in seconds."""


def _write_webp(
    path: Path,
    pictures: Iterator[NDArray[np.uint8]],
    size: tuple[int, int],
    rate: Fraction,
    quality: int,
) -> None:
    import av

    options = {"quality": f"{quality}", "lossless": f"{int(quality == 100)}"}
    with av.open(_ffmpeg_path(path), "w", format="webp", options={"loop": "0"}) as file:
        stream: Any = file.add_stream("libwebp_anim", rate=rate, options=options)
        stream.width, stream.height, stream.pix_fmt = *size, "bgra"
        stream.codec_context.time_base = _THOUSANDTH
        for number, picture in enumerate(pictures):
            with step("encode"):
                frame = _frame(picture, "rgba", number, rate, _THOUSANDTH)
                file.mux(stream.encode(frame.reformat(format="bgra")))
        with step("encode"):
            file.mux(stream.encode(None))


# --- shared by all formats -----------------------------------------------------------------------


def _frame(
    picture: NDArray[np.uint8], layout: str, number: int, rate: Fraction, tick: Fraction
) -> Any:
    """An FFmpeg frame of a picture in a pixel format of that name, with its time in ticks."""
    import av

    frame: Any = av.VideoFrame.from_ndarray(picture, layout)
    frame.time_base = tick
    frame.pts = round(number / rate / tick)
    frame.duration = round((number + 1) / rate / tick) - frame.pts
    return frame


def _codes(frame: Frame) -> NDArray[np.uint8]:
    return frame.codes


def _ffmpeg_path(path: Path) -> str:
    """An absolute path, so that FFmpeg does not read a name with a colon as a URL."""
    return str(path.absolute())


FILMS = {
    ".mp4": _FilmFormat("libx264", video_picture, _write_mp4, longest_side=16384, even=True),
    # browsers slow down GIFs whose pictures last less than two hundredths of a second
    ".gif": _FilmFormat("gif", _codes, _write_gif, longest_side=65535, max_fps=50.0),
    ".webp": _FilmFormat("libwebp_anim", _codes, _write_webp, longest_side=16383),
}
"""Film formats by suffix."""
