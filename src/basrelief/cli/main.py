"""The command line of `basrelief`, one function per command."""

from __future__ import annotations

import contextlib
import functools
import io
import os
import re
import sys
import threading
import time
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NoReturn

import typer

from basrelief._version import __version__
from basrelief.baking.files import FILE_BAKES, checked_bakes
from basrelief.cli import options
from basrelief.errors import BasreliefError, InputError, new_name
from basrelief.settings import settings_of

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from basrelief.cli.arguments import MeasuredOptions
    from basrelief.material import Material
    from basrelief.scene import Scene
    from basrelief.scene.motion import Motion
    from basrelief.scene.presets import Preset

app = typer.Typer(
    help="Draw depth into flat textures: parallax mapping, every technique, on CPU and GPU.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


BAKE_FLAGS = {name.replace("_", "-") for name in FILE_BAKES}
BAKE_EXAMPLE = "to bake maps write, for example, basrelief bake FOLDER normal occlusion"
_STARTED = time.perf_counter()
_INTERRUPTED = 130
"""Exit code after Ctrl-C; typer returns it instead of raising."""


def main() -> NoReturn:
    """Run the command line; an error that the user can fix is one line, with exit code 2."""
    if isinstance(sys.stdout, io.TextIOWrapper):
        # a terminal that cannot encode × gets a question mark, not a traceback
        sys.stdout.reconfigure(errors="replace")
    try:
        # not standalone, so that errors are raised here instead of printed with the usage
        code = app(standalone_mode=False) or 0
        if code == _INTERRUPTED:
            raise KeyboardInterrupt
        sys.stdout.flush()
    except BasreliefError as error:
        _fail(str(error).removesuffix(error.excerpt), excerpt=error.excerpt)
    except (KeyboardInterrupt, typer.Abort):
        _fail("interrupted; no unfinished file is left", _INTERRUPTED)
    except MemoryError:
        _fail("this does not fit in memory; use a smaller --size, or smaller maps")
    except BrokenPipeError:
        _exit_after_closed_pipe()
    except Exception as error:
        _usage_error(error)
    sys.exit(code)


def _fail(message: str, code: int = 2, excerpt: str = "") -> NoReturn:
    """Print a message in one line, and below it an excerpt of source code, and exit."""
    print(
        "\n".join(filter(None, [f"basrelief: {' '.join(message.split())}", excerpt])),
        file=sys.stderr,
    )
    sys.exit(code)


def _usage_error(error: Exception) -> NoReturn:
    """Report an error of the argument parser, recognised by its attributes; raise any other."""
    format_message = getattr(error, "format_message", None)
    if format_message is None:
        raise error
    if type(error).__name__ == "NoArgsIsHelpError":
        sys.exit(2)  # the help is printed
    text = _renamed_option(error) or _wrong_value(error) or format_message().rstrip(".")
    _fail(f"{text} (see basrelief COMMAND --help)")


def _renamed_option(error: Any) -> str:
    """The hint to the new name of an unknown option; "" where the command has no such option."""
    option, context = getattr(error, "option_name", ""), getattr(error, "ctx", None)
    if getattr(context, "info_name", "") == "bake" and option.strip("-") in BAKE_FLAGS:
        return f"{option}: maps to bake are named without dashes; {BAKE_EXAMPLE}"
    known = [] if context is None else [name for p in context.command.params for name in p.opts]
    return new_name(option, known) or ("--set" in known and _setting_hint(option)) or ""


def _setting_hint(option: str) -> str:
    """The hint to --set where an option has the name of a number of a technique or a scene."""
    from basrelief.scene.resolve import number_records
    from basrelief.techniques import TECHNIQUES

    name = option.lstrip("-").replace("-", "_")
    has_it = any(
        name in settings_of(record)
        for technique in TECHNIQUES.values()
        for record in number_records(technique, "standard").values()
    )
    return f"{option}: write --set {name}=VALUE" if has_it else ""


def _wrong_value(error: Any) -> str:
    """The line for a value that is no number, or out of its range; "" for other errors."""
    option, message = getattr(error, "param", None), getattr(error, "message", "")
    wrong = re.match(r"(.+) is not (?:a valid (int|float)|in the range)", message)
    if option is None or wrong is None:
        return ""
    value, kind = wrong[1].strip("'"), wrong[2]
    if kind is None:
        advice = f"give a number from {option.type.min} to {option.type.max}"
    else:
        advice = "write a whole number" if kind == "int" else "write a number"
    return f"{option.opts[0]} {value}: {advice}"


def _exit_after_closed_pipe() -> NoReturn:
    """Exit silently where the reader of the output, such as `head`, has closed the pipe."""
    # Python flushes standard output once more at exit, which would raise again
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    sys.exit(1)


def _show_version(requested: bool) -> None:
    if requested:
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
    str,
    typer.Argument(
        help="A folder of maps, a picture, or sample:NAME (bricks, cobbles, …).", metavar="FOLDER"
    ),
]
_picture_option = functools.partial(typer.Option, rich_help_panel="Picture")
_OUTPUT = ("-o", "--output")
_SCENE_OPTIONS = (
    options.RELIEF, options.SURFACE, options.LIGHT, options.FOG, options.CAMERA,
)  # fmt: skip
_NOT_MEASURED = (
    "shape", "stretch", "turn", "tiling", "heights", "fade", "edge", "alpha", "casts", "shadows_on",
    "shadow_map_size",
)  # fmt: skip
"""Options of a scene that a measurement decides itself, or has no use for."""
DeviceOption = Annotated[
    str,
    _picture_option(
        help="Device: auto, cpu or gpu.", autocompletion=lambda: ["auto", "cpu", "gpu"]
    ),
]


