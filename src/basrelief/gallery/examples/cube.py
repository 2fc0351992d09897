"""The cube: the joints between the bricks vanish with parallax occlusion."""

from __future__ import annotations

from collections.abc import Iterator

from basrelief import LookAt, point, preset
from basrelief.gallery.page import Headline, Page, Panel, sample

WHOLE = LookAt(position=(1.3, 1.2, 1.6), target=(0.0, -0.08, 0.0), field_of_view=40.0)
CLOSE = LookAt(position=(1.0, 1.0, 1.25), target=(0.3, 0.15, 0.42), field_of_view=24.0)


def panels(texels: int) -> Iterator[Panel]:
    """A whole texture on each face, with and without parallax; the whole cube and its corner."""
    gamedev = preset("gamedev")
    for view, camera in (("", WHOLE), (", close", CLOSE)):
        for caption, options in (
            ("normal mapping", {"technique": "flat"}),
            ("parallax occlusion", {}),
        ):
            scene = gamedev.scene(
                sample("bricks", texels),
                shape="box",
                camera=camera,
                # the article's light is white and has no falloff
                lights=(point((-0.5, 2.5, 2.0), intensity=2.4, falloff=0.0),),
                **options,
            )
            yield Panel(caption + view, scene)


PAGE = Page(
    name="cube",
    title="The cube",
    source="gamedev",
    rows={
        "G11": "a box, the equivalent of twelve triangles, with the whole texture on each face",
        "G1": "normals in RGB and heights in A: 1 on the polygon, 0 the deepest",
        "G2": "view, light and normal in the tangent frame of each face",
        "G5": "the footprint of a pixel comes from the undisplaced coordinates",
        "G9": "ambient 0.1 and diffuse 0.5 on the colour map",
        "G12": "timed at the article's size, with its 4 to 20 samples",
    },
    look="With parallax occlusion the grey joints vanish behind the bricks; the cube's outline "
    "stays.",
    article="A cube of twelve triangles with normal mapping, and then with parallax occlusion.",
    ours="The same, with the settings of the preset `gamedev`. The light is 2.4 times as bright "
    "as the preset's, so that the pictures are not too dark. Close up, the layers of the march "
    "show, 20 at most.",
    panels=panels,
    headline=Headline(
        (640, 480), "over 60 frames a second, 4 to 20 samples, on a laptop with a GeForce 8600M GT"
    ),
)
