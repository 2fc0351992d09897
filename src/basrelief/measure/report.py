"""A comparison as a folder: one page for people, its pictures, and compare.json for programs."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from html import escape
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from basrelief.errors import InputError
from basrelief.images import srgb_encode, write_picture
from basrelief.measure.advice import VISIBLE, Advice, advice, mean_seconds, passes
from basrelief.measure.colors import heat
from basrelief.measure.errors import Spread
from basrelief.measure.plot import Point, plot
from basrelief.measure.results import Result, Results, settings_of
from basrelief.pages import check_ours, document, write_page

GENERATOR = "basrelief compare"
PICTURES = "pictures"
"""The folder of a comparison's pictures."""
LEAST, MOST = 0.1, 100.0
"""Texels at the dark and the pale end of error pictures; between them by their logarithm."""
_QUALITY = 92

_STYLE = """
.two { display: grid; gap: 0 3rem;
  grid-template-columns: minmax(0, max-content) minmax(24rem, 1fr); }
@media (max-width: 70rem) { .two { grid-template-columns: minmax(0, 1fr); } }
summary { font-size: 1.15rem; font-weight: 600; margin: 1.6rem 0 .8rem; cursor: pointer; }
summary span { font-size: .92rem; font-weight: normal; color: var(--quiet); margin-left: .6rem; }
.advice { font-size: 1.12rem; max-width: 52rem; border-left: .3rem solid var(--link);
  padding: .1rem 0 .1rem 1rem; margin: 1.2rem 0; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; margin: .6rem 0; }
th, td { padding: .35rem .7rem; text-align: right; border-bottom: 1px solid var(--line);
  white-space: nowrap; font-weight: normal; }
th { color: var(--quiet); font-size: .86rem; vertical-align: bottom; }
th:first-child, td:first-child { text-align: left; }
td:first-child { color: var(--ink); font-size: 1rem; }
.fine-cell { background: color-mix(in oklab, #2f9e64 26%, transparent); }
.near-cell { background: color-mix(in oklab, #d9a21b 24%, transparent); }
.ship td:first-child::after, h3.ship::after { content: "ship this"; margin-left: .6rem;
  font-size: .74rem; font-weight: 600; background: var(--link); color: var(--card);
  border-radius: 1rem; padding: .12rem .55rem; white-space: nowrap; vertical-align: .1em; }
.row { display: grid; grid-template-columns: minmax(0, 1fr) minmax(0, 1fr) 19rem; gap: .9rem;
  margin: 0 0 1rem; align-items: start; }
.row img { border-radius: .35rem; }
.row h3 { margin: 0 0 .1rem; font-size: 1.05rem; }
.row dl { gap: .1rem .8rem; margin: .4rem 0 0; grid-template-columns: 1fr max-content;
  font-variant-numeric: tabular-nums; font-size: .92rem; }
.row dd { text-align: right; }
.legend { display: flex; align-items: center; gap: .6rem; font-size: .86rem; color: var(--quiet);
  flex-wrap: wrap; margin: .5rem 0 1rem; }
.ramp { width: 18rem; max-width: 60vw; }
.ramp i { display: block; height: .8rem; border-radius: .2rem; }
.ramp b { display: flex; justify-content: space-between; font-weight: normal; }
.plot { width: 100%; max-width: 54rem; height: auto; font: 13px system-ui, sans-serif; }
.plot text { fill: var(--ink); paint-order: stroke; stroke: var(--paper); stroke-width: 4px; }
.plot text { stroke-linejoin: round; }
.plot .tick, .plot .axis, .plot text.off { fill: var(--quiet); }
.grid-line { stroke: var(--line); fill: none; } .front { stroke: var(--link); fill: none;
  stroke-width: 1.5; stroke-dasharray: 5 4; }
.fine { fill: #2f9e64; opacity: .14; }
.plot circle { fill: var(--link); } .plot text.chosen { font-weight: 700; }
.plot circle.off { fill: var(--paper); stroke: var(--quiet); stroke-width: 1.5; }
@media (max-width: 60rem) { .row { grid-template-columns: 1fr 1fr; }
  .row > div { grid-column: 1 / -1; } }
"""


def write(folder: Path, comparison: Results, json: str) -> Path:
    """Write the page, its pictures and compare.json, whose text is `json`; returns the page's path.

    Raises InputError for a folder that cannot be written to, or with another's index.html.
    """
    index = folder / "index.html"
    check_ours(index, GENERATOR, "a comparison's page")
    pictures = folder / PICTURES
    try:
        pictures.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        reason = error.strerror or error
        raise InputError(f"{folder}: cannot be written to ({reason}); choose another") from None
    for each in comparison.results:
        drawn, wrong = (folder / name for name in _names(each))
        write_picture(drawn, each.picture.astype(np.float32), quality=_QUALITY)
        write_picture(wrong, error_picture(each.off), quality=_QUALITY)
    write_page(folder / "compare.json", json)
    write_page(index, page_html(comparison))
    return index