def _without_none(options: dict[str, Any]) -> dict[str, Any]:
    """The options that were given; those left at None get their defaults elsewhere."""
    return {name: value for name, value in options.items() if value is not None}


def _load_material(path: str, **maps: Any) -> Material:
    from basrelief.material import load

    return load(path, **_without_none(maps))


def _preset_and_maps(values: dict[str, Any]) -> tuple[Preset, dict[str, Any]]:
    """Remove the preset and the options of maps from `values`, and return them."""
    from basrelief.cli import arguments

    maps = {name: values.pop(name) for name in options.MAPS_OPTIONS}
    arguments.check_lengths(maps["depth"], maps["tile"], values["scale"])
    return arguments.preset_from(values.pop("preset")), _without_none(maps)


def _scene(path: str, preset: Preset, maps: dict[str, Any], values: dict[str, Any]) -> Scene:
    """The scene that the options of a command describe."""
    from basrelief.cli import arguments

    material = _load_material(path, **{**preset.maps, **maps})
    return arguments.scene(
        material, preset=preset, measured="depth" in maps, **_without_none(values)
    )


def _measured(
    path: str, techniques: list[str] | None, settings: list[str] | None, values: dict[str, Any]
) -> tuple[Material, MeasuredOptions]:
    """The material of a command that measures techniques, and its options."""
    from basrelief.cli import arguments

    preset, maps = _preset_and_maps(values)
    material = _load_material(path, **{**preset.maps, **maps})
    return material, arguments.measured_options(
        material, techniques, settings or [], preset=preset, measured="depth" in maps,
        **_without_none(values),
    )  # fmt: skip


@app.command()
@options.with_options(..., options.MAPS_OPTIONS)
def info(
    path: PathArgument,
    json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
    **maps: Any,
) -> None:
    """Report which maps were found, how they are read, and why."""
    import json as json_text

    from basrelief.material import describe, report

    with _Progress(f"reading {path}"):
        material = _load_material(path, **maps)
    print(json_text.dumps(describe(material), indent=2) if json else report(material))


