"""The cube: normal mapping and parallax occlusion, in the article's own light."""

from __future__ import annotations

from collections.abc import Iterator

from basrelief import LookAt, Object, Scene, point
from basrelief.gallery.page import Headline, Page, Panel, sample

CAMERA = LookAt(position=(1.25, 1.1, 1.8), target=(0.0, -0.06, 0.0), field_of_view=40.0)


def panels(texels: int) -> Iterator[Panel]:
    """A whole texture on each face; ambient 0.1, diffuse 0.5, no highlight."""
    for caption, technique, settings in (
        ("normal mapping", "flat", {}),
        ("parallax occlusion", "parallax_occlusion", {"min_steps": 4, "max_steps": 20}),
    ):
        obj = Object(
            sample("bricks", texels),
            shape="box",
            technique=technique,
            settings=settings,
            scale=0.1,
            surface_parameters={"specular": 0.0},
        )
        yield Panel(
            caption,
            Scene(
                (obj,),
                camera=CAMERA,
                # the article's light is white and has no falloff
                lights=(point((0.8, 1.5, 2.0), intensity=2.2, falloff=0.0),),
                shading_model="phong",
                shading={"ambient": 0.1, "diffuse": 0.5},
            ),
        )


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
    look="With parallax occlusion bricks hide the joints behind them; the cube's outline stays.",
    article="A cube of twelve triangles with normal mapping, and then with parallax occlusion.",
    ours="The same. The light is 2.2 times as bright as the article's factor of 0.5, so that the "
    "picture is not too dark.",
    panels=panels,
    headline=Headline(
        (640, 480), "over 60 frames a second, 4 to 20 samples, on a laptop with a GeForce 8600M GT"
    ),
)
