"""Draws hero.png, the picture that the README opens with."""

from __future__ import annotations

from pathlib import Path

import basrelief
from basrelief.scene import LYING


def scene() -> basrelief.Scene:
    """Four samples on four shapes; the ground's relief meets what stands on it."""
    ground = basrelief.Object(
        basrelief.sample("cobbles", 1024),
        technique="relief",
        scale=0.05,
        tiling=(6.0, 6.0),
        transform=basrelief.placed((0.0, -0.5, 0.0)) @ LYING @ basrelief.placed(scale=9.0),
    )
    box = basrelief.Object(
        basrelief.sample("bricks", 1024),
        shape="box",
        technique="relief",
        scale=0.06,
        transform=basrelief.placed((-1.15, 0.0, -0.1)) @ basrelief.rotated("y", 25.0),
    )
    sphere = basrelief.Object(
        basrelief.sample("gravel", 1024), shape="sphere", technique="relief", scale=0.1
    )
    cylinder = basrelief.Object(
        basrelief.sample("tiles", 1024),
        shape="cylinder",
        technique="relief",
        scale=0.05,
        transform=basrelief.placed((1.2, 0.0, -0.2)) @ basrelief.rotated("y", 10.0),
    )
    return basrelief.Scene(
        (ground, box, sphere, cylinder),
        shadows="soft",
        camera=basrelief.Orbit(azimuth=8.0, elevation=22.0, distance=4.4, field_of_view=26.0),
    )


if __name__ == "__main__":
    frame = basrelief.render(scene(), size=(1200, 500), samples=16)
    print(frame.save(Path(__file__).with_name("hero.png")))