@app.command()
def techniques() -> None:
    """List the techniques: method, cost, source and settings."""
    import inspect

    from basrelief.scene import Object, Scene
    from basrelief.scene.records import SCENE_RECORDS
    from basrelief.scene.resolve import SURFACES
    from basrelief.techniques import TECHNIQUES
    from basrelief.techniques.height import Smoothing

    def with_choice(what: str, record: type, name: str) -> str:
        """A heading with the values of a choice that make its numbers count."""
        choice = settings_of(record)[name]
        acting = [value for value in choice.choices if value != choice.default]
        return f"{what} ({choice.option} {', '.join(acting)})"

    for technique in TECHNIQUES.values():
        height, projection = technique.reference_height, technique.projection
        defaults = f"Defaults: --reference-height {height:g} --projection {projection}"
        doc = inspect.cleandoc(technique.__doc__ or "")
        paragraphs = doc.replace("References\n----------\n", "Reference: ").split("\n\n")
        _print_entry(technique.name, [*paragraphs, defaults], technique.settings)
    _print_entry("with every technique", ["Besides its own, --set sets the numbers below."])
    _print_entry(with_choice("smooth heights", Object, "heights"), [], Smoothing)
    for surface, record in SURFACES.items():
        _print_entry(f"the {surface} surface (--surface {surface})", [], record)
    headings = {
        "shadowing": with_choice("shadows of the relief on itself", Scene, "shadows"),
        "fog": with_choice("the fog", Scene, "fog_mode"),
    }
    for name, (record, owner) in SCENE_RECORDS.items():
        _print_entry(headings.get(name, owner), [], record)


@app.command()
def presets() -> None:
    """List the presets: settings of an article under one name."""
    from basrelief.scene.presets import PRESETS
    from basrelief.scene.presets import preset as preset_named

    for name in PRESETS:
        preset = preset_named(name)
        _print_entry(name, [preset.about, f"After {preset.source}."])


def _print_entry(name: str, paragraphs: list[str], *records: Any) -> None:
    """Print a heading, indented paragraphs, and a table of the settings of records."""
    import textwrap

    print(name)
    for paragraph in paragraphs:
        if paragraph.startswith("    "):
            print(textwrap.indent(paragraph, "  "))  # a formula
            continue
        print(
            textwrap.fill(
                paragraph, 78, initial_indent="  ", subsequent_indent="  ", break_on_hyphens=False
            )
        )
    rows = [
        (f"{name}={declared.default_text}", declared.range_text, declared.doc)
        for record in records
        for name, declared in settings_of(record).items()
    ]
    # zip(*rows) is empty, and nothing is printed, where there are no settings
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    for row in rows:
        cells = [cell.ljust(width) for cell, width in zip(row, widths, strict=True)]
        print("    " + "  ".join(cells).rstrip())
    print()


@app.command()
@options.with_options(*_SCENE_OPTIONS, ..., options.MAPS_OPTIONS, options.FURTHER)
def render(
    path: PathArgument,
    output: Annotated[
        Path | None, _picture_option(*_OUTPUT, help="File: png, jpg, webp, exr …, or mp4, gif.")
    ] = None,
    size: Annotated[str, _picture_option(help="Width × height in pixels.")] = "1280x720",
    samples: Annotated[int, _picture_option(help="Samples per pixel.")] = 4,
    bits: Annotated[int | None, _picture_option(help="Bits per channel: 8, or 16 for PNG.")] = None,
    quality: Annotated[
        int, _picture_option(min=1, max=100, help="Quality of JPEG, WebP and MP4.")
    ] = 95,
    frames: Annotated[
        int, _picture_option(help="Frames; more than 1 make a film or numbered pictures.")
    ] = 1,
    fps: Annotated[float, _picture_option(help="Frames per second of a film.")] = 30.0,
    motion: Annotated[
        list[str] | None,
        _picture_option(
            help="Motion in a film: orbit · light · scroll,u=0.25,v=0 · opening; repeatable.",
            metavar="NAME,NAME=VALUE…",
        ),
    ] = None,
    show: Annotated[
        str,
        _picture_option(
            help="Picture: color, reads, missed, overshoot, depth-error or shadow-error."
        ),
    ] = "color",
    device: DeviceOption = "auto",
    timings: Annotated[
        bool, _picture_option("--timings", help="Print where the time goes, step by step.")
    ] = False,
    **values: Any,
) -> None:
    """Draw a material, as a picture or a film."""
    with _Progress(f"reading {path}") as progress, _measured_time(timings):
        from basrelief.cli import arguments
        from basrelief.rendering import film

        pixels = arguments.size(size)
        preset, maps = _preset_and_maps(values)
        motions = arguments.motions_from(motion or [], frames, preset, measured="depth" in maps)
        scene = _scene(path, preset, maps, values)
        obj = scene.resolved[0]
        material, technique_name = obj.material, obj.technique.name
        suffix = "" if show == "color" else f"-{show}"
        # `load` recognises this name, and does not take the picture for a map
        target = output or Path(f"{material.name}-{technique_name}{suffix}-basrelief.png")
        film.check_film(target, frames, fps, pixels, bits=bits, quality=quality)
        progress.task = f"drawing {material.name}"
        if show != "color":
            _draw_debug_picture(show, scene, pixels, samples, device, frames, target, bits, quality)
            _note_unused_dust(maps, scene, ())
            return
        rendered = film.frames(
            scene, motions, count=frames, fps=fps, size=pixels, samples=samples, device=device,
            progress=progress,
        )  # fmt: skip
        written = film.write_film(target, rendered, fps, count=frames, bits=bits, quality=quality)
    _note_unused_dust(maps, scene, motions)
    if material.height is None and values["technique"] is None:
        note = f"note: {material.name} has no height map, so it is drawn flat"
        print(note, file=sys.stderr)
    if scene.background is None and target.suffix.lower() == ".mp4":
        note = (
            "note: MP4 has no transparency, so the film is composited over the default background"
        )
        print(note, file=sys.stderr)
    # a numbered series is reported by its first and last file
    files = " … ".join(map(str, dict.fromkeys((written.files[0], written.files[-1]))))
    print(f"{files}  ({written.device})")


