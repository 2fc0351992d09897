"""The command line: what `basrelief` does, one function a command."""

from __future__ import annotations

import functools
import io
import os
import sys
import threading
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NoReturn

import typer

from basrelief._version import __version__
from basrelief.cli import options
from basrelief.errors import BasreliefError, InputError, new_name

if TYPE_CHECKING:
    from basrelief.material import Material
    from basrelief.scene import Scene
    from basrelief.scene.presets import Preset

app = typer.Typer(
    help="Draw depth into flat textures: parallax mapping, every technique, on CPU and GPU.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


_INTERRUPTED = 130
"""The exit code after Ctrl-C; typer returns it in place of raising."""


def main() -> NoReturn:
    """Run the command line; errors that the user can fix are one line, with exit code 2."""
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
    text = _renamed_option(error) or told().rstrip(".")
    _fail(f"{text} (basrelief COMMAND --help tells more)")


def _renamed_option(error: Any) -> str:
    """The hint to the new name of an unknown option; "" where the command has no such option."""
    option, context = getattr(error, "option_name", ""), getattr(error, "ctx", None)
    known = [] if context is None else [name for p in context.command.params for name in p.opts]
    return new_name(option, known)


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
_of_picture = functools.partial(typer.Option, rich_help_panel="Picture")
_OUTPUT = ("-o", "--output")
ScaleOption = Annotated[float | None, typer.Option(help="Depth as a fraction of a tile's width.")]
DeviceOption = Annotated[str, _of_picture(help="auto, cpu or gpu.")]


def _said(options: dict[str, Any]) -> dict[str, Any]:
    """The options that are given."""
    return {name: value for name, value in options.items() if value is not None}


def _plain(options: dict[str, Any]) -> dict[str, Any]:
    """Options as JSON has them."""
    return {name: str(x) if isinstance(x, Path) else x for name, x in options.items()}


def _loaded(path: str, **maps: Any) -> Material:
    from basrelief.material import load

    return load(path, **_said(maps))


def _preset_and_maps(given: dict[str, Any]) -> tuple[Preset, dict[str, Any]]:
    """The preset, and the options of the maps that are given; neither is left in `given`."""
    from basrelief.cli import arguments

    maps = {name: given.pop(name) for name in options.names_of(options.Maps)}
    arguments.check_lengths(maps["depth"], maps["tile"], given["scale"])
    return arguments.preset_from(given.pop("preset")), _said(maps)


def _scene(path: str, chosen: Preset, maps: dict[str, Any], given: dict[str, Any]) -> Scene:
    """The scene that a command's options describe."""
    from basrelief.cli import arguments

    material = _loaded(path, **{**chosen.maps, **maps})
    return arguments.scene(material, preset=chosen, measured="depth" in maps, **_said(given))


@app.command()
@options.taking(..., options.Maps)
def info(
    path: PathArgument,
    json: Annotated[bool, typer.Option("--json", help="As JSON.")] = False,
    **maps: Any,
) -> None:
    """Say which maps were found, what was decided about them, and why."""
    import json as json_text

    from basrelief.material import describe, report

    with _Progress(f"reading {path}"):
        material = _loaded(path, **maps)
    print(json_text.dumps(describe(material), indent=2) if json else report(material))


@app.command()
def techniques() -> None:
    """List the techniques, what each does and costs, its source, and its settings."""
    import inspect

    from basrelief.shading.brdf import Shading
    from basrelief.shading.fog import Fog
    from basrelief.shading.self_shadow import Shadowing
    from basrelief.shading.surfaces.landscape import Landscape
    from basrelief.shading.surfaces.standard import SurfaceParameters
    from basrelief.techniques import TECHNIQUES
    from basrelief.techniques.height import Smoothing

    for made in TECHNIQUES.values():
        defaults = (
            f"Defaults: --reference-height {made.reference_height:g} --projection {made.projection}"
        )
        paragraphs = inspect.cleandoc(made.__doc__ or "").split("\n\n")
        _list(made.name, [*paragraphs, defaults], made.settings)
    bias = "Beside a technique's own settings, --set turns bias (0.42), which goes with"
    _list("with every technique", [f"{bias} --projection biased, and all that follow."])
    for name, record in (
        ("smooth heights (--heights smooth)", Smoothing),
        ("the standard surface", SurfaceParameters),
        ("a landscape (--surface landscape)", Landscape),
        ("light and shading", Shading),
        ("shadows of the relief on itself (--shadows hard, soft)", Shadowing),
        ("fog (--fog-mode linear, exponential, exponential_squared)", Fog),
    ):
        _list(name, [], record)


@app.command()
def presets() -> None:
    """List the presets: the settings of an article, under one name."""
    from basrelief.scene.presets import PRESETS, preset

    for name in PRESETS:
        made = preset(name)
        _list(name, [made.about, f"After {made.source}."])


def _list(name: str, paragraphs: list[str], *records: Any) -> None:
    """A heading, paragraphs, and a table of the settings of records."""
    import textwrap

    print(name)
    for paragraph in paragraphs:
        print(
            textwrap.fill(
                paragraph, 78, initial_indent="  ", subsequent_indent="  ", break_on_hyphens=False
            )
        )
    rows = [_setting(field) for record in records for field in record.__dataclass_fields__.values()]
    # an empty record, or none, has no table
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
@options.taking(
    options.Relief, options.Surface, options.Light, options.Camera, ...,
    options.Maps, options.Further,
)  # fmt: skip
def render(
    path: PathArgument,
    output: Annotated[
        Path | None, _of_picture(*_OUTPUT, help="The picture: png, jpg, webp, exr …, or mp4, gif.")
    ] = None,
    size: Annotated[str, _of_picture(help="Width × height in pixels.")] = "1280x720",
    samples: Annotated[int, _of_picture(help="Samples a pixel.")] = 4,
    bits: Annotated[int | None, _of_picture(help="Bits a channel: 8, or 16 for PNG.")] = None,
    quality: Annotated[int, _of_picture(min=1, max=100, help="Of JPEG, WebP and MP4.")] = 95,
    frames: Annotated[
        int, _of_picture(help="Above 1 a film (mp4, gif, webp), or numbered pictures.")
    ] = 1,
    fps: Annotated[float, _of_picture(help="Pictures a second in a film.")] = 30.0,
    motion: Annotated[
        list[str] | None,
        _of_picture(
            help="orbit · light · scroll,u=0.25,v=0 · opening: what moves in a film; repeat.",
            metavar="NAME,NAME=VALUE…",
        ),
    ] = None,
    show: Annotated[
        str, _of_picture(help="color, or what it hides: reads, missed, overshoot, depth-error.")
    ] = "color",
    device: DeviceOption = "auto",
    **given: Any,
) -> None:
    """Draw a material, as a picture or a film."""
    with _Progress(f"reading {path}") as progress:
        from basrelief.cli import arguments
        from basrelief.rendering import film

        pixels = arguments.size(size)
        chosen, maps = _preset_and_maps(given)
        motions = arguments.motions_from(motion or [], frames, chosen)
        scene = _scene(path, chosen, maps, given)
        material, technique_name = (
            scene.objects[0].material,
            scene.objects[0].selected_technique.name,
        )
        # a name that `load` knows for one of ours, and takes for no map
        shown = "" if show == "color" else f"-{show}"
        target = output or Path(f"{material.name}-{technique_name}{shown}-basrelief.png")
        film.check_film(target, frames, fps, pixels, bits=bits, quality=quality)
        progress.task = f"drawing {material.name}"
        if show != "color":
            _show(show, scene, pixels, samples, device, frames, target, bits, quality)
            return
        drawn = film.frames(
            scene, motions, count=frames, fps=fps, size=pixels, samples=samples, device=device,
            progress=progress,
        )  # fmt: skip
        made = film.write_film(target, drawn, fps, count=frames, bits=bits, quality=quality)
    if material.height is None and given["technique"] is None:
        note = f"note: {material.name} has no height map, so it is drawn flat"
        print(note, file=sys.stderr)
    if scene.background is None and target.suffix.lower() == ".mp4":
        note = "note: MP4 has no transparency, so the film is laid over the usual background"
        print(note, file=sys.stderr)
    # the first and the last of many
    files = " … ".join(map(str, dict.fromkeys((made.files[0], made.files[-1]))))
    print(f"{files}  ({made.device})")


def _show(
    what: str,
    scene: Any,
    size: tuple[int, int],
    samples: int,
    device: str,
    frames: int,
    target: Path,
    bits: int | None,
    quality: int,
) -> None:
    """Draw a debug picture, and say what its colours mean."""
    from basrelief.engine import choose_device
    from basrelief.errors import InputError
    from basrelief.measure.debug import check_shown, debug_picture
    from basrelief.measure.truth import truth
    from basrelief.rendering.render import render

    check_shown(what)
    if frames != 1:
        raise InputError(f"--show {what}: one picture shows it; leave --frames away")
    boxes = [
        each.selected_technique.name for each in scene.objects if each.selected_technique.columns
    ]
    if boxes and what != "reads":
        raise InputError(
            f"--show {what} measures against the bilinear surface, and {boxes[0]} draws boxes; "
            "use --show reads or another technique"
        )
    engine = choose_device(device)
    true = None if what == "reads" else truth(scene, size, device=engine)
    frame = render(scene, size=size, samples=samples, device=engine)
    made = debug_picture(what, frame, true)
    made.image.save(target, bits=bits, quality=quality)
    print(f"{target}  ({frame.device})\n{made.meaning}")


@app.command()
@options.taking(..., options.Maps)
def compare(
    path: PathArgument,
    output: Annotated[
        Path | None,
        typer.Option(*_OUTPUT, help="The folder for the page, pictures and compare.json."),
    ] = None,
    technique: Annotated[
        list[str] | None,
        typer.Option(
            help="One to compare (all of them), as relief,max_steps=64 too; repeat.",
            metavar="NAME|FILE.py:NAME[,SETTING=VALUE…]",
        ),
    ] = None,
    settings: Annotated[
        list[str] | None,
        typer.Option(
            "--set", help="A setting for all techniques that have it; repeat.", metavar="NAME=VALUE"
        ),
    ] = None,
    angles: Annotated[str, typer.Option(help="Degrees from the normal.")] = "0,45,60,75,85",
    size: Annotated[str, typer.Option(help="Width × height of each picture.")] = "480x270",
    samples: Annotated[int, typer.Option(help="Samples a pixel.")] = 4,
    scale: ScaleOption = None,
    reference_height: Annotated[
        float | None, typer.Option(help="The height on the polygon (each technique's own).")
    ] = None,
    projection: Annotated[
        str | None, typer.Option(help="full, biased or limited (each technique's own).")
    ] = None,
    device: DeviceOption = "auto",
    **maps: Any,
) -> None:
    """Measure every technique on a material: a page that says what to ship, and why."""
    with _Progress(f"reading {path}") as progress:
        from basrelief.cli import arguments
        from basrelief.measure.compare import compare as compared

        seen, pixels = arguments.numbers(angles, "--angles"), arguments.size(size)
        arguments.check_lengths(maps["depth"], maps["tile"], scale)
        said = arguments.plain_settings(settings or [])
        relief = _said(
            {"scale": scale, "reference_height": reference_height, "projection": projection}
        )
        if "bias" in said:
            relief["bias"] = said.pop("bias")
        material = _loaded(path, **maps)

        found = compared(
            material, technique, angles=seen, size=pixels, samples=samples, device=device,
            settings=said, progress=progress.at, **relief,
        )  # fmt: skip
        page = found.save(output or Path(f"{material.name}-compare"))
    print(f"{found.summary()}\n{page}  ({found.device})")


@app.command()
@options.taking(..., options.Maps)
def tune(
    path: PathArgument,
    missed: Annotated[
        str | None, typer.Option(help="The most missed hits, as 0.1%.", metavar="SHARE")
    ] = None,
    flip: Annotated[float | None, typer.Option(help="The most FLIP error, as 0.05.")] = None,
    angles: Annotated[str, typer.Option(help="Degrees from the normal, from-to.")] = "0-75",
    output: Annotated[Path | None, typer.Option(*_OUTPUT, help="The preset, a .toml file.")] = None,
    technique: Annotated[
        list[str] | None,
        typer.Option(help="One to try (all of them); repeat.", metavar="NAME|FILE.py:NAME"),
    ] = None,
    settings: Annotated[
        list[str] | None,
        typer.Option("--set", help="A setting to keep as it is; repeat.", metavar="NAME=VALUE"),
    ] = None,
    size: Annotated[str, typer.Option(help="Width × height of what is measured.")] = "320x180",
    scale: ScaleOption = None,
    device: DeviceOption = "auto",
    **maps: Any,
) -> None:
    """Find the cheapest technique and settings that keep an error under a bound."""
    with _Progress(f"reading {path}") as progress:
        from basrelief.cli import arguments
        from basrelief.measure.tune import tune as tuned

        bound = None if missed is None else arguments.share(missed, "--missed")
        seen, pixels = arguments.span(angles, "--angles"), arguments.size(size)
        arguments.check_lengths(maps["depth"], maps["tile"], scale)
        said, relief = arguments.plain_settings(settings or []), _said({"scale": scale})
        if "bias" in said:
            relief["bias"] = said.pop("bias")
        material = _loaded(path, **maps)

        found = tuned(
            material, missed=bound, flip=flip, angles=seen, techniques=technique, size=pixels,
            device=device, settings=said, progress=progress.at, source=path, **relief,
        )  # fmt: skip
        written = found.preset.save(output or Path(f"{material.name}-tuned.toml"))
    print(f"{found.report()}\n\n{found.command}\n\n{written}  ({found.device})")


@app.command()
@options.taking(..., options.Bakes, options.Sources)
def bake(
    path: PathArgument,
    output: Annotated[
        Path | None, typer.Option(*_OUTPUT, help="The folder for the files (FOLDER/baked).")
    ] = None,
    edge: Annotated[str, typer.Option(help="Beyond the map: wrap or clamp.")] = "wrap",
    scale: Annotated[
        float | None,
        typer.Option(help="Depth as a fraction of a tile's width; else the material's, or 0.05."),
    ] = None,
    green: Annotated[str, typer.Option(help="Green of normals is up (gl) or down (dx).")] = "gl",
    bits: Annotated[int, typer.Option(help="Of normals, heights, occlusion: 8 or 16.")] = 16,
    directions: Annotated[int, typer.Option(help="Of the horizon; four go into a file.")] = 8,
    overwrite: Annotated[
        bool, typer.Option("--overwrite", help="Replace files that are there.")
    ] = False,
    device: DeviceOption = "auto",
    **given: Any,
) -> None:
    """Bake maps from a material's heights, or heights from its normals, for other programs."""
    from basrelief.baking.files import OPTIONS, Baking, bake_to

    names = [name for name in OPTIONS if given.pop(name)]
    if not names:
        raise InputError(
            f"nothing to bake: name {', '.join('--' + name.replace('_', '-') for name in OPTIONS)}"
        )
    for option, value, known in (
        ("edge", edge, ("wrap", "clamp")), ("green", green, ("gl", "dx")), ("bits", bits, (8, 16)),
    ):  # fmt: skip
        if value not in known:
            raise InputError(f"--{option} {value}: choose {known[0]} or {known[1]}")
    with _Progress(f"reading {path}") as progress:
        from basrelief.cli import arguments
        from basrelief.engine import choose_device
        from basrelief.scene.objects import DEFAULT_SCALE

        arguments.check_lengths(given["depth"], given["tile"], scale)
        maps = {name.removesuffix("_map"): value for name, value in given.items()}
        material = _loaded(path, **maps)
        progress.task = f"baking {material.name}"
        used = next(each for each in (scale, material.scale, DEFAULT_SCALE) if each is not None)
        engine = choose_device(device)
        chosen = Baking(material, engine, edge, used, bits, green, directions)  # type: ignore[arg-type]
        folder = output or (Path(path) if os.path.isdir(path) else Path(path).parent) / "baked"
        made = bake_to(folder, names, chosen, overwrite=overwrite)
    for file, note in made:
        print(f"{file}  ({note})" if note else file)
    if set(names) & {"normal", "occlusion", "horizon"}:
        print(f"scale {used:g}: the relief is as deep as that share of the map's width")


@app.command()
@options.taking(
    options.Relief, options.Surface, options.Light, options.Camera, ...,
    options.Maps, options.Further,
)  # fmt: skip
def explain(
    path: PathArgument,
    pixel: Annotated[
        str,
        _of_picture(help="Which pixel's ray, from the top left.", metavar="X,Y"),
    ],
    output: Annotated[
        Path | None, _of_picture(*_OUTPUT, help="The cross-section: svg, png or pdf.")
    ] = None,
    size: Annotated[str, _of_picture(help="Width × height in pixels.")] = "1280x720",
    table: Annotated[bool, _of_picture("--table", help="List each read.")] = False,
    **given: Any,
) -> None:
    """Show what a technique reads along the ray of one pixel, and where it should have ended."""
    with _Progress(f"reading {path}"):
        from basrelief.cli import arguments
        from basrelief.measure.explain import explain as explained

        place, pixels = arguments.pixel(pixel), arguments.size(size)
        chosen, maps = _preset_and_maps(given)
        found = explained(_scene(path, chosen, maps, given), pixel=place, size=pixels)
        made = None if output is None else found.save(output)
    print(found.summary)
    if table or made is None:
        print(found.table())
    if made is not None:
        print(made)


@app.command()
def demo(
    output: Annotated[Path, typer.Option(*_OUTPUT, help="Where the pictures go.")] = Path(
        "basrelief-demo"
    ),
    device: DeviceOption = "auto",
) -> None:
    """Draw the samples with every technique and on every shape."""
    made: list[Path] = []
    with _Progress("drawing the samples") as progress:
        from basrelief.cli.demo import COUNT, pictures

        for picture in pictures(output, device):
            made.append(picture)
            progress(len(made) / COUNT)
    print("\n".join(map(str, made)))
    print(f"\nThe pictures are in {output}. Next: basrelief render FOLDER --technique relief")


@app.command()
@options.taking(
    options.Relief, options.Surface, options.Light, options.Camera, ..., options.Maps,
)  # fmt: skip
def view(
    path: PathArgument,
    output: Annotated[
        Path | None, typer.Option(*_OUTPUT, help="The page; without it one is made and opened.")
    ] = None,
    texels: Annotated[int, typer.Option(help="Texels a side of the page's maps at most.")] = 1024,
    device: DeviceOption = "auto",
    **given: Any,
) -> None:
    """Make one page in which every map and number is live, and open it in a browser."""
    with _Progress(f"reading {path}") as progress:
        import tempfile
        import webbrowser

        from basrelief.viewer import Sources, write_view

        if texels < 1:
            raise InputError(f"--texels {texels}: give at least 1")
        if output is not None and output.suffix.lower() not in (".html", ".htm"):
            raise InputError(f"--output {output}: name a page, as page.html")
        chosen, maps = _preset_and_maps(given)
        scene = _scene(path, chosen, maps, given)
        sources = Sources(path, _plain({**chosen.maps, **maps}), given["layer"])
        name = scene.objects[0].material.name
        target = output or Path(tempfile.mkdtemp("-basrelief")) / f"{name}.html"
        made = write_view(
            scene, target, texels=texels, sources=sources, device=device, progress=progress.at
        )
    if made.scaled_to is not None:
        width, height = made.scaled_to
        print(f"note: the page's maps are scaled to {width} × {height}", file=sys.stderr)
    print(target)
    if output is None and not webbrowser.open(target.resolve().as_uri()):
        print("note: no browser could be opened; open the page yourself", file=sys.stderr)


@app.command()
def gallery(
    output: Annotated[Path, typer.Argument(help="The folder for pages and pictures.")],
    device: DeviceOption = "auto",
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
        from basrelief.cli import arguments
        from basrelief.engine import choose_device
        from basrelief.gallery.folder import chosen, write

        def heard(what: str, share: float) -> None:
            progress.task = f"drawing: {what}"
            progress(share)

        pages, pixels = chosen(only or [], source), arguments.size(size)
        index = write(output, pages, choose_device(device), pixels, samples, heard)
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

    def at(self, task: str, share: float) -> None:
        """The same, of a task whose name changes as it goes."""
        self.task = task
        self(share)

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
