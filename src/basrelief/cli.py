"""The command line: `basrelief render`, `demo`, `gallery`, `info`, `techniques`."""

from __future__ import annotations

import io
import os
import sys
import threading
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NoReturn

import typer

from basrelief._version import __version__
from basrelief.errors import BasreliefError

if TYPE_CHECKING:
    from basrelief.material import Material

app = typer.Typer(
    help="Draw depth into flat textures: parallax mapping, every technique, on CPU and GPU.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


_INTERRUPTED = 130
"""The exit code after Ctrl-C; typer returns it in place of raising."""


def main() -> NoReturn:
    """Run the command line; what the user can mend is one line and exit code 2."""
    if isinstance(sys.stdout, io.TextIOWrapper):
        # a terminal that knows no × gets a question mark, not a traceback
        sys.stdout.reconfigure(errors="replace")
    try:
        # not standalone: errors come back here instead of as a usage screen or a traceback
        code = app(standalone_mode=False) or 0
        if code == _INTERRUPTED:
            raise KeyboardInterrupt
        sys.stdout.flush()
    except BasreliefError as error:
        _fail(str(error))
    except (KeyboardInterrupt, typer.Abort):
        _fail("interrupted; no unfinished file is left", _INTERRUPTED)
    except MemoryError:
        _fail("this does not fit in memory; take a smaller --size, or smaller maps")
    except BrokenPipeError:
        _leave_closed_pipe()
    except Exception as error:
        _usage_error(error)
    sys.exit(code)


def _fail(message: str, code: int = 2) -> NoReturn:
    print(f"basrelief: {' '.join(message.split())}", file=sys.stderr)
    sys.exit(code)


def _usage_error(error: Exception) -> NoReturn:
    """The argument parser's own errors, known by what they carry; any other goes on."""
    told = getattr(error, "format_message", None)
    if told is None:
        raise error
    _fail(f"{told().rstrip('.')} (basrelief COMMAND --help tells more)")


def _leave_closed_pipe() -> NoReturn:
    """Whoever read the output, `head` for one, has enough: leave without a word."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    sys.exit(1)


def _show_version(wanted: bool) -> None:
    if wanted:
        print(f"basrelief {__version__}")
        raise typer.Exit


@app.callback()
def _top(
    version: Annotated[
        bool,
        typer.Option("--version", callback=_show_version, is_eager=True, help="Show the version."),
    ] = False,
) -> None:
    pass


# --- options that several commands share ---------------------------------------------------------

PathArgument = Annotated[
    str, typer.Argument(help="A folder of maps, a picture, or sample:NAME (bricks, cobbles, …).")
]
FileOption = Annotated[Path | None, typer.Option(help="Use this file for the map.")]
DepthOption = Annotated[float | None, typer.Option(help="How deep the heights reach, in metres.")]
TileOption = Annotated[float | None, typer.Option(help="How wide a tile is, in metres.")]
GreenOption = Annotated[str, typer.Option(help="Green of the normal map: auto, gl (up) or dx.")]
PackingOption = Annotated[str, typer.Option(help="Normals are stored in: rgb, ag or rg.")]
PolarityOption = Annotated[str, typer.Option(help="White is: auto, height (high) or depth.")]
ChannelOption = Annotated[str, typer.Option(help="Heights from: auto, r, g, b, a, luminance.")]
StretchOption = Annotated[bool, typer.Option(help="Spread the heights in use over 0 to 1.")]
EngineOption = Annotated[str, typer.Option(help="auto, cpu or gpu.")]


def _loaded(path: str, **options: Any) -> Material:
    from basrelief.material import load

    return load(path, **{name: value for name, value in options.items() if value is not None})


@app.command()
def info(
    path: PathArgument,
    json: Annotated[bool, typer.Option("--json", help="As JSON.")] = False,
    depth: DepthOption = None,
    tile: TileOption = None,
    normal_convention: GreenOption = "auto",
    normal_packing: PackingOption = "rgb",
    height_polarity: PolarityOption = "auto",
    height_channel: ChannelOption = "auto",
    stretch_height: StretchOption = False,
    base_color: FileOption = None,
    normal: FileOption = None,
    height: FileOption = None,
    occlusion: FileOption = None,
    roughness: FileOption = None,
    metallic: FileOption = None,
    emission: FileOption = None,
    opacity: FileOption = None,
    layer_mask: FileOption = None,
) -> None:
    """Say which maps were found, what was decided about them, and why."""
    import json as json_text

    from basrelief.material import describe, report

    with _Progress(f"reading {path}"):
        material = _loaded(
            path, depth=depth, tile=tile, normal_convention=normal_convention,
            normal_packing=normal_packing, height_polarity=height_polarity,
            height_channel=height_channel, stretch_height=stretch_height, base_color=base_color,
            normal=normal, height=height, occlusion=occlusion, roughness=roughness,
            metallic=metallic, emission=emission, opacity=opacity, layer_mask=layer_mask,
        )  # fmt: skip
    print(json_text.dumps(describe(material), indent=2) if json else report(material))


@app.command()
def techniques() -> None:
    """List the techniques, what each does and costs, its source, and its settings."""
    from basrelief.shaders.lighting import Shading
    from basrelief.shaders.shadow import Shadowing
    from basrelief.shaders.surfaces.standard import Finish
    from basrelief.shaders.techniques import TECHNIQUES

    for made in TECHNIQUES.values():
        defaults = f"Defaults: --level {made.level:g} --projection {made.projection}"
        _list(made.name, [*_paragraphs(made.__doc__), defaults], made.settings)
    also = "--set turns these too, and bias (0.42), which goes with --projection biased:"
    _list("with every technique", [also], Finish, Shading, Shadowing)


def _paragraphs(doc: str | None) -> list[str]:
    import inspect

    return inspect.cleandoc(doc or "").split("\n\n")


def _list(name: str, paragraphs: list[str], *records: Any) -> None:
    """A heading, paragraphs, and a table of the settings of records."""
    import textwrap

    print(name)
    for paragraph in paragraphs:
        print(textwrap.fill(paragraph, 78, initial_indent="  ", subsequent_indent="  "))
    rows = [_setting(field) for record in records for field in record.__dataclass_fields__.values()]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    for row in rows:
        cells = [cell.ljust(width) for cell, width in zip(row, widths, strict=True)]
        print("    " + "  ".join(cells).rstrip())
    print()


def _setting(field: Any) -> tuple[str, str, str]:
    """A setting with its default, the range it may have, and what it means."""
    from basrelief.lang import Vec3

    low, high = field.metadata["low"], field.metadata["high"]
    values = [*field.default] if isinstance(field.default, Vec3) else [field.default]
    default = "/".join(f"{x:g}" for x in values)
    ends = f"from {low:g}" if high is None else f"{low:g} to {high:g}"
    return f"{field.name}={default}", ends, field.metadata["doc"]


@app.command()
def render(
    path: PathArgument,
    technique: Annotated[
        str | None, typer.Option(help="A technique's name, or FILE.py:NAME of your own.")
    ] = None,
    shape: Annotated[str, typer.Option(help="plane, box, sphere or cylinder.")] = "plane",
    engine: EngineOption = "auto",
    size: Annotated[str, typer.Option(help="Width × height in pixels.")] = "1280x720",
    samples: Annotated[int, typer.Option(help="Samples a pixel.")] = 4,
    scale: Annotated[
        float | None, typer.Option(help="Depth of the relief as a fraction of a tile's width.")
    ] = None,
    level: Annotated[
        float | None, typer.Option(help="The height on the polygon: 1 pushes the relief in.")
    ] = None,
    projection: Annotated[str | None, typer.Option(help="full, biased or limited.")] = None,
    edge: Annotated[str, typer.Option(help="Beyond the map: wrap, clamp or clip.")] = "wrap",
    tiling: Annotated[str | None, typer.Option(help="Tiles along u and v, as 2x3.")] = None,
    shift: Annotated[str | None, typer.Option(help="Move the maps by U,V tiles.")] = None,
    stretch: Annotated[
        str | None, typer.Option(help="Stretch the shape along X,Y,Z of the world.")
    ] = None,
    setting: Annotated[
        list[str] | None,
        typer.Option(
            "--set", help="NAME=VALUE: a setting that `basrelief techniques` lists; repeat."
        ),
    ] = None,
    camera: Annotated[
        str | None,
        typer.Option(
            help="azimuth=30,elevation=35,distance=2,field_of_view=30, or position=1/1/1, or "
            "orthographic_height=1."
        ),
    ] = None,
    light: Annotated[
        list[str] | None,
        typer.Option(
            help="directional,azimuth=-50,elevation=35,intensity=2 · point,position=1/1/1 · "
            "spot,position=1/2/1,angle=30; repeat."
        ),
    ] = None,
    shading_model: Annotated[str, typer.Option(help="ggx or phong.")] = "ggx",
    shadows: Annotated[
        str, typer.Option(help="Of the relief on itself: none, hard or soft.")
    ] = "none",
    background: Annotated[
        str | None, typer.Option(help="A linear colour as 0.1,0.1,0.1, or none.")
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", help="The picture: png, jpg, webp, exr …, or mp4, gif."),
    ] = None,
    bits: Annotated[int | None, typer.Option(help="Bits a channel: 8, or 16 for PNG.")] = None,
    quality: Annotated[int, typer.Option(min=1, max=100, help="Of JPEG, WebP and MP4.")] = 95,
    frames: Annotated[
        int, typer.Option(help="How many pictures: above 1 a film (mp4, gif, webp), or numbered.")
    ] = 1,
    fps: Annotated[float, typer.Option(help="Pictures a second in a film.")] = 30.0,
    motion: Annotated[
        list[str] | None,
        typer.Option(help="orbit · light · scroll,u=0.25,v=0: what moves in a film; repeat."),
    ] = None,
    depth: DepthOption = None,
    tile: TileOption = None,
    normal_convention: GreenOption = "auto",
    normal_packing: PackingOption = "rgb",
    height_polarity: PolarityOption = "auto",
    height_channel: ChannelOption = "auto",
    stretch_height: StretchOption = False,
    base_color: FileOption = None,
    normal: FileOption = None,
    height: FileOption = None,
    occlusion: FileOption = None,
    roughness: FileOption = None,
    metallic: FileOption = None,
    emission: FileOption = None,
    opacity: FileOption = None,
    layer_mask: FileOption = None,
) -> None:
    """Draw a material, as a picture or a film."""
    with _Progress(f"reading {path}") as progress:
        from basrelief import arguments, film

        pixels = arguments.size(size)
        motions = arguments.motions_from(motion or [], frames)
        arguments.check_lengths(depth, tile, scale)
        material = _loaded(
            path, depth=depth, tile=tile, normal_convention=normal_convention,
            normal_packing=normal_packing, height_polarity=height_polarity,
            height_channel=height_channel, stretch_height=stretch_height, base_color=base_color,
            normal=normal, height=height, occlusion=occlusion, roughness=roughness,
            metallic=metallic, emission=emission, opacity=opacity, layer_mask=layer_mask,
        )  # fmt: skip
        scene = arguments.scene(
            material, settings=setting or [], camera=camera, lights=light or [],
            background=background, shading_model=shading_model, shadows=shadows,
            technique=technique, shape=shape, scale=scale, level=level, projection=projection,
            edge=edge, tiling=tiling, shift=shift, stretch=stretch,
        )  # fmt: skip
        drawn_with = scene.objects[0].drawn_with.name
        # a name that `load` knows for one of ours, and takes for no map
        target = output or Path(f"{material.name}-{drawn_with}-basrelief.png")
        film.check_film(target, frames, fps, pixels, bits=bits, quality=quality)
        progress.task = f"drawing {material.name}"
        drawn = film.frames(
            scene, motions, count=frames, fps=fps, size=pixels, samples=samples, engine=engine,
            progress=progress,
        )  # fmt: skip
        made = film.write_film(target, drawn, fps, count=frames, bits=bits, quality=quality)
    if material.height is None and technique is None:
        note = f"note: {material.name} has no height map, so it is drawn flat"
        print(note, file=sys.stderr)
    if scene.background is None and target.suffix.lower() == ".mp4":
        note = "note: MP4 has no transparency, so the film is laid over the usual background"
        print(note, file=sys.stderr)
    # the first and the last of many
    files = " … ".join(map(str, dict.fromkeys((made.files[0], made.files[-1]))))
    print(f"{files}  ({made.engine})")


@app.command()
def demo(
    output: Annotated[Path, typer.Option("-o", "--output", help="Where the pictures go.")] = Path(
        "basrelief-demo"
    ),
    engine: EngineOption = "auto",
) -> None:
    """Draw the samples with every technique and on every shape."""
    made: list[Path] = []
    with _Progress("drawing the samples") as progress:
        from basrelief.demo import COUNT, pictures

        for picture in pictures(output, engine):
            made.append(picture)
            progress(len(made) / COUNT)
    print("\n".join(map(str, made)))
    print(f"\nThe pictures are in {output}. Next: basrelief render FOLDER --technique relief")


@app.command()
def gallery(
    output: Annotated[Path, typer.Argument(help="The folder for pages and pictures.")],
    engine: EngineOption = "auto",
    size: Annotated[str, typer.Option(help="Width × height of each picture.")] = "480x270",
    samples: Annotated[int, typer.Option(help="Samples a pixel.")] = 4,
    only: Annotated[
        list[str] | None, typer.Option(help="The name of a page to draw; repeat for more.")
    ] = None,
    source: Annotated[
        str | None,
        typer.Option(help="Pages after catlike, wikibooks, gamedev, halliwell or habrador alone."),
    ] = None,
) -> None:
    """Draw every comparison of the five articles as pages with pictures, settings and costs."""
    with _Progress("drawing the gallery") as progress:
        from basrelief import arguments
        from basrelief.engine import choose_engine
        from basrelief.gallery.folder import chosen, write

        def heard(what: str, share: float) -> None:
            progress.task = f"drawing: {what}"
            progress(share)

        pages, pixels = chosen(only or [], source), arguments.size(size)
        index = write(output, pages, choose_engine(engine), pixels, samples, heard)
    print(index)


# --- progress ------------------------------------------------------------------------------------

_PATIENCE = 1.0
"""Seconds after which a task shows how far it is."""


class _Progress:
    """A bar on the terminal's standard error, as long as a task takes, from its second second on.

    Called with the finished share, 0 to 1; before the first call the bar only says that it works.
    """

    def __init__(self, task: str) -> None:
        self.task = task
        self.share: float | None = None
        self.bar: Any = None
        self.timer = threading.Timer(_PATIENCE, self._show)
        self.timer.daemon = True

    def __enter__(self) -> _Progress:
        if sys.stderr.isatty():
            self.timer.start()
        return self

    def __call__(self, share: float) -> None:
        self.share = share
        self._update()

    def _show(self) -> None:
        from rich.console import Console
        from rich.progress import Progress

        bar = Progress(console=Console(stderr=True), transient=True, redirect_stdout=False)
        bar.add_task(self.task, total=None)
        bar.start()
        self.bar = bar
        self._update()

    def _update(self) -> None:
        if self.bar is not None:
            total = None if self.share is None else 1.0
            id = self.bar.task_ids[0]
            self.bar.update(id, description=self.task, total=total, completed=self.share or 0.0)

    def __exit__(self, *_: object) -> None:
        self.timer.cancel()
        if self.timer.ident is not None:
            self.timer.join()
        if self.bar is not None:
            self.bar.stop()


if __name__ == "__main__":
    main()