@contextlib.contextmanager
def _measured_time(shown: bool) -> Iterator[None]:
    """Print where the time of the command went, if it is to be shown."""
    if not shown:
        yield
        return
    from basrelief.timings import Timings

    with Timings(since=_STARTED) as timings:
        yield
    print(timings, file=sys.stderr)


def _note_unused_dust(maps: dict[str, Any], scene: Scene, motions: Sequence[Motion]) -> None:
    """Print a note where dust was named and no hole opens."""
    from basrelief.scene.motion import Opening

    opens = any(isinstance(motion, Opening) for motion in motions)
    if "dust" in maps and scene.objects[0].opening is None and not opens:
        note = "note: no hole opens, so --dust changes nothing; add --opening 0.6"
        print(note, file=sys.stderr)


def _draw_debug_picture(
    kind: str,
    scene: Any,
    size: tuple[int, int],
    samples: int,
    device: str,
    frames: int,
    target: Path,
    bits: int | None,
    quality: int,
) -> None:
    """Draw a debug picture and print the meaning of its colours."""
    from basrelief.engine import choose_device
    from basrelief.errors import InputError
    from basrelief.measure.debug import check_shown, debug_picture
    from basrelief.measure.light import shown_light
    from basrelief.measure.truth import truth
    from basrelief.rendering.render import render

    check_shown(kind)
    if frames != 1:
        raise InputError(f"--show {kind}: draws a single picture; omit --frames")
    columns = [obj.technique.name for obj in scene.resolved if obj.technique.columns]
    if columns and kind != "reads":
        raise InputError(
            f"--show {kind} measures against the bilinear surface, but {columns[0]} draws columns; "
            "use --show reads or another technique"
        )
    if kind == "shadow-error" and scene.shadows == "none":
        raise InputError("--show shadow-error: the picture has no shadows; add --shadows hard")
    if kind == "shadow-error" and not scene.lights:
        raise InputError("--show shadow-error: the picture has no light; omit --light none")
    engine = choose_device(device)
    reference = None if kind == "reads" else truth(scene, size, device=engine)
    frame = render(scene, size=size, samples=samples, device=engine)
    light = shown_light(scene, size, engine) if kind == "shadow-error" else None
    picture = debug_picture(kind, frame, reference, light)
    picture.image.save(target, bits=bits, quality=quality)
    print(f"{target}  ({frame.device})\n{picture.meaning}")


