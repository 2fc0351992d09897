"""The cheapest technique and settings that keep an error under a bound, from a range of angles.

How it searches, technique by technique. Its **effort** is the whole-number setting with the largest
default (`steps`, `max_steps`, …); the least number of steps, where it has one, goes with it in the
default's proportion. Other whole-number settings (`search_steps`, …) are tried at half of, at once
and at twice their default; all else stays as it is. The effort is doubled until the error is under
the bound at every angle, then the gap to the last failure is halved until it closes. Errors need
not fall with effort: whatever is returned was itself measured at every angle, and nothing is
concluded from its neighbours. Of what passes, the fastest by measured time on this device is taken.
"""

from __future__ import annotations

import os
import shlex
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal, assert_never

import numpy as np

from basrelief.engine import Engine, engine_of
from basrelief.errors import InputError
from basrelief.material import Material, load
from basrelief.measure.compare import Candidate, Progress, candidates, check_measurable
from basrelief.measure.errors import flip as flip_of
from basrelief.measure.errors import has_flip, missed
from basrelief.measure.results import settings_of
from basrelief.measure.timing import Timing, seconds_of, timing_on
from basrelief.measure.truth import Truth, truth
from basrelief.measure.views import at_angle
from basrelief.rendering.frame import Frame
from basrelief.rendering.render import check_picture, render
from basrelief.scene import Scene
from basrelief.scene.presets import Preset
from basrelief.techniques import Technique

__all__ = ["Tried", "TuneResult", "tune"]

APART = 15.0
"""Degrees between the angles of a range that are measured."""
MOST = 1024
"""The most effort that is tried."""
_RUNS = 5
Measure = Literal["missed", "flip"]
_MEASURED: dict[Measure, str] = {"missed": "missed hits", "flip": "FLIP"}
_SAMPLES: dict[Measure, int] = {"missed": 1, "flip": 4}
"""Of each pixel, while a candidate is measured."""


@dataclass(frozen=True, eq=False)
class Tried:
    """A technique with settings: its largest error, at which angle, and its mean time.

    Of one that fails the error is that at the angle where it was found to fail.
    """

    candidate: Candidate
    passed: bool
    error: float
    angle: float
    seconds: float = 0.0


