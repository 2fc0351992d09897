"""Programs linked from a library's pieces, as a page runs them, against the engine's own.

A linked program passes on whatever a slot might take, and hands every call of a slot on; a driver
should see through both. On a GPU by timestamps, both in turn.
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
MOST = 1.05


def scenes(techniques: Iterable[str], texels: int) -> dict[str, basrelief.Scene]:
    """Bricks by each technique, lit with soft shadows; and a landscape in fog."""
    material = basrelief.sample("bricks", texels)
    found = {}
    for name in techniques:
        obj = basrelief.Object(material, technique=name, scale=0.06, tiling=(3.0, 3.0))
        found[name] = basrelief.Scene((obj,), camera=basrelief.Orbit(20.0, 35.0), shadows="soft")
    land = replace(found["relief"].objects[0], surface="landscape", surface_parameters={})
    found["landscape"] = replace(found["relief"], objects=(land,), fog="exponential")
    return found


def jobs(
    engine: GpuEngine, made: ProgramLibrary, scene: basrelief.Scene, size: tuple[int, int]
) -> tuple[dict[str, Job], Any]:
    """The engine's program and the linked one, and the seconds that each took to make."""
    obj = scene.objects[0]
    program, values = program_of(obj, scene), values_of(obj, scene, size, engine)
    library = made.library
    types = program.parameters
    needed = [replace(each, type=types.get(each.name)) for each in library.bindings["pixel"]]
    nothing = {
        each.name: Texture([np.zeros((1, 1, 4), np.uint16)], "wrap")
        for each in needed
        if each.type is Texture
    }
    ones = HeightField([np.ones((1, 1), np.float32)], "wrap")
    nothing |= {"field": ones, "distances": ones, "views": Buffer((), ShadowMapView)}
    nothing |= {"geometry_vertices": Buffer((), Vertex)}
    began = time.perf_counter()
    whole = engine.prepare(program, values, size)
    between = time.perf_counter()
    text = linked(library, program)
    both = {
        "whole": whole,
        "linked": engine.prepare_text(text, program, {**nothing, **values}, size, needed),
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
        found: dict[str, list[float]] = {each: [] for each in both}
        for run in range(runs + 2):
            for each, job in both.items():
                taken = engine.seconds(job, size[1], 4)
                if run >= 2:
                    found[each].append(taken * 1e3)
        a, b = (job.read(size[1]) for job in both.values())
        differing += int((a != b).sum())
        whole, apart = (statistics.median(found[each]) for each in ("whole", "linked"))
        ratios[name] = apart / whole
        print(
            f"{name:19} whole {whole:8.4f}, linked {apart:8.4f}, ratio {ratios[name]:.3f}; words "
            f"that differ {(a != b).mean():.5%}; made in {seconds[0]:.2f} s, {seconds[1]:.2f} s"
        )
    median, worst = statistics.median(ratios.values()), max(ratios.values())
    print(f"median ratio {median:.3f}, worst {worst:.3f}; aim {MOST}; {differing} words differ")
    figures = {f"{name}, linked ÷ whole": ratio for name, ratio in ratios.items()}
    summary = {"median ratio": median, "worst ratio": worst, "words that differ": differing}
    store(options.json, {**figures, **summary})


if __name__ == "__main__":
    main()