@app.command()
@options.with_options(
    ...,
    options.RELIEF,
    options.SURFACE,
    options.LIGHT,
    options.FOG,
    options.MAPS_OPTIONS,
    omit=_NOT_MEASURED,
)
def compare(
    path: PathArgument,
    output: Annotated[
        Path | None,
        typer.Option(*_OUTPUT, help="Folder for the page, pictures and compare.json."),
    ] = None,
    technique: Annotated[
        list[str] | None,
        typer.Option(
            help="Technique to compare (all), or relief,max_steps=64; repeatable.",
            metavar="NAME|FILE.py:NAME[,SETTING=VALUE…]",
        ),
    ] = None,
    settings: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            help="Setting of all techniques that have it; repeatable.",
            metavar="NAME=VALUE",
        ),
    ] = None,
    angles: Annotated[str, typer.Option(help="Degrees from the normal.")] = "0,45,60,75,85",
    size: Annotated[str, typer.Option(help="Width × height of each picture.")] = "480x270",
    samples: Annotated[int, typer.Option(help="Samples per pixel.")] = 4,
    device: DeviceOption = "auto",
    **values: Any,
) -> None:
    """Measure every technique on a material and recommend one, on a page with pictures."""
    with _Progress(f"reading {path}") as progress:
        from basrelief.cli import arguments
        from basrelief.measure.compare import compare as compare_techniques
        from basrelief.measure.report import check_folder

        degrees, pixels = arguments.numbers(angles, "--angles"), arguments.size(size)
        material, read = _measured(path, technique, settings, values)
        folder = output or Path(f"{material.name}-compare")
        check_folder(folder)

        result = compare_techniques(
            material, read.techniques, angles=degrees, size=pixels, samples=samples, device=device,
            settings={**read.preset_settings, **read.settings}, drawn=read.drawn,
            progress=progress.report, **read.measured,
        )  # fmt: skip
        page = result.save(folder)
    print(f"{result.summary()}\n\n{result.recipe.command}\n\n{page}  ({result.device})")


@app.command()
@options.with_options(
    ...,
    options.RELIEF,
    options.SURFACE,
    options.LIGHT,
    options.FOG,
    options.MAPS_OPTIONS,
    omit=_NOT_MEASURED,
)
def tune(
    path: PathArgument,
    missed: Annotated[
        str | None, typer.Option(help="Bound on missed hits, for example 0.1%.", metavar="SHARE")
    ] = None,
    flip: Annotated[
        float | None, typer.Option(help="Bound on the FLIP error, for example 0.05.")
    ] = None,
    angles: Annotated[
        str, typer.Option(help="Range of angles from the normal, in degrees.")
    ] = "0-75",
    output: Annotated[
        Path | None, typer.Option(*_OUTPUT, help="Preset to write, a .toml file.")
    ] = None,
    technique: Annotated[
        list[str] | None,
        typer.Option(help="Technique to try (all); repeatable.", metavar="NAME|FILE.py:NAME"),
    ] = None,
    settings: Annotated[
        list[str] | None,
        typer.Option("--set", help="Setting with a fixed value; repeatable.", metavar="NAME=VALUE"),
    ] = None,
    size: Annotated[str, typer.Option(help="Width × height of the measured pictures.")] = "320x180",
    device: DeviceOption = "auto",
    **values: Any,
) -> None:
    """Find the cheapest technique and settings that keep an error under a bound."""
    with _Progress(f"reading {path}") as progress:
        from basrelief.cli import arguments
        from basrelief.measure.tune import tune as tune_material
        from basrelief.scene.presets import scene_of
        from basrelief.scene.presets.record import check_preset_file
        from basrelief.scene.recipe import Recipe

        if (missed is None) == (flip is None):
            raise InputError("give one bound: --missed 0.1% or --flip 0.05")
        bound = None if missed is None else arguments.fraction(missed, "--missed")
        degrees, pixels = arguments.span(angles, "--angles"), arguments.size(size)
        material, read = _measured(path, technique, settings, values)
        target = output or Path(f"{material.name}-tuned.toml")
        check_preset_file(target)
        # what a preset cannot say is refused before the search, which takes long
        Recipe(scene_of(material, read.drawn)).preset(target.stem)

        result = tune_material(
            material, missed=bound, flip=flip, angles=degrees, techniques=read.techniques,
            size=pixels, device=device, settings=read.settings, drawn=read.drawn,
            progress=progress.report, **read.measured,
        )  # fmt: skip
        written = result.preset.save(target)
    print(f"{result.report()}\n\n{result.command}\n\n{written}  ({result.device})")


