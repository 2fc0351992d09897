"""How often `exact` ends late: over a million rays against the oracle in float64.

    python benchmarks/misses.py            on the CPU
    python benchmarks/misses.py --gpu      on a GPU

Bricks, gravel, noise, posts of one texel, saddles and seams, their edges wrapped and clamped; rays
at 0 to 85 degrees from the normal, every way round, over reliefs of 0.02 to 0.5 tile widths. A ray
is late that ends more than 0.05 texel behind the first hit. What single precision itself gets wrong
is told by a plain walk from cell to cell with the same arithmetic and no bounds, beside.
"""

from __future__ import annotations

import time
from typing import Any

import numpy as np
from figures import option_parser, store

from basrelief import baking, sample
from basrelief.lang import (
    HeightField,
    IVec2,
    Texture,
    Vec2,
    cos,
    exp2,
    shader,
    sin,
    slot,
    struct,
    tan,
)
from basrelief.lang.program import Program
from basrelief.measure.oracle import first_hits
from basrelief.techniques import Nothing, exact
from basrelief.techniques.exact import (
    Clearance,
    cell_after,
    clearance,
    first_root,
    is_met,
    line_of,
    walls_of,
)
from basrelief.techniques.height import extent_of
from basrelief.techniques.ray import Hit, Ray, at

LATE = 0.05
"""Texels."""
BLUR = 4e-7
"""Heights that float32 cannot tell apart: some units in the last place of 1."""
RAYS = (512, 320)
"""Of each map and edge."""
STEEPEST = 85.0
DEEPEST = 0.5
RANGE = 4.643856
"""From the deepest relief to the shallowest, 0.02, in halvings."""
CELLS = 1 << 20
"""More than any ray here comes to."""


@struct
class Seed:
    """Another number, other rays."""

    number: int


@struct
class Traced:
    """A ray and where it ends."""

    uv: Vec2
    fall: Vec2
    height: float


@slot
def ended(field: HeightField, baked: Texture, ray: Ray) -> Hit:
    """Where a ray ends."""


@shader
def by_exact(field: HeightField, baked: Texture, ray: Ray) -> Hit:
    """As the technique says."""
    return exact(field, baked, ray, Nothing())


@shader
def by_cells(field: HeightField, ray: Ray) -> Hit:
    """Cell by cell, none left out."""
    extent = extent_of(field, 0)
    line = line_of(ray, extent, 0, 0)
    cell = Vec2(0.0, 0.0)
    above = Clearance(0.0, 0.0, 0.0, 0.0)
    t = 0.0
    found = False
    k = 0
    while k < CELLS and not found and t < 1.0:
        walls = walls_of(line, cell)
        out = max(min(walls.x, walls.y), t)
        above = clearance(field, line, cell, extent, t, out)
        found = is_met(above)
        if not found:
            t = out
            cell = cell_after(line, cell, walls, t)
        k = k + 1
    met = t + first_root(above) if found else t
    height = 1.0 - min(met, 1.0)
    return Hit(at(ray, height), height, found, k)


@shader
def scattered(n: int) -> float:
    """A number from 0 to 1 for every int."""
    x = n * 747796405 + 891336453
    y = ((x >> 15) ^ x) * 277803737
    return float(((y >> 11) ^ y) & 16777215) / 16777216.0


@shader
def traced(at: IVec2, seed: Seed, field: HeightField, baked: Texture) -> Traced:
    """One ray of many."""
    n = (at.y * 8192 + at.x) * 5 + seed.number * 7919
    uv = Vec2(scattered(n), scattered(n + 1))
    turn = scattered(n + 2) * 6.2831853
    depth = DEEPEST * exp2(-scattered(n + 3) * RANGE)
    fall = Vec2(cos(turn), sin(turn)) * (depth * tan(scattered(n + 4) * (STEEPEST * 0.0174532925)))
    return Traced(uv, fall, ended(field, baked, Ray(uv, fall, 1.0, 0.5)).height)


def maps(side: int) -> dict[str, np.ndarray]:
    """Height maps by name, float32, up to a side long, a multiple of 32."""
    random = np.random.default_rng(7)
    low, half = side * 3 // 4, side // 2
    posts = np.zeros((low, side))
    posts[random.integers(0, low, 200), random.integers(0, side, 200)] = 1.0
    seam = np.zeros((half + 1, half - 1))
    seam[0], seam[:, -1] = 1.0, 0.9
    made = {
        "bricks": sample("bricks", side).height.linear()[:, :, 0],
        "gravel": sample("gravel", (side * 25 // 32, side)).height.linear()[:, :, 0],
        "noise": random.random((side, side)),
        "posts": posts,
        "saddles": np.indices((half, half)).sum(0) % 2 * 1.0,
        "seams": seam,
    }
    return {name: np.ascontiguousarray(each, np.float32) for name, each in made.items()}


def apart(planes: Any, heights: np.ndarray, edge: Any) -> tuple[np.ndarray, int]:
    """By how many texels rays end behind the oracle; and how many end before it though nothing is
    there, not even were all a hair higher."""
    uv, fall = (
        np.stack([planes[f"{name}.x"], planes[f"{name}.y"]], -1).reshape(-1, 2).astype(float)
        for name in ("uv", "fall")
    )
    texels = np.linalg.norm(fall * heights.shape[::-1], axis=1)
    ended = 1.0 - planes["height"].ravel().astype(float)
    behind = (ended - first_hits(heights, uv, fall, edge).t) * texels
    early = np.flatnonzero(behind < -LATE)
    higher = np.minimum(heights.astype(float) + BLUR, 1.0)
    raised = first_hits(higher, uv[early], fall[early], edge).t
    return behind, int(((ended[early] - raised) * texels[early] < -LATE).sum())


def main() -> None:
    parser = option_parser(__doc__)
    parser.add_argument("--gpu", action="store_true")
    options = parser.parse_args()
    size, side = ((48, 32), 64) if options.quick else (RAYS, 256)
    engine: Any
    if options.gpu:
        from basrelief.engine.gpu import GpuEngine

        engine = GpuEngine()
    else:
        from basrelief.engine.cpu import CpuEngine

        engine = CpuEngine()
    print(f"{engine.device}, rays ending more than {LATE} texel late")
    total = np.zeros(3, int)
    begun = time.perf_counter()
    for name, heights in maps(side).items():
        for edge in ("wrap", "clamp"):
            field = HeightField([heights], edge)
            baked = Texture([baking.bounds(heights, edge, engine)], edge)
            values = {"seed": Seed(total[0]), "field": field, "baked": baked}
            counts, worst, early = [], [], []
            for way in (by_exact, by_cells):
                planes = engine.run(Program(traced, {ended: way}, edge), values, size)
                behind, before = apart(planes, heights, edge)
                counts.append(int((behind > LATE).sum()))
                worst.append(float(behind.max()))
                early.append(before)
            total += (behind.size, *counts)
            print(
                f"{name:8} {edge:5} {behind.size} rays: "
                f"exact {counts[0]} (worst {worst[0]:.4f}), cell by cell {counts[1]} "
                f"(worst {worst[1]:.4f}); before their time {early[0]} and {early[1]}",
                flush=True,
            )
    spent = time.perf_counter() - begun
    print(f"of {total[0]} rays exact {total[1]} late, cell by cell {total[2]}; {spent:.0f} s")
    rays, by_exact_late, by_cells_late = map(int, total)
    store(
        options.json,
        {
            f"{engine.name}, rays": rays,
            f"{engine.name}, exact, late": by_exact_late,
            f"{engine.name}, cell by cell, late": by_cells_late,
        },
    )


if __name__ == "__main__":
    main()
