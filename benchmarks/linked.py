"""Programs linked from the pieces of a library, as a page runs them, against the engine's own.

A linked program passes all parameters of slots and has a function for each slot; a driver should
inline both. On a GPU by timestamps, alternating.
"""

from __future__ import annotations

import statistics
import sys
import time
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from figures import option_parser, store

import basrelief
from basrelief.engine.gpu import GpuEngine, Job
from basrelief.lang import Buffer, HeightField, Texture
from basrelief.rendering.programs import program_of, values_of
from basrelief.shading.geometry import Vertex
from basrelief.shading.shadow_map import ShadowMapView
from basrelief.techniques import TECHNIQUES
from basrelief.viewer.printed import ProgramLibrary, program_library

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
from helpers.linking import linked

SIZE = (1920, 1080)
RUNS = 15
MAX_RATIO = 1.05


def scenes(techniques: Iterable[str], texels: int) -> dict[str, basrelief.Scene]:
    """Bricks by each technique with soft shadows, and a landscape in fog."""
    material = basrelief.sample("bricks", texels)
    result = {}
    for name in techniques:
        obj = basrelief.Object(material, technique=name, scale=0.06, tiling=(3.0, 3.0))
        result[name] = basrelief.Scene((obj,), camera=basrelief.Orbit(20.0, 35.0), shadows="soft")
    land = replace(result["relief"].objects[0], surface="landscape", surface_parameters={})
    result["landscape"] = replace(result["relief"], objects=(land,), fog_mode="exponential")
    return result


def jobs(
    engine: GpuEngine, made: ProgramLibrary, scene: basrelief.Scene, size: tuple[int, int]
) -> tuple[dict[str, Job], Any]:
    """Jobs of the engine's program and the linked one, and the seconds to make each."""
    obj = scene.objects[0]
    program, values = program_of(obj.resolved, scene), values_of(obj.resolved, scene, size, engine)
    library = made.library
    types = program.parameters
    needed = [replace(b, type=types.get(b.name)) for b in library.bindings["pixel"]]
    dummies = {
        b.name: Texture([np.zeros((1, 1, 4), np.uint16)], "wrap")
        for b in needed
        if b.type is Texture
    }
    ones = HeightField([np.ones((1, 1), np.float32)], "wrap")
    dummies |= {"field": ones, "distances": ones, "views": Buffer((), ShadowMapView)}
    dummies |= {"geometry_vertices": Buffer((), Vertex)}
    began = time.perf_counter()
    whole = engine.prepare(program, values, size)
    between = time.perf_counter()
    text = linked(library, program)
    both = {
        "whole": whole,
        "linked": engine.prepare_text(text, program, {**dummies, **values}, size, needed),
    }
    return both, (between - began, time.perf_counter() - between)


def main() -> None:
    options = option_parser(__doc__).parse_args()
    techniques, size, texels, runs = TECHNIQUES, SIZE, 1024, RUNS
    if options.quick:
        techniques, size, texels, runs = ("relief",), (96, 54), 64, 1
    engine = GpuEngine()
    print(f"{engine.adapter}, {size[0]} × {size[1]}, soft shadows, {texels}² maps, ms a dispatch")
    began = time.perf_counter()
    made = program_library()
    print(f"the library: {len(made.library.pieces)} pieces, {time.perf_counter() - began:.2f} s")
    ratios, differing = {}, 0
    for name, scene in scenes(techniques, texels).items():
        both, seconds = jobs(engine, made, scene, size)
        times: dict[str, list[float]] = {kind: [] for kind in both}
        for run in range(runs + 2):
            for kind, job in both.items():
                seconds_taken = engine.seconds(job, size[1], 4)
                if run >= 2:
                    times[kind].append(seconds_taken * 1e3)
        a, b = (job.read(size[1]) for job in both.values())
        differing += int((a != b).sum())
        whole, linked_time = (statistics.median(times[kind]) for kind in ("whole", "linked"))
        ratios[name] = linked_time / whole
        print(
            f"{name:19} whole {whole:8.4f}, linked {linked_time:8.4f}, ratio {ratios[name]:.3f}; "
            f"words that differ {(a != b).mean():.5%}; in {seconds[0]:.2f} s, {seconds[1]:.2f} s"
        )
    median, worst = statistics.median(ratios.values()), max(ratios.values())
    print(
        f"median ratio {median:.3f}, worst {worst:.3f}; aim {MAX_RATIO}; {differing} words differ"
    )
    figures = {f"{name}, linked ÷ whole": ratio for name, ratio in ratios.items()}
    summary = {"median ratio": median, "worst ratio": worst, "words that differ": differing}
    store(options.json, {**figures, **summary})


if __name__ == "__main__":
    main()
