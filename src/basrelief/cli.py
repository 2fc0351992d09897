"""The command line: `basrelief render`, `demo`, `info`, `techniques`."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from basrelief._version import __version__
from basrelief.errors import BasreliefError

if TYPE_CHECKING:
    from basrelief.material import Material
    from basrelief.scene import Object

app = typer.Typer(
    help="Draw depth into flat textures: parallax mapping, every technique, on CPU and GPU.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def main() -> None:
    """Run the command line; what the user can mend is one line and exit code 2."""
    try:
        # not standalone: errors come back here instead of as a usage screen or a traceback
        sys.exit(app(standalone_mode=False) or 0)
    except BasreliefError as error:
        _fail(str(error))
    except KeyboardInterrupt:
        print("basrelief: interrupted; nothing was written", file=sys.stderr)
        sys.exit(130)
    except Exception as error:
        _usage_error(error)


def _fail(message: str) -> None:
    print(f"basrelief: {' '.join(message.split())}", file=sys.stderr)
    sys.exit(2)


def _usage_error(error: Exception) -> None:
    """The argument parser's own errors, known by what they carry; any other goes on."""
    if type(error).__name__ == "Abort":
        print("basrelief: interrupted; nothing was written", file=sys.stderr)
        sys.exit(130)
    told = getattr(error, "format_message", None)
    if told is None:
        raise error
    _fail(f"{told()} (basrelief COMMAND --help tells more)")


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
PolarityOption = Annotated[str, typer.Option(help="White is: auto, height (high) or depth.")]
ChannelOption = Annotated[str, typer.Option(help="Heights from: auto, r, g, b, a, luminance.")]
StretchOption = Annotated[bool, typer.Option(help="Spread the heights in use over 0 to 1.")]


def _loaded(path: str, **options: Any) -> Material:
    from basrelief.material import load

    return load(path, **{name: value for name, value in options.items() if value is not None})


@app.command()
def info(
    path: PathArgument,
    json: Annotated[bool, typer.Option("--json", help="As JSON.")] = False,
    normal_convention: GreenOption = "auto",
    height_polarity: PolarityOption = "auto",
    height_channel: ChannelOption = "auto",
    base_color: FileOption = None,
    normal: FileOption = None,
    height: FileOption = None,
) -> None:
    """Say which maps were found, what was decided about them, and why."""
    import json as json_text

    from basrelief.material import describe, report

    material = _loaded(
        path,
        normal_convention=normal_convention,
        height_polarity=height_polarity,
        height_channel=height_channel,
        base_color=base_color,
        normal=normal,
        height=height,
    )
    print(json_text.dumps(describe(material), indent=2) if json else report(material))


@app.command()
def techniques() -> None:
    """List the techniques, what each does and costs, and its settings."""
    from dataclasses import fields

    from basrelief.shaders.techniques import TECHNIQUES

    for made in TECHNIQUES.values():
        doc = (made.__doc__ or "").strip().splitlines()
        print(f"{made.name}\n  {doc[0]}")
        print(f"  level {made.level:g}, projection {made.projection}")
        for f in fields(made.settings):
            low, high = f.metadata["low"], f.metadata["high"]
            print(f"  {f.name} = {f.default:g}  ({low:g} to {high:g}: {f.metadata['doc']})")
        print()


@app.command()
def render(
    path: PathArgument,
    technique: Annotated[
        str | None, typer.Option(help="A technique's name, or FILE.py:NAME of your own.")
    ] = None,
    shape: Annotated[str, typer.Option(help="plane, box, sphere or cylinder.")] = "plane",
    engine: Annotated[str, typer.Option(help="auto, cpu or gpu.")] = "auto",
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
    setting: Annotated[
        list[str] | None,
        typer.Option("--set", help="NAME=VALUE: a setting of technique, finish or light; repeat."),
    ] = None,
    camera: Annotated[
        str | None,
        typer.Option(
            help="azimuth=30,elevation=35,distance=2,field_of_view=30 or orthographic_height=1."
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
    background: Annotated[
        str | None, typer.Option(help="A linear colour as 0.1,0.1,0.1, or none.")
    ] = None,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="The picture: png, jpg, webp, exr …")
    ] = None,
    bits: Annotated[int | None, typer.Option(help="Bits a channel: 8, or 16 for PNG.")] = None,
    depth: DepthOption = None,
    tile: TileOption = None,
    normal_convention: GreenOption = "auto",
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
) -> None:
    """Draw a material."""
    from basrelief import arguments
    from basrelief.picture import check_target
    from basrelief.rendering import render as draw

    pixels = arguments.size(size)
    material = _loaded(
        path, depth=depth, tile=tile, normal_convention=normal_convention,
        height_polarity=height_polarity, height_channel=height_channel,
        stretch_height=stretch_height, base_color=base_color, normal=normal, height=height,
        occlusion=occlusion, roughness=roughness, metallic=metallic, emission=emission,
        opacity=opacity,
    )  # fmt: skip
    scene = arguments.scene(
        material,
        settings=setting or [],
        camera=camera,
        lights=light or [],
        background=background,
        shading_model=shading_model,
        technique=technique,
        shape=shape,
        scale=scale,
        level=level,
        projection=projection,
        edge=edge,
        tiling=tiling,
    )
    thing = scene.objects[0]
    target = output or Path(f"{material.name}-{thing.drawn_with.name}.png")
    check_target(target, bits)
    with _Progress(f"drawing {material.name}") as progress:
        frame = draw(scene, size=pixels, samples=samples, engine=engine, progress=progress)
    frame.save(target, bits=bits)
    _note_flat(thing)
    print(f"{target}  ({frame.engine})")


def _note_flat(thing: Object) -> None:
    if thing.material.height is None:
        print(f"note: {thing.material.name} has no height map, so it is drawn flat")


@app.command()
def demo(
    output: Annotated[Path, typer.Option("-o", "--output", help="Where the pictures go.")] = Path(
        "basrelief-demo"
    ),
    engine: Annotated[str, typer.Option(help="auto, cpu or gpu.")] = "auto",
) -> None:
    """Draw the samples with every technique and on every shape."""
    from basrelief.demo import pictures

    for made in pictures(output, engine):
        print(made)
    print(f"\nThe pictures are in {output}. Next: basrelief render FOLDER --technique relief")


class _Progress:
    """A progress bar that shows itself only when a task takes over a second."""

    def __init__(self, task: str) -> None:
        self.task = task
        self.bar: Any = None

    def __enter__(self) -> _Progress:
        import time

        self.clock = time.monotonic
        self.start = self.clock()
        return self

    def __call__(self, share: float) -> None:
        if self.bar is None and self.clock() - self.start > 1.0:
            from rich.console import Console
            from rich.progress import Progress

            self.bar = Progress(console=Console(stderr=True), transient=True)
            self.bar.start()
            self.id = self.bar.add_task(self.task, total=1.0)
        if self.bar is not None:
            self.bar.update(self.id, completed=share)

    def __exit__(self, *_: object) -> None:
        if self.bar is not None:
            self.bar.stop()


if __name__ == "__main__":
    main()