def error_picture(off: NDArray[np.float16]) -> NDArray[np.float32]:
    """Texels of uv error as linear colours, (H, W, 3), by their logarithm; none are dark."""
    texels = np.maximum(np.nan_to_num(off.astype(np.float64), nan=0.0, posinf=MOST), LEAST)
    return heat(np.log(texels / LEAST) / math.log(MOST / LEAST))


def _names(each: Result) -> tuple[str, str]:
    """The files of a result's picture and of its error."""
    name = re.sub(r"[^A-Za-z0-9_.=-]+", "-", each.technique)
    start = f"{PICTURES}/{each.angle:g}-{name}"
    return f"{start}.webp", f"{start}-error.webp"


# --- the page ------------------------------------------------------------------------------------


def page_html(comparison: Results) -> str:
    """The whole page."""
    said = advice(comparison)
    title = f"{comparison.material}: which technique?"
    sections = "\n".join(_section(comparison, angle, said) for angle in comparison.angles)
    body = f"""<main>
<h1>{escape(title)}</h1>
<p class="advice">{_advice(comparison, said)}</p>
<p>{_what_to_look_at()}</p>
<div class="two">
<div><h2>At a glance</h2>
{_table(comparison, said)}</div>
<div><h2>What it costs to be right</h2>
{_plot(comparison, said)}</div>
</div>
<h2>Picture by picture</h2>
{sections}
<footer><p>{_how(comparison)}</p></footer>
</main>"""
    return document(title, body, GENERATOR, _STYLE)


def _advice(comparison: Results, said: Advice) -> str:
    """The advice, what to do in bold."""
    first, colon, rest = said.sentence(max(comparison.angles)).partition(":")
    return f"<strong>{escape(first)}</strong>{colon}{escape(rest)}"


def _what_to_look_at() -> str:
    return (
        "Parallax mapping makes a flat wall look deep: for each pixel it looks up in a height map "
        "where the eye’s ray would really meet the surface. Each technique below guesses that "
        "place in its own way, and cheap ones guess badly when one looks along the surface (angles "
        "are counted from straight on, 0°). Compare each picture with that by <em>exact</em>, "
        "which finds the true place: look for edges that swim, double or turn to steps. The dark "
        "picture beside it shows how far off each pixel is: black is right, pale is far off."
    )


def _table(comparison: Results, said: Advice) -> str:
    has_flip = comparison.results[0].flip is not None
    heads = "".join(f"<th>{angle:g}°</th>" for angle in comparison.angles)
    rows = []
    for name, seconds in mean_seconds(comparison).items():
        cells = "".join(_cell(each) for each in comparison.of(name))
        ship = ' class="ship"' if name == said.technique else ""
        rows.append(f"<tr{ship}><td>{escape(name)}</td><td>{_time(seconds)}</td>{cells}</tr>")
    measure = (
        "visible error (FLIP, 0 to 1; the picture by exact is 0)" if has_flip else "missed hits"
    )
    key = "green: passes for the true picture; yellow: seen by those who look for it"
    return f"""<div class="scroll"><table>
<thead><tr><th>technique, the cheapest first</th><th>time</th>{heads}</tr></thead>
<tbody>
{chr(10).join(rows)}
</tbody></table></div>
<p class="legend">From straight on to grazing: {measure}. {key.capitalize()}.</p>"""


def _cell(each: Result) -> str:
    shown = _share(each.errors.missed) if each.flip is None else f"{each.flip:.3f}"
    near = each.flip is not None and each.flip <= 2.0 * VISIBLE
    kind = "fine-cell" if passes(each) else "near-cell" if near else ""
    return f'<td class="{kind}">{shown}</td>' if kind else f"<td>{shown}</td>"


def _plot(comparison: Results, said: Advice) -> str:
    has_flip = comparison.results[0].flip is not None
    points = []
    for name, seconds in mean_seconds(comparison).items():
        found = comparison.of(name)
        wrong = [each.errors.missed if each.flip is None else each.flip for each in found]
        points.append(Point(name, seconds, float(np.mean(wrong)), name == said.technique))
    label = "mean visible error (FLIP)" if has_flip else "missed hits"
    note = (
        "Each dot is a technique, its error the mean over all angles. The dashed line joins those "
        "that nothing beats in both: anything above it is slower or worse than need be."
    )
    drawn = plot(points, label, VISIBLE if has_flip else None)
    return f'<div class="scroll">{drawn}</div>\n<p class="legend">{note}</p>'


