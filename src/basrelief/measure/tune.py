"""Search for the cheapest technique and settings that keep an error under a bound, over angles.

Each technique is searched by itself. Its **effort** is the whole-number setting with the largest
default (`steps`, `max_steps`, …); a minimum number of steps changes in proportion. Other
whole-number settings (`search_steps`, …) are tried at half, once and twice their default; all
others keep their defaults. The effort is doubled until the error is under the bound at every angle,
then found by bisection between the last failure and the first success. As errors need not fall with
effort, every trial is measured, never inferred from its neighbours. The result is the fastest trial
that passes, by measured time on this device.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal, assert_never

import numpy as np

from basrelief.engine import Engine, engine_of
from basrelief.errors import InputError
from basrelief.material import Material, load
from basrelief.measure.compare import Candidate, Progress, candidates, check_measurable
from basrelief.measure.errors import flip as flip_of
from basrelief.measure.errors import has_flip, missed, wrong_light
from basrelief.measure.light import light_of
from basrelief.measure.results import filter_of, filter_sentence, settings_of
from basrelief.measure.timing import Timing, seconds_of, timing_on
from basrelief.measure.truth import Truth, truth
from basrelief.measure.views import at_angle
from basrelief.rendering.frame import Frame
from basrelief.rendering.render import check_device, check_picture, render
from basrelief.scene import Scene
from basrelief.scene.presets import Preset
from basrelief.scene.recipe import Recipe
from basrelief.settings import settings_of as settings_of_record
from basrelief.settings.kinds import FilterKind
from basrelief.techniques import Technique

__all__ = ["Trial", "TuneResult", "tune"]

ANGLE_STEP = 15.0
"""Largest difference between neighbouring angles that are measured, in degrees."""
MAX_EFFORT = 1024
"""Largest effort that is tried."""
_RUNS = 5
"""Timed runs of each trial at each angle; the median counts."""
Measure = Literal["missed", "flip"]
_MEASURE_NAMES: dict[tuple[Measure, bool], str] = {
    ("missed", False): "missed hits",
    ("missed", True): "missed hits or pixels in wrong light",
    ("flip", False): "FLIP",
    ("flip", True): "FLIP",
}
"""The bounded error in words, without and with shadows."""
_SAMPLES: dict[Measure, int] = {"missed": 1, "flip": 4}
"""Samples a pixel while a candidate is measured."""


@dataclass(frozen=True, eq=False)
class Trial:
    """A technique with settings, its largest error, the angle of that error and its mean time.

    Angles are in degrees, times in seconds. Measuring stops at the first angle, from grazing
    on, at which the error exceeds the bound.
    """

    candidate: Candidate
    passed: bool
    error: float
    angle: float
    seconds: float = 0.0


@dataclass(frozen=True, eq=False)
class TuneResult:
    """The cheapest technique and settings under a bound, and the alternatives.

    Attributes
    ----------
    chosen : Trial
        The fastest trial that stays under the bound at all angles.
    nearest : Trial or None
        Of the faster trials that exceed the bound, the one with the smallest error; None where
        there is none.
    others : tuple of Trial
        Other trials under the bound, the fastest first.
    measure : {"missed", "flip"}
        The bounded error: the share of missed hits, with shadows also of pixels in wrong light, or
        mean FLIP.
    bound : float
        The bound, 0 to 1.
    angles : tuple of float
        Measured angles between view and normal, in degrees, ascending.
    recipe : Recipe
        The chosen technique and settings on the material.
    settings : mapping
        All settings of the chosen technique.
    device : str
        Engine and adapter that ran the shaders.
    filter : {"texel", "hardware"}
        Filter of the heights.
    filtered_format : str or None
        WebGPU's name of the format of the heights that the graphics card filters; None for texels.
    """

    chosen: Trial
    nearest: Trial | None
    others: tuple[Trial, ...]
    measure: Measure
    bound: float
    angles: tuple[float, ...]
    recipe: Recipe
    settings: Mapping[str, Any]
    device: str
    filter: FilterKind
    filtered_format: str | None

    @property
    def command(self) -> str:
        """A command line that draws with the chosen technique and settings."""
        return self.recipe.command

    @property
    def python(self) -> str:
        """A line of Python that draws with the chosen technique and settings."""
        return self.recipe.python

    @property
    def preset(self) -> Preset:
        """A preset of the chosen technique and settings; `preset.save("mine.toml")` writes it."""
        name = self.recipe.scene.objects[0].material.name
        about = (
            f"For {name}: the cheapest with {self._error_text(self.chosen)}, "
            f"from {self.angles[0]:g} to {self.angles[-1]:g} degrees."
        )
        return self.recipe.preset(f"{name}-tuned", about)

    def report(self) -> str:
        """The chosen settings and the faster ones that just missed, in a few lines of text."""
        chosen = self.chosen
        low, high = self.angles[0], self.angles[-1]
        lines = [
            f"{_with_settings(chosen, self.settings)}: {self._error_text(chosen)} (bound "
            f"{self._formatted(self.bound)}), worst at {chosen.angle:g}°; "
            f"{chosen.seconds * 1e3:.3g} ms a picture, {low:g} to {high:g}°"
        ]
        if self.nearest is None:
            lines.append("nothing cheaper was tried")
        else:
            near = self.nearest
            faster = 100.0 * (1.0 - near.seconds / chosen.seconds)
            lines.append(
                f"just missed: {_with_settings(near)} would be {faster:.0f} % faster "
                f"({near.seconds * 1e3:.3g} ms), but has {self._error_text(near)} "
                f"at {near.angle:g}°"
            )
        if self.others:
            alternatives = ", ".join(
                f"{_with_settings(o)} ({o.seconds * 1e3:.3g} ms)" for o in self.others[:3]
            )
            lines.append(f"also under the bound: {alternatives}")
        if self.filter != "texel":
            lines.append(filter_sentence(self.filter, self.filtered_format))
        return "\n".join(lines)

    def _error_text(self, trial: Trial) -> str:
        shadows = self.recipe.scene.shadows != "none"
        return f"{self._formatted(trial.error)} {_MEASURE_NAMES[self.measure, shadows]}"

    def _formatted(self, error: float) -> str:
        match self.measure:
            case "missed":
                return f"{100.0 * error:.3g} %"
            case "flip":
                return f"{error:.3g}"
            case _:
                assert_never(self.measure)


def tune(
    what: Material | str | os.PathLike[str],
    *,
    missed: float | None = None,
    flip: float | None = None,
    angles: tuple[float, float] = (0.0, 75.0),
    techniques: Sequence[str | Technique[..., Any] | Candidate] | None = None,
    size: tuple[int, int] = (320, 180),
    device: str | Engine = "auto",
    settings: Mapping[str, Any] | None = None,
    drawn: Mapping[str, Any] | None = None,
    progress: Progress = lambda what, share: None,
    **options: Any,
) -> TuneResult:
    """Find the cheapest technique and settings for a material that keep an error under a bound.

    Parameters
    ----------
    what : Material or path
        A material, or a folder of maps, a picture or "sample:NAME".
    missed : float, optional
        Bound on the share of missed hits, 0 to 1; with shadows also of pixels in wrong light. Give
        either `missed` or `flip`.
    flip : float, optional
        Bound on the mean FLIP error, 0 to 1.
    angles : (float, float)
        Smallest and largest angle between view and normal, in degrees, 0 to 89. Angles between
        them are measured too, at most 15 degrees apart.
    techniques : sequence of str, Technique or Candidate, optional
        Techniques to try, as in `compare`; by default all of the library's but `exact`.
    size : (int, int)
        Width and height of the measured pictures, in pixels.
    device : str or Engine
        "auto", "cpu" or "gpu", or an engine.
    settings : mapping, optional
        Settings with fixed values, which are not searched.
    drawn : mapping, optional
        Fields of `Object` and `Scene` for the recipe of the result, as in `compare`.
    progress : callable
        Called with the current task and the finished share, 0 to 1.
    **options
        Fields of `Object` and `Scene`, as in `compare`.

    Returns
    -------
    TuneResult

    Raises
    ------
    InputError
        Where nothing stays under the bound, and as for `compare`.
    """
    if (missed is None) == (flip is None):
        raise InputError("give one bound: missed hits (missed=0.001) or FLIP (flip=0.05)")
    bound = flip if missed is None else missed
    assert bound is not None
    if not 0.0 <= bound <= 1.0:
        raise InputError(
            f"a bound of {bound:g}: give a share from 0 to 1, for example 0.001 for 0.1 %"
        )
    if flip is not None:
        check_flip()
    size = check_picture(size)
    material = what if isinstance(what, Material) else load(what)
    check_measurable(material, options)
    fixed = dict(settings or {})
    requested = [
        c
        for c in candidates(techniques, fixed)
        if techniques is None or _is_requested(c, techniques)
    ]
    engine = engine_of(device)
    view_angles = _view_angles(angles)
    measure: Measure = "missed" if flip is None else "flip"
    progress(f"computing the truth of {material.name}", 0.0)
    evaluator = _Evaluator(material, view_angles, size, engine, options, measure, bound)
    trials: list[Trial] = []
    for number, candidate in enumerate(requested):
        progress(f"trying {candidate.name}", 0.1 + 0.7 * number / len(requested))
        for variant in _variants(candidate, fixed):
            trials += _search(variant, fixed, evaluator.evaluate)
    if not any(trial.passed for trial in trials):
        closest = min(trials, key=lambda trial: trial.error)
        raise InputError(
            f"nothing stays under {bound:g} from {view_angles[0]:g} to {view_angles[-1]:g}°; "
            f"the closest is {_with_settings(closest)} with {closest.error:.3g} "
            f"at {closest.angle:g}°; "
            "raise the bound, or add the technique exact"
        )
    progress("timing", 0.85)
    timed = evaluator.timed(trials)
    passing = sorted((trial for trial in timed if trial.passed), key=lambda trial: trial.seconds)
    best = passing[0]
    cheaper = [trial for trial in timed if not trial.passed and trial.seconds < best.seconds]
    scene = evaluator.scene(best.candidate, view_angles[0])
    return TuneResult(
        chosen=best,
        nearest=min(cheaper, key=lambda trial: trial.error, default=None),
        others=tuple(passing[1:]),
        measure=measure,
        bound=bound,
        angles=view_angles,
        recipe=best.candidate.recipe(material, options if drawn is None else drawn),
        settings=settings_of(scene.resolved[0]),
        device=f"{engine.name}: {engine.adapter}",
        **filter_of(scene, engine),
    )


def check_flip() -> None:
    """Raise InputError where FLIP cannot be measured."""
    if not has_flip():
        raise InputError("FLIP needs NVIDIA's flip-evaluator; pip install 'basrelief[measure]'")


def _is_requested(candidate: Candidate, techniques: Sequence[Any]) -> bool:
    """Whether a technique was requested; `candidates` always adds `exact`, for `compare`."""
    return candidate.name != "exact" or any(
        technique == "exact" or getattr(technique, "name", None) == "exact"
        for technique in techniques
    )


def _view_angles(angles: tuple[float, float]) -> tuple[float, ...]:
    low, high = angles
    if not low <= high:
        raise InputError(f"angles from {low:g} to {high:g}: give the smaller first")
    count = int(np.ceil((high - low) / ANGLE_STEP)) + 1
    return tuple(float(angle) for angle in np.linspace(low, high, count))


# --- measuring -----------------------------------------------------------------------------------


class _Evaluator:
    """Views of a material with their references, against which candidates are measured."""

    def __init__(
        self,
        material: Material,
        angles: Sequence[float],
        size: tuple[int, int],
        engine: Engine,
        options: Mapping[str, Any],
        measure: Measure,
        bound: float,
    ) -> None:
        self.material, self.angles, self.size = material, angles, size
        self.engine, self.options, self.bound = engine, options, bound
        self.samples = _SAMPLES[measure]
        (exact,) = candidates(["exact"], {})
        check_device(self.scene(exact, angles[0]), engine)
        self.reference: dict[float, Truth | Frame] = {}
        for angle in angles:
            scene = self.scene(exact, angle)
            match measure:
                case "missed":
                    self.reference[angle] = truth(scene, size, device=engine)
                case "flip":
                    self.reference[angle] = self.render(scene)
                case _:
                    assert_never(measure)

    def scene(self, candidate: Candidate, angle: float) -> Scene:
        """The scene that draws a candidate at an angle."""
        variant = {"technique": candidate.technique, "settings": candidate.settings}
        return at_angle(self.material, angle, self.size, {**self.options, **variant})

    def render(self, scene: Scene) -> Frame:
        """Render a scene."""
        return render(scene, size=self.size, samples=self.samples, device=self.engine)

    def evaluate(self, candidate: Candidate) -> Trial:
        """Measure a candidate from grazing on, up to the first angle at which it fails."""
        worst = (-1.0, self.angles[0])
        for angle in reversed(self.angles):
            worst = max(worst, (self.error(candidate, angle), angle))
            if worst[0] > self.bound:
                return Trial(candidate, False, *worst)
        return Trial(candidate, True, *worst)

    def error(self, candidate: Candidate, angle: float) -> float:
        """Error of a candidate at one angle."""
        scene, reference = self.scene(candidate, angle), self.reference[angle]
        frame = self.render(scene)
        if isinstance(reference, Frame):
            return flip_of(reference, frame)
        wrong = missed(frame, reference)
        light = light_of(scene, self.size, self.engine)
        if light is not None:
            wrong |= wrong_light(light, reference)
        return float(wrong.sum() / max(int(reference.there.sum()), 1))

    def timed(self, trials: Sequence[Trial]) -> list[Trial]:
        """The trials with mean times over head-on, middle and grazing views, measured in turn."""
        timing: Timing = timing_on(self.engine, self.size)
        angles = sorted({self.angles[0], self.angles[len(self.angles) // 2], self.angles[-1]})
        times_by_angle = []
        for angle in angles:
            scenes = {str(k): self.scene(trial.candidate, angle) for k, trial in enumerate(trials)}
            times_by_angle.append(seconds_of(scenes, timing, self.engine, _RUNS))
        return [
            replace(trial, seconds=float(np.mean([times[str(k)] for times in times_by_angle])))
            for k, trial in enumerate(trials)
        ]


# --- searching -----------------------------------------------------------------------------------


def _search(
    candidate: Candidate, fixed: Mapping[str, Any], evaluate: Callable[[Candidate], Trial]
) -> list[Trial]:
    """The trial of the least effort that passes, then the last one that failed, if any."""
    effort_name = effort(candidate.technique, fixed)
    if effort_name is None:
        return [evaluate(candidate)]
    declared = settings_of_record(candidate.technique.settings)[effort_name]
    low = int(declared.low or 0)
    high = int(min(declared.high or MAX_EFFORT, MAX_EFFORT))

    def trial_of(count: int) -> Trial:
        return evaluate(_with_effort(candidate, effort_name, count, fixed))

    count, failed = max(low, 1), None
    best = trial_of(count)
    while not best.passed and count < high:
        failed, failed_count = best, count
        count = min(2 * count, high)
        best = trial_of(count)
    if not best.passed or failed is None:
        return [best]
    while count - failed_count > 1:
        middle = (failed_count + count) // 2
        trial = trial_of(middle)
        if trial.passed:
            best, count = trial, middle
        else:
            failed, failed_count = trial, middle
    return [best, failed]


def effort(technique: Technique[..., Any], fixed: Mapping[str, Any]) -> str | None:
    """The setting that a search varies: the whole number with the largest default, if any."""
    numbers = _whole_numbers(technique, fixed)
    return max(numbers, key=lambda name: numbers[name], default=None)


def _whole_numbers(technique: Technique[..., Any], fixed: Mapping[str, Any]) -> dict[str, int]:
    return {
        name: int(declared.default)
        for name, declared in settings_of_record(technique.settings).items()
        if declared.kind == "integer" and name not in fixed
    }


def _minimum_setting(technique: Technique[..., Any], effort_name: str) -> str | None:
    """The setting of the minimum that belongs to the maximum `effort_name`, if any."""
    name = effort_name.replace("max", "min")
    known = settings_of_record(technique.settings)
    return name if name != effort_name and name in known else None


def _with_effort(
    candidate: Candidate, effort_name: str, count: int, fixed: Mapping[str, Any]
) -> Candidate:
    """A candidate with this effort; a minimum number of steps changes in proportion."""
    declared = settings_of_record(candidate.technique.settings)
    settings = {**candidate.settings, effort_name: count}
    minimum = _minimum_setting(candidate.technique, effort_name)
    if minimum is not None and minimum not in fixed:
        ratio = int(declared[minimum].default) / int(declared[effort_name].default)
        settings[minimum] = max(int(declared[minimum].low or 0), round(count * ratio))
    return replace(candidate, settings=settings)


def _variants(candidate: Candidate, fixed: Mapping[str, Any]) -> Iterator[Candidate]:
    """A candidate with its other whole numbers at half, once and twice their default."""
    effort_name = effort(candidate.technique, fixed)
    minimum = effort_name and _minimum_setting(candidate.technique, effort_name)
    others = [
        name for name in _whole_numbers(candidate.technique, fixed)
        if name not in (effort_name, minimum, *candidate.settings)
    ]  # fmt: skip
    yield candidate
    for name in others:
        declared = settings_of_record(candidate.technique.settings)[name]
        low, high = declared.low or 0, declared.high
        for count in (int(declared.default) // 2, int(declared.default) * 2):
            if low <= count and (high is None or count <= high):
                yield replace(candidate, settings={**candidate.settings, name: count})


def _with_settings(trial: Trial, settings: Mapping[str, Any] | None = None) -> str:
    values = trial.candidate.settings if settings is None else settings
    return ",".join([trial.candidate.spelled, *(f"{k}={v:g}" for k, v in values.items())])