@app.command()
@options.with_options(..., options.BAKE, options.MAPS_OPTIONS)
def bake(
    path: PathArgument,
    what: Annotated[
        list[str] | None,
        typer.Argument(
            help=f"Maps to bake: {', '.join(FILE_BAKES)}.",
            metavar="MAP...",
            autocompletion=lambda: list(FILE_BAKES),
        ),
    ] = None,
    output: Annotated[
        Path | None, typer.Option(*_OUTPUT, help="Folder for the files (FOLDER/baked).")
    ] = None,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace existing files.")] = False,
    device: DeviceOption = "auto",
    **values: Any,
) -> None:
    """Bake maps from a material's heights, or heights from its normals, for other programs."""
    from basrelief.baking.files import BakeInput, FileOptions, bake_to

    for name, file in values.items():
        if name in FILE_BAKES and str(file).startswith("-"):
            raise InputError(f"--{name} names a file; {BAKE_EXAMPLE}")
    names = checked_bakes(what or [])
    of_files = {name: values.pop(name) for name in settings_of(FileOptions)}
    file_options = FileOptions(**_without_none(of_files))
    with _Progress(f"reading {path}") as progress:
        from basrelief.engine import choose_device
        from basrelief.rendering.programs import map_edge

        preset, maps = _preset_and_maps(values)
        scene = _scene(path, preset, maps, values)
        (obj,) = scene.resolved
        progress.task = f"baking {obj.material.name}"
        baking = BakeInput(
            obj.material, choose_device(device), map_edge(obj), obj.scale, file_options,
            opening=scene.objects[0].opening,
        )  # fmt: skip
        folder = output or (Path(path) if os.path.isdir(path) else Path(path).parent) / "baked"
        files = bake_to(folder, names, baking, overwrite=overwrite)
    for file, note in files:
        print(f"{file}  ({note})" if note else file)
    if set(names) & {"normal", "occlusion", "horizon"}:
        print(f"scale {obj.scale:g}: height range as a fraction of the map's width")


@app.command()
@options.with_options(*_SCENE_OPTIONS, ..., options.MAPS_OPTIONS, options.FURTHER)
def explain(
    path: PathArgument,
    pixel: Annotated[
        str,
        _picture_option(help="Pixel to explain, from the top left.", metavar="X,Y"),
    ],
    output: Annotated[
        Path | None, _picture_option(*_OUTPUT, help="File of the cross-section: svg, png or pdf.")
    ] = None,
    size: Annotated[str, _picture_option(help="Width × height in pixels.")] = "1280x720",
    table: Annotated[bool, _picture_option("--table", help="List each read.")] = False,
    **values: Any,
) -> None:
    """Show the reads of a technique along the ray of one pixel, and the true hit."""
    with _Progress(f"reading {path}"):
        from basrelief.cli import arguments
        from basrelief.measure.explain import explain as explain_pixel

        xy, pixels = arguments.pixel(pixel), arguments.size(size)
        preset, maps = _preset_and_maps(values)
        scene = _scene(path, preset, maps, values)
        explanation = explain_pixel(scene, pixel=xy, size=pixels)
        drawing = None if output is None else explanation.save(output)
    if any(obj.filter == "hardware" for obj in scene.objects):
        note = "note: heights are read as texels here, not by the filter of the graphics card"
        print(note, file=sys.stderr)
    print(explanation.summary)
    if table or drawing is None:
        print(explanation.table())
    if drawing is not None:
        print(drawing)


