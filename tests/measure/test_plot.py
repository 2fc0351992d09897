"""The plot of error against time: dots, colours, and labels without overlaps."""

from __future__ import annotations

import re
from itertools import combinations
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from basrelief.measure.labels import Box, place_labels
from basrelief.measure.plot import DARK, LIGHT, SIZE, Palette, Point, write_plot
from helpers.browser import chromium
from helpers.repository import REPOSITORY

POINTS = [
    Point("slow & good", 0.009, 0.1, chosen=True), Point("fast", 0.001, 0.9),
    Point("beaten", 0.005, 0.6), Point("middling", 0.004, 0.5),
    Point("as slow and worse", 0.009, 0.2),
]  # fmt: skip
# settings of one technique with nearly equal times, and the techniques of a real comparison
CROWD = [
    *(Point(f"relief max_steps={n}", 0.030 + 2e-4 * n, 0.02 - 1e-3 * n, n == 3) for n in range(9)),
    Point("flat", 0.0201, 0.299), Point("offset_limited", 0.0227, 0.16),
    Point("offset", 0.0257, 0.176), Point("steep", 0.029, 0.101), Point("relief", 0.0371, 0.017),
    Point("parallax_occlusion", 0.0328, 0.0226), Point("secant", 0.0419, 0.0158),
    Point("contact", 0.0473, 0.0418), Point("cone", 0.0535, 0.0004), Point("exact", 0.0772, 0.0),
]  # fmt: skip


def svg(folder: Path, points: list[Point], limit: float | None, palette: Palette = LIGHT) -> str:
    pytest.importorskip("matplotlib")
    write_plot(folder / "plot.svg", points, "error", limit, palette)
    return (folder / "plot.svg").read_text("utf-8")


# --- drawing ---------------------------------------------------------------------------------


@pytest.mark.parametrize("palette", [LIGHT, DARK], ids=["light", "dark"])
def test_each_technique_is_a_dot_with_its_name(palette: Palette, tmp_path: Path) -> None:
    """Filled on the front, hollow off it."""
    drawn = svg(tmp_path, POINTS, 0.2, palette)
    assert len(re.findall(rf'<use [^>]*style="fill: {palette.link}', drawn)) == 3
    assert len(re.findall(rf'<use [^>]*style="fill: {palette.paper}', drawn)) == 2
    texts = re.findall(r"<text[^>]*>([^<]*)</text>", drawn)
    for name in ("slow &amp; good", "fast", "beaten", "middling", "as slow and worse"):
        assert texts.count(name) == 1
    assert {"error", "milliseconds a picture; faster to the left"} <= {*texts}
    assert drawn == svg(tmp_path, POINTS, 0.2, palette)


def test_the_band_ends_at_the_limit(tmp_path: Path) -> None:
    """Its upper edge is at the limit on the axis; without a limit there is no band."""
    drawn = svg(tmp_path, POINTS, 0.2)
    (band,) = re.findall(r'<path d="([^"]*)"[^>]*style="fill: #2f9e64; opacity: 0.14"', drawn)
    edges = {float(y) for y in re.findall(r"[ML] \S+ (\S+)", band)}
    # the grid's line at 0.2, from the left end of the axis to the right
    lines = re.findall(r"M 64 (\S+)\s*L 720 \1\s", drawn)
    assert min(edges) in {float(y) for y in lines}
    assert max(edges) == SIZE[1] - 52
    assert "#2f9e64" not in svg(tmp_path, POINTS, None)


@pytest.mark.parametrize("error", [0.0, 1.0])
def test_one_technique_alone_is_drawn(error: float, tmp_path: Path) -> None:
    assert ">only<" in svg(tmp_path, [Point("only", 1.0, error)], None)


def test_colours_are_those_of_the_pages() -> None:
    style = REPOSITORY / "src" / "basrelief" / "pages" / "templates" / "style.css"
    light, dark = re.findall(r":root \{([^}]*)\}", style.read_text("utf-8"))
    for palette, declared in ((LIGHT, light), (DARK, dark)):
        for name, color in palette._asdict().items():
            assert f"--{name}: {color};" in declared


# --- names ----------------------------------------------------------------------------------------

AREA = Box(0.0, 0.0, 700.0, 300.0)
PLACES = st.tuples(st.floats(0, 700), st.floats(0, 300))
LABELS = st.lists(
    st.tuples(PLACES, st.tuples(st.floats(20, 150), st.floats(10, 18))), min_size=1, max_size=5
)


@given(LABELS)
def test_labels_do_not_overlap(labels: list[Any]) -> None:
    points, sizes = zip(*labels, strict=True)
    dots = [Box(x, y, x, y).grown(5.0) for x, y in points]
    boxes = place_labels(points, sizes, dots, AREA)
    for box, size in zip(boxes, sizes, strict=True):
        assert (box.right - box.left, box.top - box.bottom) == pytest.approx(size)
        assert box.is_within(AREA)
    assert not any(one.overlaps(other) for one, other in combinations(boxes, 2))


def test_a_label_is_right_above_its_point_where_there_is_room() -> None:
    size, point = (50.0, 12.0), (100.0, 100.0)
    (free,) = place_labels([point], [size], [], AREA)
    assert (free.left, free.bottom) == (105.0, 105.0)
    # with an obstacle to the right, above to the left; in a corner of the area, where it fits
    (beside,) = place_labels([point], [size], [Box(100.0, 80.0, 160.0, 300.0)], AREA)
    assert (beside.right, beside.bottom) == (95.0, 105.0)
    (corner,) = place_labels([(699.0, 299.0)], [size], [], AREA)
    assert corner.right < 699.0
    assert corner.top < 299.0


@pytest.fixture(scope="module")
def browser() -> Any:
    with chromium(()) as opened:
        yield opened


ON_AN_AXIS = [Point("exact", 0.05, 0.0, chosen=True), Point("flat", 0.02, 0.5)]


@pytest.mark.parametrize("points", [POINTS, CROWD, ON_AN_AXIS], ids=["few", "many", "on an axis"])
def test_text_has_no_overlaps_in_a_browser(
    points: list[Point], browser: Any, tmp_path: Path
) -> None:
    """Names, numbers and titles of axes overlap neither one another nor dots, in its fonts."""
    svg(tmp_path, points, 0.03)
    page = browser.new_page(viewport={"width": SIZE[0], "height": SIZE[1]})
    page.goto(f"file://{tmp_path}/plot.svg")
    boxes = page.evaluate("""() => {
      const box = (element) => {
        const { left, top, right, bottom } = element.getBoundingClientRect();
        return [left, top, right, bottom];
      };
      const texts = [...document.querySelectorAll("text")].map((e) => [e.textContent, ...box(e)]);
      const dots = [...document.querySelectorAll("use")].map((e) => ["", ...box(e)]);
      return [...texts, ...dots.filter(([, left, , right]) => right - left > 4)];
    }""")
    page.close()
    names = {point.name for point in points}
    assert sum(name in names for name, *_ in boxes) == len(points)
    assert sum(name == "" for name, *_ in boxes) == len(points)
    for (one, *box), (other, *with_) in combinations(boxes, 2):
        if one or other:
            assert not Box(*box).overlaps(Box(*with_)), f"{one!r} overlaps {other!r}"
