"""Cost in proportion to coverage; far away the relief fades to normal mapping."""

from __future__ import annotations

from collections.abc import Iterator

from basrelief import LookAt, Object, Orbit, Scene, placed
from basrelief.gallery.page import Page, Panel, sample
from basrelief.scene import LYING

ACROSS = LookAt(position=(0.0, 0.5, 3.4), target=(0.0, -0.05, 1.6), field_of_view=40.0)


def panels(texels: int) -> Iterator[Panel]:
    """A plane that fades, and a cube at three distances."""
    cobbles = sample("cobbles", texels)
    for caption, fade in (
        ("relief everywhere", None),
        ("fading from 1 to 4", (1.0, 4.0)),
        ("gone from 0.1 on: normal mapping", (0.05, 0.1)),
    ):
        field = Object(
            cobbles,
            scale=0.1,
            tiling=(7.0, 7.0),
            transform=LYING @ placed(scale=7.0),
            fade=fade,
        )
        yield Panel(caption, Scene((field,), camera=ACROSS))
    cube = Object(sample("bricks", texels), shape="box", scale=0.08)
    for caption, away in (("near", 2.2), ("further", 4.5), ("far", 9.0)):
        view = Orbit(azimuth=30.0, elevation=20.0, distance=away, field_of_view=38.0)
        yield Panel(f"a cube, {caption}", Scene((cube,), camera=view), f"distance {away:g}")


PAGE = Page(
    name="distance",
    title="Distance and coverage",
    source="gamedev",
    rows={"G10": "no reads where the relief has faded; time follows the size of the cube"},
    look="The fading plane looks like the full one with fewer reads; the far cube takes the least "
    "time.",
    article="An object that covers a fifth of the screen costs far less than one that covers four "
    "fifths.",
    ours="The same. Reads are counted per covered pixel, so those of the cubes are similar.",
    panels=panels,
)
