"""Every technique on one material, from head-on to grazing: errors, costs, pictures.

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
from basrelief.material import Material, load
from basrelief.measure.advice import VISIBLE, advice
from basrelief.measure.errors import errors, flip, has_flip, uv_error
from basrelief.measure.report import write
from basrelief.measure.results import Result, Results, settings_of
from basrelief.measure.timing import RUNS, Timing, seconds_of, timing_on
from basrelief.measure.truth import truth
from basrelief.measure.views import ANGLES, at_angle
from basrelief.rendering.render import check_picture, render
from basrelief.scene import Object, Scene, technique_named
from basrelief.techniques import TECHNIQUES, Technique, exact

__all__ = ["Candidate", "Comparison", "Result", "compare"]

VERSION = 2
"""Of `compare.json`; raised when a key is renamed, removed or changes its meaning."""
Progress = Callable[[str, float], None]
"""Hears what is being measured, and the share of the whole that is done."""


@dataclass(frozen=True, eq=False)
class Candidate:
    """A technique with settings, under a name of its own within a comparison.

    `spelled` is how it is asked for: its name, or FILE.py:NAME.
    """

    name: str
    technique: Technique[..., Any]
    settings: Mapping[str, Any]
    spelled: str


@dataclass(frozen=True, eq=False)
class Comparison(Results):
    """Errors and costs of techniques on one material, and the technique to ship."""

    def summary(self) -> str:
        """What to ship, in a sentence or two of plain text."""
        return advice(self).sentence(max(self.angles))

    def to_dict(self) -> dict[str, Any]:
        """What `compare.json` holds; docs/compare.md describes the keys."""
        return {
            "format": "basrelief compare",
            "version": VERSION,
            "basrelief": __version__,
            "material": self.material,
            "texels": list(self.texels),
            "scale": self.scale,
            "device": self.device,
            "size": list(self.size),
            "samples": self.samples,
            "time": {"size": list(self.timing.size), "by": self.timing.by, "runs": self.runs},
            "angles": list(self.angles),
            "visible": VISIBLE,
            "techniques": [_described(name, each) for name, each in self.objects.items()],
            "results": [_result(each) for each in self.results],
            "advice": advice(self).to_dict(),
        }

    def save(self, folder: str | os.PathLike[str]) -> Path:
        """Write `index.html`, its pictures and `compare.json`; returns the page's path.

        Raises InputError for a folder that cannot be written to, or with another `index.html`.
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
    progress: Progress = lambda what, share: None,
    **options: Any,
) -> Comparison:
    """Measure techniques on a material, or on what is in a folder, at some angles.

    `techniques` are names, "FILE.py:NAME", techniques or `Candidate`s, all of the library's without
    it; "relief,max_steps=64" is one with settings of its own. `exact` is always among them: FLIP
    is measured against its picture. `angles` are degrees from the normal, `size` (width, height).
    `settings` go to every technique that has them. `options` are those of `Object` and `Scene`
    (`scale`, `level`, `projection`, `lights` …). `progress` hears what is being measured, and the
    share that is done.
    Raises InputError for a material without a height map, and for what `render` would refuse.
    """
    size = check_picture(size, samples)
    material = what if isinstance(what, Material) else load(what)
    chosen = candidates(techniques, settings or {})
    check_measurable(material, options)
    engine = engine_of(device)
    angles = tuple(dict.fromkeys(float(angle) for angle in angles))
    if not angles:
        raise InputError("there are no angles; give one, as 60")
    # all views are made before the first is measured, so that what is wrong is told at once
    views = {
        angle: {
            each.name: at_angle(
                material, angle, size,
                {**options, "technique": each.technique, "settings": each.settings},
            )
            for each in chosen
        }
        for angle in angles
    }  # fmt: skip
    timing = timing_on(engine, size)
    results: list[Result] = []
    for number, (angle, scenes) in enumerate(views.items()):

        def heard(share: float, angle: float = angle, number: int = number) -> None:
            progress(f"measuring {material.name} at {angle:g}°", (number + share) / len(views))

        results += _at_one_angle(angle, scenes, size, samples, timing, runs, engine, heard)
    first = views[angles[0]]
    cost = {
        name: float(np.mean([each.seconds for each in results if each.technique == name]))
        for name in first
    }
    results.sort(key=lambda each: (angles.index(each.angle), cost[each.technique]))
    height = material.height
    assert height is not None
    return Comparison(
        material=material.name,
        texels=(height.width, height.height),
        scale=first["exact"].objects[0].relief_scale,
        device=f"{engine.name}: {engine.adapter}",
        size=size,
        samples=samples,
        timing=timing,
        runs=runs,
        angles=angles,
        objects={name: first[name].objects[0] for name in sorted(cost, key=lambda n: cost[n])},
        results=tuple(results),
    )