@dataclass(frozen=True, eq=False)
class TuneResult:
    """What `tune` found: `chosen` is the cheapest that stays under the `bound` on `measure`
    ("missed" or "flip") at all `angles`; `nearest` the cheaper one that came nearest to it, None
    where nothing cheaper was tried; `others` what passed too, the fastest first."""

    chosen: Tried
    nearest: Tried | None
    others: tuple[Tried, ...]
    measure: Measure
    bound: float
    angles: tuple[float, ...]
    source: str
    material: str
    scale: float
    settings: Mapping[str, Any]
    options: Mapping[str, Any]
    device: str

    @property
    def command(self) -> str:
        """The command line that draws with what was chosen."""
        parts = ["basrelief", "render", self.source, "--technique", self.chosen.candidate.spelled]
        for name, value in self.settings.items():
            parts += ["--set", f"{name}={value:g}"]
        if "bias" in self.options:
            parts += ["--set", f"bias={self.options['bias']:g}"]
        parts += ["--scale", f"{self.scale:g}"]
        for name in ("reference_height", "projection"):
            if name in self.options:
                value = self.options[name]
                parts += [f"--{name}", value if isinstance(value, str) else f"{value:g}"]
        return shlex.join(parts)

    @property
    def preset(self) -> Preset:
        """The same as a preset; `preset.save("mine.toml")` writes it."""
        about = (
            f"For {self.material}: the cheapest with {self._told(self.chosen)}, "
            f"from {self.angles[0]:g} to {self.angles[-1]:g} degrees."
        )
        plain = {
            k: v for k, v in self.options.items() if k in ("reference_height", "projection", "bias")
        }
        obj = {
            "technique": _from_anywhere(self.chosen.candidate.spelled),
            "scale": self.scale,
            **plain,
            "settings": dict(self.settings),
        }
        return Preset(f"{self.material}-tuned", about, values={"object": obj})

    def report(self) -> str:
        """The chosen settings and the cheaper ones that just missed, in a few lines of text."""
        chosen = self.chosen
        low, high = self.angles[0], self.angles[-1]
        lines = [
            f"{_spelled(chosen, self.settings)}: {self._told(chosen)} (bound "
            f"{self._number(self.bound)}), the worst at {chosen.angle:g}°; "
            f"{chosen.seconds * 1e3:.3g} ms a picture, {low:g} to {high:g}°"
        ]
        if self.nearest is None:
            lines.append("nothing cheaper was tried")
        else:
            near = self.nearest
            less = 100.0 * (1.0 - near.seconds / chosen.seconds)
            lines.append(
                f"just missed: {_spelled(near)} would take {less:.0f} % less time "
                f"({near.seconds * 1e3:.3g} ms), but has {self._told(near)} at {near.angle:g}°"
            )
        if self.others:
            also = ", ".join(f"{_spelled(o)} ({o.seconds * 1e3:.3g} ms)" for o in self.others[:3])
            lines.append(f"also under the bound: {also}")
        return "\n".join(lines)

    def _told(self, tried: Tried) -> str:
        return f"{self._number(tried.error)} {_MEASURED[self.measure]}"

    def _number(self, error: float) -> str:
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
    source: str | None = None,
    progress: Progress = lambda what, share: None,
    **options: Any,
) -> TuneResult:
    """The cheapest technique and settings for a material that keep an error under a bound.

    Either `missed`, the share of missed hits (0 to 1), or `flip`, the mean FLIP error, is bounded,
    at angles from the first to the last of `angles`, 15 degrees apart at most. `techniques` and
    `options` are as in `compare`; `settings` are kept as they are given. `source` is what the
    command line names the material. Raises InputError where
    nothing stays under the bound, and as `compare` does.
    """
    if (missed is None) == (flip is None):
        raise InputError("give one bound: missed hits (missed=0.001) or FLIP (flip=0.05)")
    bound = flip if missed is None else missed
    assert bound is not None
    if not 0.0 <= bound <= 1.0:
        raise InputError(f"a bound of {bound:g}: give a share from 0 to 1, as 0.001 for 0.1 %")
    if flip is not None:
        check_flip()
    size = check_picture(size)
    material = what if isinstance(what, Material) else load(what)
    check_measurable(material, options)
    kept = dict(settings or {})
    chosen = [
        c for c in candidates(techniques, kept) if techniques is None or _asked(c, techniques)
    ]
    engine = engine_of(device)
    views = _views(angles)
    measure: Measure = "missed" if flip is None else "flip"
    progress(f"working out the truth of {material.name}", 0.0)
    ruler = _Ruler(material, views, size, engine, options, measure, bound)
    tried: list[Tried] = []
    for number, candidate in enumerate(chosen):
        progress(f"trying {candidate.name}", 0.1 + 0.7 * number / len(chosen))
        for variant in _variants(candidate, kept):
            tried += _search(variant, kept, ruler.tried)
    if not any(each.passed for each in tried):
        least = min(tried, key=lambda each: each.error)
        raise InputError(
            f"nothing stays under {bound:g} from {views[0]:g} to {views[-1]:g}°; the nearest is "
            f"{_spelled(least)} with {least.error:.3g} at {least.angle:g}°; raise the bound, or "
            "let exact take part"
        )
    progress("timing what is left", 0.85)
    timed = ruler.timed(tried)
    fit = sorted((each for each in timed if each.passed), key=lambda each: each.seconds)
    best = fit[0]
    cheaper = [each for each in timed if not each.passed and each.seconds < best.seconds]
    scene = ruler.scene(best.candidate, views[0])
    obj = scene.objects[0]
    return TuneResult(
        chosen=best,
        nearest=min(cheaper, key=lambda each: each.error, default=None),
        others=tuple(fit[1:]),
        measure=measure,
        bound=bound,
        angles=views,
        source=source or (material.name if isinstance(what, Material) else os.fspath(what)),
        material=material.name,
        scale=obj.relief_scale,
        settings=settings_of(obj),
        options=options,
        device=f"{engine.name}: {engine.adapter}",
    )


def check_flip() -> None:
    """Raise InputError where FLIP cannot be measured."""
    if not has_flip():
        raise InputError("FLIP needs NVIDIA's flip-evaluator; pip install 'basrelief[measure]'")


def _asked(candidate: Candidate, techniques: Sequence[Any]) -> bool:
    """Whether a technique was asked for; `compare` adds `exact`, which here is one like others."""
    return candidate.name != "exact" or any(
        each == "exact" or getattr(each, "name", None) == "exact" for each in techniques
    )


def _views(angles: tuple[float, float]) -> tuple[float, ...]:
    low, high = angles
    if not low <= high:
        raise InputError(f"angles from {low:g} to {high:g}: give the smaller first")
    count = int(np.ceil((high - low) / APART)) + 1
    return tuple(float(angle) for angle in np.linspace(low, high, count))


# --- measuring -----------------------------------------------------------------------------------