@app.command()
def demo(
    output: Annotated[Path, typer.Option(*_OUTPUT, help="Folder for the pictures.")] = Path(
        "basrelief-demo"
    ),
    device: DeviceOption = "auto",
) -> None:
    """Draw the samples with every technique and on every shape."""
    paths: list[tuple[Path, str]] = []
    with _Progress("drawing the samples") as progress:
        from basrelief.cli.demo import COUNT, pictures

        for picture in pictures(output, device):
            paths.append(picture)
            progress(len(paths) / COUNT)
    for path, command in paths:
        print(f"{path}\n    {command}")
    print(f"\nThe pictures are in {output}. Next: basrelief render FOLDER --technique relief")


@app.command()
@options.with_options(*_SCENE_OPTIONS, ..., options.MAPS_OPTIONS)
def view(
    path: PathArgument,
    output: Annotated[
        Path | None,
        typer.Option(*_OUTPUT, help="File of the page; by default a temporary one is opened."),
    ] = None,
    texels: Annotated[int, typer.Option(help="Largest side of the page's maps, in texels.")] = 1024,
    device: DeviceOption = "auto",
    **values: Any,
) -> None:
    """Make an interactive page of a material and open it in a browser."""
    with _Progress(f"reading {path}") as progress:
        import tempfile
        import webbrowser

        from basrelief.viewer import write_view

        if texels < 1:
            raise InputError(f"--texels {texels}: give at least 1")
        if output is not None and output.suffix.lower() not in (".html", ".htm"):
            raise InputError(f"--output {output}: name an HTML file, for example page.html")
        preset, maps = _preset_and_maps(values)
        scene = _scene(path, preset, maps, values)
        name = scene.objects[0].material.name
        target = output or Path(tempfile.mkdtemp("-basrelief")) / f"{name}.html"
        page = write_view(scene, target, texels=texels, device=device, progress=progress.report)
    if page.scaled_to is not None:
        width, height = page.scaled_to
        print(f"note: the page's maps are scaled to {width} × {height}", file=sys.stderr)
    print(target)
    if output is None and not webbrowser.open(target.resolve().as_uri()):
        print("note: no browser could be opened; open the page yourself", file=sys.stderr)


@app.command()
def gallery(
    output: Annotated[Path, typer.Argument(help="Folder for pages and pictures.")],
    device: DeviceOption = "auto",
    size: Annotated[str, typer.Option(help="Width × height of each picture.")] = "480x270",
    samples: Annotated[int, typer.Option(help="Samples per pixel.")] = 4,
    only: Annotated[list[str] | None, typer.Option(help="Page to draw; repeatable.")] = None,
    source: Annotated[
        str | None,
        typer.Option(help="Source: catlike, wikibooks, gamedev, halliwell, habrador or beyond."),
    ] = None,
) -> None:
    """Draw the comparisons of the five articles as pages with pictures, settings and costs."""
    with _Progress("drawing the gallery") as progress:
        from basrelief.cli import arguments
        from basrelief.engine import choose_device
        from basrelief.gallery.folder import chosen as chosen_pages
        from basrelief.gallery.folder import write

        def report(page: str, share: float) -> None:
            progress.task = f"drawing: {page}"
            progress(share)

        pages, pixels = chosen_pages(only or [], source), arguments.size(size)
        index = write(output, pages, choose_device(device), pixels, samples, report)
    print(index)


# --- progress ------------------------------------------------------------------------------------

_PROGRESS_DELAY = 1.0
"""Seconds after which the progress of a task is shown."""


class _Progress:
    """A progress bar on standard error, if that is a terminal and the task takes over a second.

    Call it with the finished share, 0 to 1; before the first call the bar shows no share.
    """

    def __init__(self, task: str) -> None:
        self.task = task
        self.share: float | None = None
        self.bar: Any = None
        self.timer = threading.Timer(_PROGRESS_DELAY, self._show)
        self.timer.daemon = True

    def __enter__(self) -> _Progress:
        if sys.stderr.isatty():
            self.timer.start()
        return self

    def __call__(self, share: float) -> None:
        """Set the finished share of the task."""
        self.share = share
        self._update()

    def report(self, task: str, share: float) -> None:
        """Set the task's name and its finished share."""
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
