"""The headline figures of two of the sources, beside ours.

gamedev: faster than 60 frames a second at 640 × 480 with 4 to 20 samples (a GeForce 8600M GT).
halliwell: about 450 frames a second with self-shadow and 650 without, at 1600 × 900 (a GTX 670).

    python benchmarks/sources.py [cpu] [gpu]
"""

from __future__ import annotations

import sys
from collections.abc import Callable

from scenes import alternate

import basrelief
from basrelief.errors import EngineError
from basrelief.rendering.programs import program_of, values_of

PLANE = basrelief.turned("x", -90.0) @ basrelief.placed(scale=(4.0, 4.0, 4.0))
CAMERA = basrelief.Orbit(azimuth=20.0, elevation=40.0, distance=1.6)
"""The plane fills the whole picture: every pixel pays."""


def gamedev() -> basrelief.Scene:
    """Parallax occlusion of 4 to 20 samples, ambient and diffuse light on the colour map."""
    thing = basrelief.Object(
        basrelief.sample("bricks"),
        technique="parallax_occlusion",
        settings={"min_steps": 4, "max_steps": 20},
        scale=0.1,
        tiling=(4.0, 4.0),
        transform=PLANE,
    )
    return basrelief.Scene(
        (thing,),
        camera=CAMERA,
        lights=(basrelief.directional(-50.0, 35.0),),
        shading_model="phong",
        shading={"ambient": 0.1, "diffuse": 0.5, "specular": 0.0},
    )


def halliwell(shadows: str) -> basrelief.Scene:
    """A march by angle with a search after it, one light, with and without self-shadow."""
    thing = basrelief.Object(
        basrelief.sample("cobbles"),
        technique="relief",
        settings={"min_steps": 8, "max_steps": 24, "search_steps": 5},
        scale=0.1,
        tiling=(4.0, 4.0),
        transform=PLANE,
    )
    return basrelief.Scene(
        (thing,),
        camera=CAMERA,
        lights=(basrelief.directional(-50.0, 35.0),),
        shadows=shadows,  # type: ignore[arg-type]
        shadowing={"shadow_steps": 16},
    )


CASES = {
    "gamedev, 4 to 20 samples": (gamedev, (640, 480)),
    "halliwell without self-shadow": (lambda: halliwell("none"), (1600, 900)),
    "halliwell with self-shadow": (lambda: halliwell("hard"), (1600, 900)),
}


def on_cpu() -> tuple[str, dict[str, float]]:
    """The processor, and seconds a frame, the pixels' planes in memory."""
    from basrelief.engine.cpu import CpuEngine

    engine = CpuEngine()
    tasks: dict[str, Callable[[], object]] = {}
    for name, (scene_of, size) in CASES.items():
        scene = scene_of()
        thing = scene.objects[0]
        program, values = program_of(thing, scene), values_of(thing, scene, size, engine)
        tasks[name] = lambda p=program, v=values, s=size: engine.run(p, v, s)
    return engine.device, alternate(tasks)


def on_gpu() -> tuple[str, dict[str, float]]:
    """The device, and seconds a dispatch by timestamps, the frame left on the GPU."""
    from gpu_kernel import milliseconds

    from basrelief.engine.gpu import GpuEngine

    engine, found = GpuEngine(), {}
    for name, (scene_of, size) in CASES.items():
        scene = scene_of()
        thing = scene.objects[0]
        values = values_of(thing, scene, size, engine)
        with engine.prepare(program_of(thing, scene), values, size) as job:
            found[name] = milliseconds(engine, {name: job}, size[1])[name] / 1000.0
    return engine.device, found


def show(device: str, seconds: dict[str, float]) -> None:
    """One line a case, and halliwell's ratio beside his."""
    print(device)
    for name, each in seconds.items():
        print(f"  {name:32} {each * 1000:9.3f} ms, {1.0 / each:8.0f} frames a second")
    without, within = (seconds[n] for n in seconds if n.startswith("halliwell"))
    print(f"  self-shadow takes {within / without:.2f} times as long (halliwell: 650 to 450, 1.44)")
    fast = 1.0 / seconds["gamedev, 4 to 20 samples"]
    print(f"  gamedev: more than 60 frames a second there, {fast:.0f} here")


def main() -> None:
    engines = {"cpu": on_cpu, "gpu": on_gpu}
    for name in sys.argv[1:] or engines:
        try:
            show(*engines[name]())
        except EngineError as error:
            print(f"{name}: {error}")


if __name__ == "__main__":
    main()
