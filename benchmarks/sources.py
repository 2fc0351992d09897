"""Published frame rates of two sources, compared with ours.

gamedev: faster than 60 frames a second at 640 × 480 with 4 to 20 samples (a GeForce 8600M GT).
halliwell: about 450 frames a second with self-shadow and 650 without, at 1600 × 900 (a GTX 670).

    python benchmarks/sources.py           on the CPU, then on a GPU
    python benchmarks/sources.py cpu       on one of them
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial

from figures import option_parser, store
from scenes import alternate

import basrelief
from basrelief.errors import DeviceError
from basrelief.rendering.programs import program_of, values_of

PLANE = basrelief.rotated("x", -90.0) @ basrelief.placed(scale=(4.0, 4.0, 4.0))
CAMERA = basrelief.Orbit(azimuth=20.0, elevation=40.0, distance=1.6)
"""The plane fills the whole picture."""


def gamedev(texels: int = 512) -> basrelief.Scene:
    """Parallax occlusion of 4 to 20 samples, ambient and diffuse light on the colour map."""
    obj = basrelief.Object(
        basrelief.sample("bricks", texels),
        technique="parallax_occlusion",
        settings={"min_steps": 4, "max_steps": 20},
        surface_parameters={"specular": 0.0},
        scale=0.1,
        tiling=(4.0, 4.0),
        transform=PLANE,
    )
    return basrelief.Scene(
        (obj,),
        camera=CAMERA,
        lights=(basrelief.directional(-50.0, 35.0),),
        shading_model="phong",
        shading={"ambient": 0.1, "diffuse": 0.5},
    )


def halliwell(shadows: str, texels: int = 512) -> basrelief.Scene:
    """A march by angle with a search after it, one light, with and without self-shadow."""
    obj = basrelief.Object(
        basrelief.sample("cobbles", texels),
        technique="relief",
        settings={"min_steps": 8, "max_steps": 24, "search_steps": 5},
        scale=0.1,
        tiling=(4.0, 4.0),
        transform=PLANE,
    )
    return basrelief.Scene(
        (obj,),
        camera=CAMERA,
        lights=(basrelief.directional(-50.0, 35.0),),
        shadows=shadows,  # type: ignore[arg-type]
        shadowing={"max_shadow_steps": 16},
    )


CASES = {
    "gamedev, 4 to 20 samples": (gamedev, (640, 480)),
    "halliwell without self-shadow": (partial(halliwell, "none"), (1600, 900)),
    "halliwell with self-shadow": (partial(halliwell, "hard"), (1600, 900)),
}
Cases = Mapping[str, tuple[basrelief.Scene, tuple[int, int]]]


def on_cpu(cases: Cases, quick: bool) -> tuple[str, dict[str, float], dict[str, float]]:
    """The processor, and wall and processor seconds per frame, up to the planes in memory."""
    from basrelief.engine.cpu import CpuEngine

    engine = CpuEngine()
    tasks: dict[str, Callable[[], object]] = {}
    for name, (scene, size) in cases.items():
        obj = scene.objects[0]
        program, values = (
            program_of(obj.resolved, scene),
            values_of(obj.resolved, scene, size, engine),
        )
        tasks[name] = lambda p=program, v=values, s=size: engine.run(p, v, s)
    frames = alternate(tasks, 1 if quick else 7)
    walls, busy = ({name: taken[clock] for name, taken in frames.items()} for clock in (0, 1))
    return engine.adapter, walls, busy


def on_gpu(cases: Cases, quick: bool) -> tuple[str, dict[str, float], dict[str, float]]:
    """The adapter, and seconds per dispatch by timestamps, with the frame left on the GPU."""
    from gpu_kernel import RUNS, milliseconds

    from basrelief.engine.gpu import GpuEngine

    engine, times = GpuEngine(), {}
    runs = 1 if quick else RUNS
    for name, (scene, size) in cases.items():
        obj = scene.objects[0]
        values = values_of(obj.resolved, scene, size, engine)
        with engine.prepare(program_of(obj.resolved, scene), values, size) as job:
            times[name] = milliseconds(engine, {name: job}, size[1], runs)[name] / 1000.0
    return engine.adapter, times, {}


def show(adapter: str, seconds: dict[str, float]) -> dict[str, float]:
    """Print a line for each case and the ratio for halliwell; returns the figures."""
    print(adapter)
    for name, each in seconds.items():
        print(f"  {name:32} {each * 1000:9.3f} ms, {1.0 / each:8.0f} frames a second")
    without, within = (seconds[n] for n in seconds if n.startswith("halliwell"))
    print(f"  self-shadow takes {within / without:.2f} times as long (halliwell: 650 to 450, 1.44)")
    fast = 1.0 / seconds["gamedev, 4 to 20 samples"]
    print(f"  gamedev: more than 60 frames a second there, {fast:.0f} here")
    milliseconds = {f"{name}, ms": each * 1000 for name, each in seconds.items()}
    return {**milliseconds, "halliwell with ÷ without self-shadow": within / without}


def main() -> None:
    parser = option_parser(__doc__)
    parser.add_argument("devices", nargs="*", metavar="cpu|gpu")
    options = parser.parse_args()
    texels, smaller = (64, 10) if options.quick else (512, 1)
    cases = {
        name: (scene_of(texels), (width // smaller, height // smaller))
        for name, (scene_of, (width, height)) in CASES.items()
    }
    measured = {"cpu": on_cpu, "gpu": on_gpu}
    for name in options.devices or measured:
        try:
            adapter, seconds, busy = measured[name](cases, options.quick)
        except DeviceError as error:
            print(f"{name}: {error}")
            continue
        figures = show(adapter, seconds)
        for each, spent in busy.items():
            print(f"  {each:32} {spent * 1000:9.3f} ms of processor time")
            figures[f"{each}, processor ms"] = spent * 1000
        store(options.json, {f"{name}, {each}": value for each, value in figures.items()})


if __name__ == "__main__":
    main()
