"""Cost in proportion to coverage; far away the relief fades to normal mapping."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from basrelief import LookAt, Orbit, placed, point, preset
from basrelief.gallery.page import Page, Panel, sample
from basrelief.scene import LYING

ACROSS = LookAt(position=(0.0, 0.45, 3.4), target=(0.0, 0.0, 1.7), field_of_view=40.0)
LAMP = (point((-2.0, 2.5, 3.0), intensity=2.2, falloff=0.0),)


def panels(texels: int) -> Iterator[Panel]:
    """A cube over four fifths of the picture and over one, and a plane that fades."""
    gamedev = preset("gamedev")
    for share, away in ((0.8, 1.37), (0.2, 2.99)):
        cube = gamedev.scene(
            sample("bricks", texels),
            shape="box",
            camera=Orbit(azimuth=38.0, elevation=32.0, distance=away, field_of_view=40.0),
            lights=LAMP,
        )
        yield Panel(f"cube over {share:.0%} of the picture", cube, f"distance {away:g}")
    whole = gamedev.scene(
        sample("cobbles", texels),
        tiling=(7.0, 7.0),
        transform=LYING @ placed(scale=7.0),
        camera=ACROSS,
        lights=LAMP,
    )
    (plane,) = whole.objects
    fading = replace(whole, objects=(replace(plane, fade=(1.0, 2.5)),))
    yield Panel("relief everywhere", whole)
    yield Panel("fading from 1 to 2.5", fading)
    yield Panel("reads, relief everywhere", whole, shown="reads")
    yield Panel("reads, fading", fading, shown="reads")


PAGE = Page(
    name="distance",
    title="Distance and coverage",
    source="gamedev",
    rows={"G10": "cost follows the share of the picture; no reads where the relief has faded"},
    look="The small cube takes about a quarter of the large one's reads; the fading plane looks "
    "much like the full one, but has no reads (black) in the distance.",
    article="An object that covers a fifth of the screen costs far less than one that covers four "
    "fifths.",
    ours="The same: reads are counted per covered pixel, and about equal for both cubes, so their "
    "sum follows the covered share. Times include the empty background. The fade to normal mapping "
    "is an addition.",
    panels=panels,
)