def _section(comparison: Results, angle: float, said: Advice) -> str:
    found = sorted(comparison.at(angle), key=lambda each: each.technique != "exact")
    rows = "\n".join(_row(comparison, each, said) for each in found)
    seen = "Straight on" if angle == 0.0 else f"{angle:g}° from straight on"
    same = all(each.errors.uv.worst <= LEAST for each in found)
    note = " <span>all alike: what is deep is not yet displaced</span>" if same else ""
    return f"""<details{"" if same else " open"}><summary>{seen}{note}</summary>
{_legend()}
{rows}
</details>"""


def _legend() -> str:
    stops = srgb_encode(heat(np.linspace(0.0, 1.0, 17)).astype(np.float64)) * 255.0
    colors = ", ".join("rgb({:.0f} {:.0f} {:.0f})".format(*stop) for stop in stops)
    texels = "".join(f"<span>{n:g}</span>" for n in (LEAST, 1.0, 10.0, MOST))
    return (
        '<div class="legend"><span>off by, in texels of the height map:</span>'
        f'<span class="ramp"><i style="background:linear-gradient(90deg,{colors})"></i>'
        f"<b>{texels}</b></span>"
        "<span>Three numbers in a row: the median, what 99 % stay within, the worst.</span></div>"
    )


def _row(comparison: Results, each: Result, said: Advice) -> str:
    drawn, wrong = _names(each)
    wide, tall = comparison.size
    name = escape(each.technique)
    title = f"{name}, the true picture" if each.technique == "exact" else name
    image = f'width="{wide}" height="{tall}" loading="lazy"'
    facts = "\n".join(f"<dt>{what}</dt><dd>{value}</dd>" for what, value in _facts(each))
    ship = ' class="ship"' if each.technique == said.technique else ""
    settings = escape(_settings(comparison, each.technique))
    return f"""<div class="row">
<a href="{drawn}"><img src="{drawn}" {image} alt="{name} at {each.angle:g} degrees"></a>
<a href="{wrong}"><img src="{wrong}" {image} alt="how far off each pixel of {name} is"></a>
<div><h3{ship}>{title}</h3><span class="settings">{settings}</span>
<dl>
{facts}
</dl></div>
</div>"""


def _facts(each: Result) -> Iterator[tuple[str, str]]:
    found = each.errors
    if each.flip is not None:
        yield "visible error (FLIP)", f"{each.flip:.3f}"
    yield "missed hits", _share(found.missed)
    if found.missed > 0.0:
        yield "… passed through", _share(found.passed)
        yield "… stopped short", _share(found.short)
    yield "texels off", _spread(found.uv, 1.0)
    yield "depth off, % of a tile", _spread(found.depth, 100.0)
    yield "heights read a pixel", f"{found.reads:.1f}"
    yield "time", _time(each.seconds)


def _settings(comparison: Results, name: str) -> str:
    thing = comparison.objects[name]
    said = [f"{key} {value:g}" for key, value in settings_of(thing).items()]
    if thing.relief_projection != "full":
        said.append(f"projection {thing.relief_projection}")
    if thing.relief_level != 1.0:
        said.append(f"level {thing.relief_level:g}")
    return " · ".join(said)


def _how(comparison: Results) -> str:
    wide, tall = comparison.size
    timed = " × ".join(map(str, comparison.timing.size))
    texels = " × ".join(map(str, comparison.texels))
    by = "the GPU’s timestamps" if comparison.timing.by == "timestamps" else "the clock"
    return (
        f"Heights of {texels} texels, {comparison.scale:.3g} of a tile deep; pictures of "
        f"{wide} × {tall} pixels, {comparison.samples} samples each. A hit is missed where a pixel "
        "shows a place more than a texel from where its ray first meets the surface: the ray "
        "passed through a feature and went on, or it stopped short of the surface. The truth is "
        "worked out for every pixel in 64 bits by code that shares nothing with the techniques. "
        "Times are those of the drawing program alone, one sample a pixel, "
        f"{timed} pixels, by {by}, the median of {comparison.runs} runs in turn, on "
        f"{escape(comparison.engine)}."
    )


def _share(share: float) -> str:
    percent = 100.0 * share
    if percent == 0.0:
        return "none"
    return "under 0.01 %" if percent < 0.01 else f"{percent:.2g} %" if percent < 10 else (
        f"{percent:.0f} %"
    )  # fmt: skip


def _spread(spread: Spread, times: float) -> str:
    numbers = (spread.median, spread.percentile_99, spread.worst)
    return " · ".join(_short(number * times) for number in numbers)


def _short(number: float) -> str:
    return f"{number:.2f}" if number < 10.0 else f"{number:.0f}"


def _time(seconds: float) -> str:
    return f"{seconds * 1e3:.3g} ms"
