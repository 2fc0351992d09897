"""Comparison of techniques on one material, from head-on to grazing: errors, costs, pictures.

    basrelief.compare("FOLDER").save("OUT")

writes a page for people (`measure.report`) and `compare.json` for programs.
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from basrelief._version import __version__
from basrelief.engine import Engine, engine_of
from basrelief.errors import InputError, new_name, suggestion
from basrelief.lang.types import fields_of
from basrelief.material import Material, load
from basrelief.measure.advice import VISIBLE, advice
from basrelief.measure.errors import errors, flip, has_flip, uv_error
from basrelief.measure.light import light_of
from basrelief.measure.report import write
from basrelief.measure.results import Result, Results, filter_of, settings_of
from basrelief.measure.timing import RUNS, Timing, seconds_of, timing_on
from basrelief.measure.truth import truth
from basrelief.measure.views import ANGLES, SET_BY_MEASURE, at_angle
from basrelief.rendering.render import check_device, check_picture, render
from basrelief.scene import ResolvedObject, Scene, technique_named
from basrelief.scene.presets import scene_of
from basrelief.scene.recipe import Recipe
from basrelief.techniques import TECHNIQUES, Technique, exact
from basrelief.threads import map_on_threads

__all__ = ["Candidate", "Comparison", "Result", "compare"]

VERSION = 2
"""Version of `compare.json`; raised when a key is renamed, removed or changes its meaning."""
Progress = Callable[[str, float], None]
"""Progress callback: the current task and the finished share, 0 to 1."""


@dataclass(frozen=True, eq=False)
class Candidate:
    """A technique with settings, under a name that is unique within a comparison.

    `spelled` is the technique as it was requested: its name, or FILE.py:NAME.
    """

    name: str
    technique: Technique[..., Any]
    settings: Mapping[str, Any]
    spelled: str

    def recipe(self, material: Material, options: Mapping[str, Any]) -> Recipe:
        """The material drawn with this technique, and options of `Object` and `Scene`."""
        own: dict[str, Any] = {"technique": self.technique, "settings": self.settings}
        if options.get("heights", "sharp") not in self.technique.takes_heights:
            own["heights"] = "sharp"
        if self.technique.solves_cells:
            own["filter"] = "texel"
        return Recipe(scene_of(material, {**options, **own}))


@dataclass(frozen=True, eq=False)
class Comparison(Results):
    """Errors and costs of techniques on one material, and the technique to ship.

    Attributes
    ----------
    material : str
        Name of the material.
    texels : (int, int)
        Width and height of its height map.
    scale : float
        Height range as a fraction of a tile's width.
    device : str
        Engine and adapter that ran the shaders.
    filter : {"texel", "hardware"}
        Filter of the heights.
    filtered_format : str or None
        WebGPU's name of the format of the heights that the graphics card filters; None for texels.
    size : (int, int)
        Width and height of the pictures, in pixels.
    samples : int
        Samples a pixel.
    timing : Timing
        Picture size and clock of the times.
    runs : int
        Runs of which each time is the median.
    angles : tuple of float
        Angles between view and normal, in degrees.
    objects : dict of str to ResolvedObject
        Objects by the technique's name, the fastest first.
    recipes : dict of str to Recipe
        The material drawn with each technique, as a command, as Python and as a preset.
    results : tuple of Result
        Measurements by angle, then by technique, the fastest first.
    """

    def summary(self) -> str:
        """The recommended technique, and a filter other than that of texels, in a few sentences of
        plain text."""
        text = advice(self).sentence(max(self.angles))
        return text if self.filter == "texel" else f"{text} {self.filter_text}"

    @property
    def recipe(self) -> Recipe:
        """The recommended technique on the material."""
        return self.recipes[advice(self).technique]

    def to_dict(self) -> dict[str, Any]:
        """The content of `compare.json`; docs/compare.md describes the keys."""
        return {
            "format": "basrelief compare",
            "version": VERSION,
            "basrelief": __version__,
            "material": self.material,
            "texels": list(self.texels),
            "scale": self.scale,
            "device": self.device,
            "filter": self.filter,
            "filtered_format": self.filtered_format,
            "size": list(self.size),
            "samples": self.samples,
            "time": {"size": list(self.timing.size), "by": self.timing.by, "runs": self.runs},
            "angles": list(self.angles),
            "visible": VISIBLE,
            "techniques": [
                {**_technique(name, obj), "command": self.recipes[name].command}
                for name, obj in self.objects.items()
            ],
            "results": [_result(result) for result in self.results],
            "advice": advice(self).to_dict(),
        }

    def save(self, folder: str | os.PathLike[str]) -> Path:
        """Write `index.html`, its pictures and `compare.json` to a folder.

        Parameters
        ----------
        folder : path
            The folder; it is made if missing.

        Returns
        -------
        Path
            The path of `index.html`.

        Raises
        ------
        InputError
            For a folder that cannot be written to, or that has another `index.html`.
        """
        return write(Path(folder), self, to_json(self))


def compare(
    what: Material | str | os.PathLike[str],
    techniques: Sequence[str | Technique[..., Any] | Candidate] | None = None,
    *,
    angles: Sequence[float] = ANGLES,
    size: tuple[int, int] = (480, 270),
    samples: int = 4,
    device: str | Engine = "auto",
    runs: int = RUNS,
    settings: Mapping[str, Any] | None = None,
    drawn: Mapping[str, Any] | None = None,
    progress: Progress = lambda what, share: None,
    **options: Any,
) -> Comparison:
    """Measure errors and costs of techniques on a material, at several angles.

    Parameters
    ----------
    what : Material or path
        A material, or a folder of maps, a picture or "sample:NAME".
    techniques : sequence of str, Technique or Candidate, optional
        Names, "FILE.py:NAME" or techniques; by default all of the library's. Settings may follow
        a name: "relief,max_steps=64". `exact` is always added, as FLIP is measured against its
        picture.
    angles : sequence of float
        Angles between view and normal, in degrees, 0 to 89.
    size : (int, int)
        Width and height of the pictures, in pixels.
    samples : int
        Samples a pixel.
    device : str or Engine
        "auto", "cpu" or "gpu", or an engine.
    runs : int
        Runs of which each time is the median.
    settings : mapping, optional
        Settings for every technique that has them.
    drawn : mapping, optional
        Fields of `Object` and `Scene` for the recipes of the result, in place of `options`; also
        those that a comparison sets itself, such as `shape` and `camera`.
    progress : callable
        Called with the current task and the finished share, 0 to 1.
    **options
        Fields of `Object` and `Scene` that do not set the view: `scale`, `reference_height`,
        `projection`, `lights` and so on.

    Returns
    -------
    Comparison

    Raises
    ------
    InputError
        For a material without a height map, and whatever `render` refuses.

    References
    ----------
    P. Andersson et al., FLIP: A Difference Evaluator for Alternating Images, 2020.
    """
    size = check_picture(size, samples)
    material = what if isinstance(what, Material) else load(what)
    chosen = candidates(techniques, settings or {})
    check_measurable(material, options)
    engine = engine_of(device)
    angles = tuple(dict.fromkeys(float(angle) for angle in angles))
    if not angles:
        raise InputError("there are no angles; give one, for example 60")
    # all scenes are made before the first measurement, so that errors are reported at once
    views = {
        angle: {
            candidate.name: at_angle(
                material, angle, size,
                {**options, "technique": candidate.technique, "settings": candidate.settings},
            )
            for candidate in chosen
        }
        for angle in angles
    }  # fmt: skip
    first = views[angles[0]]
    check_device(first["exact"], engine)
    timing = timing_on(engine, size)
    results: list[Result] = []
    for number, (angle, scenes) in enumerate(views.items()):

        def report(share: float, angle: float = angle, number: int = number) -> None:
            progress(f"measuring {material.name} at {angle:g}°", (number + share) / len(views))

        results += _at_one_angle(angle, scenes, size, samples, timing, runs, engine, report)
    cost = {
        name: float(np.mean([result.seconds for result in results if result.technique == name]))
        for name in first
    }
    results.sort(key=lambda result: (angles.index(result.angle), cost[result.technique]))
    height = material.height
    assert height is not None
    return Comparison(
        material=material.name,
        texels=(height.width, height.height),
        scale=first["exact"].resolved[0].scale,
        device=f"{engine.name}: {engine.adapter}",
        **filter_of(first["exact"], engine),
        size=size,
        samples=samples,
        timing=timing,
        runs=runs,
        angles=angles,
        objects={name: first[name].resolved[0] for name in sorted(cost, key=lambda n: cost[n])},
        recipes={c.name: c.recipe(material, options if drawn is None else drawn) for c in chosen},
        results=tuple(results),
    )


def check_measurable(material: Material, options: Mapping[str, Any]) -> None:
    """Raise InputError for a material without heights, and for options that set the view."""
    if material.height is None:
        raise InputError(
            f"{material.name} has no height map, which techniques need; add one, "
            "for example --height FILE"
        )
    for name in SET_BY_MEASURE:
        if name in options:
            raise InputError(f"{name}: a comparison sets it itself; omit it")


def _at_one_angle(
    angle: float,
    scenes: Mapping[str, Scene],
    size: tuple[int, int],
    samples: int,
    timing: Timing,
    runs: int,
    engine: Engine,
    progress: Callable[[float], None],
) -> Iterable[Result]:
    """Results of all techniques at one angle, whose reliefs fill the same space: one truth."""
    progress(0.0)
    # nothing else runs meanwhile
    seconds = seconds_of(scenes, timing, engine, runs)
    progress(0.3)
    true = truth(scenes["exact"], size, device=engine)
    reference = render(scenes["exact"], size=size, samples=samples, device=engine)
    progress(0.5)

    def result_of(name: str) -> Result:
        scene, frame = scenes[name], reference
        if name != "exact":
            frame = render(scene, size=size, samples=samples, device=engine)
        return Result(
            angle=angle,
            technique=name,
            errors=errors(frame, true, light_of(scene, size, engine)),
            flip=flip(reference, frame) if has_flip() else None,
            seconds=seconds[name],
            picture=frame.color[:, :, :3].astype(np.float16),
            off=uv_error(frame, true).astype(np.float16),
        )

    # a frame is drawn while another is compared with the truth
    for number, result in enumerate(map_on_threads(result_of, scenes, threads=2), 1):
        yield result
        progress(0.5 + 0.5 * number / len(scenes))


# --- candidates ----------------------------------------------------------------------------------


def candidates(
    techniques: Sequence[str | Technique[..., Any] | Candidate] | None,
    settings: Mapping[str, Any],
) -> list[Candidate]:
    """The techniques to compare, `exact` included, under unique names.

    Raises InputError for unknown techniques, and for settings that none of them has.
    """
    requested = techniques
    if requested is None:
        # techniques of columns draw another surface than the truth's
        requested = [name for name, technique in TECHNIQUES.items() if not technique.columns]
    chosen = [_candidate(technique, settings) for technique in requested]
    for candidate in chosen:
        if candidate.technique.columns:
            raise InputError(
                f"{candidate.name} draws columns, not the bilinear surface; compare techniques "
                "that draw that"
            )
    if not any(candidate.technique is exact and candidate.name == "exact" for candidate in chosen):
        chosen.append(Candidate("exact", exact, {}, "exact"))
    known = {name for candidate in chosen for name in fields_of(candidate.technique.settings)}
    for name in settings:
        if name not in known:
            hint = new_name(name, known) or "none of these techniques has this setting"
            raise InputError(f"{name}: {hint}")
    names = [candidate.name for candidate in chosen]
    for name in names:
        if names.count(name) > 1:
            raise InputError(f"{name} appears twice; give one of them other settings")
    return chosen


def _candidate(
    requested: str | Technique[..., Any] | Candidate, settings: Mapping[str, Any]
) -> Candidate:
    if isinstance(requested, Candidate):
        return requested
    text, own = (requested, {}) if not isinstance(requested, str) else own_settings(requested)
    technique = technique_named(text)
    known = fields_of(technique.settings)
    for name in own:
        if name not in known:
            hint = suggestion(name, known, "it has")
            raise InputError(f"{technique.name} has no setting {name!r}; {hint}")
    name = " ".join([technique.name, *(f"{key}={value:g}" for key, value in own.items())])
    shared = {key: value for key, value in settings.items() if key in known}
    return Candidate(
        name, technique, {**shared, **own}, text if isinstance(text, str) else technique.name
    )


def own_settings(text: str) -> tuple[str, dict[str, float]]:
    """Name and settings from text such as "relief,max_steps=64"."""
    name, *parts = text.split(",")
    own = {}
    for part in parts:
        key, sign, number = part.partition("=")
        try:
            own[key.strip()] = float(number)
        except ValueError:
            sign = ""
        if not sign:
            raise InputError(
                f"{text}: write a technique and its settings, for example relief,max_steps=64"
            )
    return name.strip(), own


# --- as JSON -------------------------------------------------------------------------------------


def _technique(name: str, obj: ResolvedObject) -> dict[str, Any]:
    return {
        "name": name,
        "technique": obj.technique.name,
        "settings": settings_of(obj),
        "reference_height": obj.reference_height,
        "projection": obj.projection,
    }


def _result(result: Result) -> dict[str, Any]:
    errors = result.errors
    return {
        "angle": result.angle,
        "technique": result.technique,
        "pixels": errors.pixels,
        "missed": errors.missed,
        "passed": errors.passed,
        "short": errors.short,
        "wrong_light": errors.wrong_light,
        "uv_error": asdict(errors.uv),
        "depth_error": asdict(errors.depth),
        "flip": result.flip,
        "reads": errors.reads,
        "seconds": result.seconds,
    }


def to_json(comparison: Comparison) -> str:
    """The text of `compare.json`."""
    return json.dumps(comparison.to_dict(), indent=2, ensure_ascii=False) + "\n"