def check_measurable(material: Material, options: Mapping[str, Any]) -> None:
    """Raise InputError for a material without heights, and for options that fix the view."""
    if material.height is None:
        raise InputError(
            f"{material.name} has no height map, so no technique has anything to do; add one, "
            "for example --height FILE"
        )
    ours = ("shape", "tiling", "transform", "camera", "technique", "alpha", "edge", "fade")
    for name in (*ours, "heights"):
        if name in options:
            raise InputError(f"{name}: a comparison sets it itself; leave it away")


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
    """One angle, all techniques: they fill the same space, so one truth holds for all."""
    progress(0.0)
    true = truth(scenes["exact"], size, device=engine)
    reference = render(scenes["exact"], size=size, samples=samples, device=engine)
    progress(0.5)
    seconds = seconds_of(scenes, timing, engine, runs)
    for number, (name, scene) in enumerate(scenes.items()):
        drawn = name != "exact"
        frame = render(scene, size=size, samples=samples, device=engine) if drawn else reference
        yield Result(
            angle=angle,
            technique=name,
            errors=errors(frame, true),
            flip=flip(reference, frame) if has_flip() else None,
            seconds=seconds[name],
            picture=frame.color[:, :, :3].astype(np.float16),
            off=uv_error(frame, true).astype(np.float16),
        )
        progress(0.6 + 0.4 * (number + 1) / len(scenes))


# --- which techniques ----------------------------------------------------------------------------


def candidates(
    techniques: Sequence[str | Technique[..., Any] | Candidate] | None,
    settings: Mapping[str, Any],
) -> list[Candidate]:
    """What is to be compared, `exact` among it, each under a name of its own.

    Raises InputError for techniques that there are not, and for settings that none of them has.
    """
    named = techniques
    if named is None:
        # those draw another surface, which the truth knows nothing of
        named = [name for name, each in TECHNIQUES.items() if not each.columns]
    found = [_candidate(each, settings) for each in named]
    for each in found:
        if each.technique.columns:
            raise InputError(
                f"{each.name} draws heights as boxes, and is exact on them; compare techniques "
                "that draw the bilinear surface"
            )
    if not any(each.technique is exact and each.name == "exact" for each in found):
        found.append(Candidate("exact", exact, {}, "exact"))
    known = {name for each in found for name in each.technique.settings.__dataclass_fields__}
    for name in settings:
        if name not in known:
            hint = new_name(name, known) or "none of these techniques has such a setting"
            raise InputError(f"{name}: {hint}")
    names = [each.name for each in found]
    for name in names:
        if names.count(name) > 1:
            raise InputError(f"{name} is there twice; give one of them other settings")
    return found


def _candidate(
    given: str | Technique[..., Any] | Candidate, settings: Mapping[str, Any]
) -> Candidate:
    if isinstance(given, Candidate):
        return given
    text, own = (given, {}) if not isinstance(given, str) else _own_settings(given)
    technique = technique_named(text)
    known = technique.settings.__dataclass_fields__
    for name in own:
        if name not in known:
            hint = suggestion(name, known, "it has")
            raise InputError(f"{technique.name} has no setting {name!r}; {hint}")
    name = " ".join([technique.name, *(f"{key}={value:g}" for key, value in own.items())])
    usual = {key: value for key, value in settings.items() if key in known}
    return Candidate(
        name, technique, {**usual, **own}, text if isinstance(text, str) else technique.name
    )


def _own_settings(text: str) -> tuple[str, dict[str, float]]:
    """Name and settings of "relief,max_steps=64"."""
    name, *parts = text.split(",")
    own = {}
    for part in parts:
        key, sign, number = part.partition("=")
        try:
            own[key.strip()] = float(number)
        except ValueError:
            sign = ""
        if not sign:
            raise InputError(f"{text}: write a technique and its settings as relief,max_steps=64")
    return name.strip(), own


# --- as JSON -------------------------------------------------------------------------------------


def _described(name: str, obj: Object) -> dict[str, Any]:
    return {
        "name": name,
        "technique": obj.selected_technique.name,
        "settings": settings_of(obj),
        "reference_height": obj.relief_reference_height,
        "projection": obj.relief_projection,
    }


def _result(each: Result) -> dict[str, Any]:
    found = each.errors
    return {
        "angle": each.angle,
        "technique": each.technique,
        "pixels": found.pixels,
        "missed": found.missed,
        "passed": found.passed,
        "short": found.short,
        "uv_error": asdict(found.uv),
        "depth_error": asdict(found.depth),
        "flip": each.flip,
        "reads": found.reads,
        "seconds": each.seconds,
    }


def to_json(comparison: Comparison) -> str:
    """The text of `compare.json`."""
    return json.dumps(comparison.to_dict(), indent=2, ensure_ascii=False) + "\n"