class _Ruler:
    """The views of a material with their truths, against which candidates are held."""

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
        (reference,) = candidates(["exact"], {})
        self.true: dict[float, Truth | Frame] = {}
        for angle in angles:
            scene = self.scene(reference, angle)
            match measure:
                case "missed":
                    self.true[angle] = truth(scene, size, device=engine)
                case "flip":
                    self.true[angle] = self.drawn(scene)
                case _:
                    assert_never(measure)

    def scene(self, candidate: Candidate, angle: float) -> Scene:
        """What a candidate is measured on."""
        own = {"technique": candidate.technique, "settings": candidate.settings}
        return at_angle(self.material, angle, self.size, {**self.options, **own})

    def drawn(self, scene: Scene) -> Frame:
        """A scene's frame."""
        return render(scene, size=self.size, samples=self.samples, device=self.engine)

    def tried(self, candidate: Candidate) -> Tried:
        """A candidate's largest error; from grazing on, no further than where it fails."""
        worst = (-1.0, self.angles[0])
        for angle in reversed(self.angles):
            worst = max(worst, (self.error(candidate, angle), angle))
            if worst[0] > self.bound:
                return Tried(candidate, False, *worst)
        return Tried(candidate, True, *worst)

    def error(self, candidate: Candidate, angle: float) -> float:
        """A candidate's error at one angle."""
        frame, true = self.drawn(self.scene(candidate, angle)), self.true[angle]
        if isinstance(true, Frame):
            return flip_of(true, frame)
        return float(missed(frame, true).sum() / max(int(true.there.sum()), 1))

    def timed(self, tried: Sequence[Tried]) -> list[Tried]:
        """The same with their mean times from head-on to grazing, measured in turn."""
        timing: Timing = timing_on(self.engine, self.size)
        angles = sorted({self.angles[0], self.angles[len(self.angles) // 2], self.angles[-1]})
        found = []
        for angle in angles:
            scenes = {str(k): self.scene(t.candidate, angle) for k, t in enumerate(tried)}
            found.append(seconds_of(scenes, timing, self.engine, _RUNS))
        return [
            replace(each, seconds=float(np.mean([times[str(k)] for times in found])))
            for k, each in enumerate(tried)
        ]


# --- searching -----------------------------------------------------------------------------------


def _search(
    candidate: Candidate, kept: Mapping[str, Any], measured: Callable[[Candidate], Tried]
) -> list[Tried]:
    """The least effort that passes, and the nearest that was seen to fail, where there are any."""
    main = effort(candidate.technique, kept)
    if main is None:
        return [measured(candidate)]
    field = candidate.technique.settings.__dataclass_fields__[main]
    low = int(field.metadata["low"])
    high = int(min(field.metadata["high"] or MOST, MOST))

    def at(count: int) -> Tried:
        return measured(_with_effort(candidate, main, count, kept))

    count, failed = max(low, 1), None
    last = at(count)
    while not last.passed and count < high:
        failed, below = last, count
        count = min(2 * count, high)
        last = at(count)
    if not last.passed or failed is None:
        return [last]
    while count - below > 1:
        middle = (below + count) // 2
        one = at(middle)
        if one.passed:
            last, count = one, middle
        else:
            failed, below = one, middle
    return [last, failed]


def effort(technique: Technique[..., Any], kept: Mapping[str, Any]) -> str | None:
    """The setting that a search turns: the whole number with the largest default, if any."""
    numbers = _whole_numbers(technique, kept)
    return max(numbers, key=lambda name: numbers[name], default=None)


def _whole_numbers(technique: Technique[..., Any], kept: Mapping[str, Any]) -> dict[str, int]:
    fields = technique.settings.__dataclass_fields__.values()
    return {
        f.name: int(f.default) for f in fields
        if f.type in ("int", int) and f.name not in kept
    }  # fmt: skip


def _partner(technique: Technique[..., Any], main: str) -> str | None:
    """The setting that is the least of what `main` is the most."""
    name = main.replace("max", "min")
    return name if name != main and name in technique.settings.__dataclass_fields__ else None


def _with_effort(candidate: Candidate, main: str, count: int, kept: Mapping[str, Any]) -> Candidate:
    fields = candidate.technique.settings.__dataclass_fields__
    made = {**candidate.settings, main: count}
    partner = _partner(candidate.technique, main)
    if partner is not None and partner not in kept:
        share = count * int(fields[partner].default) / int(fields[main].default)
        made[partner] = max(int(fields[partner].metadata["low"]), round(share))
    return replace(candidate, settings=made)


def _variants(candidate: Candidate, kept: Mapping[str, Any]) -> Iterator[Candidate]:
    """A candidate with its lesser whole numbers at half, once and twice their default."""
    main = effort(candidate.technique, kept)
    partner = main and _partner(candidate.technique, main)
    lesser = [
        name for name in _whole_numbers(candidate.technique, kept)
        if name not in (main, partner, *candidate.settings)
    ]  # fmt: skip
    yield candidate
    for name in lesser:
        field = candidate.technique.settings.__dataclass_fields__[name]
        low, high = field.metadata["low"], field.metadata["high"]
        for count in (int(field.default) // 2, int(field.default) * 2):
            if low <= count and (high is None or count <= high):
                yield replace(candidate, settings={**candidate.settings, name: count})


def _spelled(tried: Tried, settings: Mapping[str, Any] | None = None) -> str:
    said = tried.candidate.settings if settings is None else settings
    return ",".join([tried.candidate.spelled, *(f"{k}={v:g}" for k, v in said.items())])


def _from_anywhere(spelled: str) -> str:
    """A technique's name; that of a file of one's own with its whole path."""
    file, colon, name = spelled.rpartition(":")
    return f"{Path(file).resolve()}:{name}" if colon else name
