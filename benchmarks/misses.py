"""Rays that `exact` ends late, of millions, against the oracle in float64.

    python benchmarks/misses.py            on the CPU
    python benchmarks/misses.py --gpu      on a GPU

Bricks, gravel, noise, posts of one texel, saddles and seams, with edges wrapped and clamped. Rays
at 0 to 85 degrees from the normal in all directions, over reliefs of 0.02 to 0.5 tile widths: whole
rays over a flat surface, and segments between any two heights, straight, bent down and bent up. A
ray is late if it ends more than 0.05 texel behind the first hit, also for a surface lowered by the
rounding error of single precision. For comparison, a traversal of all cells without bounds, with
the same arithmetic, shows the misses that are due to single precision.
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
from basrelief.measure.oracle import intersect_height_field
from basrelief.techniques import Nothing, exact
from basrelief.techniques.exact import (
    Clearance,
    cell_exits,
    clearance,
    first_root,
    hits_patch,
    mirrored_ray,
    next_cell,
)
from basrelief.techniques.height import extent_of
from basrelief.techniques.ray import Hit, Ray, hit_at

LATE = 0.05
"""Texels."""
BLUR = 4e-7
"""Difference of heights below the precision of float32: some units in the last place of 1."""
RAYS = (512, 320)
"""Rays for each map and edge, as a picture size."""
STEEPEST = 85.0
DEEPEST = 0.5
RANGE = 4.643856
"""Halvings from the deepest relief to the shallowest, 0.02."""
CELLS = 1 << 20
"""Bound of the traversal, more cells than any ray here crosses."""


KINDS = {
    "whole": (0.0, 0.0),
    "straight": (1.0, 0.0),
    "bent down": (1.0, 1.5),
    "bent up": (1.0, -1.5),
}
"""Kinds of rays: the part of the height range by which a ray may start below the top and end above
the bottom, and its largest bend."""


@struct
class Seed:
    """Seed of the random rays, with the numbers of `KINDS`."""

    number: int
    part: float
    bend: float


@struct
class Traced:
    """A ray and its hit."""

    uv: Vec2
    travel: Vec2
    height: float
    drop: float
    bend: float
    t: float


@slot
def trace(field: HeightField, baked: Texture, ray: Ray) -> Hit:
    """Hit of a ray."""


@shader
def by_exact(field: HeightField, baked: Texture, ray: Ray) -> Hit:
    """The technique `exact`."""
    return exact(field, baked, ray, Nothing())


@shader
def by_cells(field: HeightField, ray: Ray) -> Hit:
    """Traversal of all cells."""
    extent = extent_of(field, 0)
    line = mirrored_ray(ray, extent, 0, 0)
    cell = Vec2(0.0, 0.0)
    above = Clearance(0.0, 0.0, 0.0, 0.0)
    t = 0.0
    found = False
    k = 0
    while k < CELLS and not found and t < 1.0:
        walls = cell_exits(line, cell)
        out = min(max(min(walls.x, walls.y), t), 1.0)
        above = clearance(field, line, cell, extent, t, out)
        found = hits_patch(above)
        if not found:
            t = out
            cell = next_cell(line, cell, walls, t)
        k = k + 1
    return hit_at(ray, t + first_root(above) if found else t, found, k)


@shader
def hashed(n: int) -> float:
    """Hash of an int to 0 … 1."""
    x = n * 747796405 + 891336453
    y = ((x >> 15) ^ x) * 277803737
    return float(((y >> 11) ^ y) & 16777215) / 16777216.0


@shader
def traced(at: IVec2, seed: Seed, field: HeightField, baked: Texture) -> Traced:
    """A random ray and its hit."""
    n = (at.y * 8192 + at.x) * 8 + seed.number * 7919
    uv = Vec2(hashed(n), hashed(n + 1))
    turn = hashed(n + 2) * 6.2831853
    depth = DEEPEST * exp2(-hashed(n + 3) * RANGE)
    length = depth * tan(hashed(n + 4) * (STEEPEST * 0.0174532925))
    travel = Vec2(cos(turn), sin(turn)) * length
    height = 1.0 - seed.part * hashed(n + 5) * hashed(n + 5)
    drop = height - seed.part * hashed(n + 6)
    ray = Ray(uv, travel, height, drop, 0.5, bend=seed.bend * hashed(n + 7))
    return Traced(uv, travel, height, drop, ray.bend, trace(field, baked, ray).t)


def maps(side: int) -> dict[str, np.ndarray]:
    """Height maps by name, float32, with sides up to `side`, a multiple of 32."""
    random = np.random.default_rng(7)
    low, half = side * 3 // 4, side // 2
    posts = np.zeros((low, side))
    posts[random.integers(0, low, 200), random.integers(0, side, 200)] = 1.0
    seam = np.zeros((half + 1, half - 1))
    seam[0], seam[:, -1] = 1.0, 0.9
    result = {
        "bricks": sample("bricks", side).height.linear()[:, :, 0],
        "gravel": sample("gravel", (side * 25 // 32, side)).height.linear()[:, :, 0],
        "noise": random.random((side, side)),
        "posts": posts,
        "saddles": np.indices((half, half)).sum(0) % 2 * 1.0,
        "seams": seam,
    }
    return {name: np.ascontiguousarray(heights, np.float32) for name, heights in result.items()}


def end_errors(planes: Any, heights: np.ndarray, edge: Any) -> tuple[np.ndarray, int]:
    """Distances of ray ends behind the first hit, in texels, and the number that end before it.

    Where a ray is off, the surface is lowered, or raised, by `BLUR`.
    """
    flat = {name: plane.ravel().astype(float) for name, plane in planes.items()}
    uv, travel = (np.stack([flat[f"{name}.x"], flat[f"{name}.y"]], -1) for name in ("uv", "travel"))
    texels = np.linalg.norm(travel * heights.shape[::-1], axis=1)

    def behind(surface: np.ndarray, rays: Any) -> np.ndarray:
        falls = {name: flat[name][rays] for name in ("height", "drop", "bend")}
        wanted = intersect_height_field(surface, uv[rays], travel[rays], edge, **falls).t
        return (flat["t"][rays] - wanted) * texels[rays]

    off = behind(heights, slice(None))
    late, early = np.flatnonzero(off > LATE), np.flatnonzero(off < -LATE)
    off[late] = behind(np.maximum(heights.astype(float) - BLUR, 0.0), late)
    before = behind(np.minimum(heights.astype(float) + BLUR, 1.0), early)
    return off, int((before < -LATE).sum())


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
    print(f"{engine.adapter}, rays ending more than {LATE} texel late")
    figures = {}
    for kind, (part, bend) in KINDS.items():
        rays, late, late_by_cells = counted(engine, kind, part, bend, size, side)
        figures |= {
            f"{engine.name}, {kind}, rays": rays,
            f"{engine.name}, {kind}, exact, late": late,
            f"{engine.name}, {kind}, cell by cell, late": late_by_cells,
        }
    store(options.json, figures)


def counted(
    engine: Any, kind: str, part: float, bend: float, size: tuple[int, int], side: int
) -> tuple[int, int, int]:
    """Number of rays of a kind, of those that `exact` ends late, and of those by all cells."""
    total = np.zeros(3, int)
    begun = time.perf_counter()
    for name, heights in maps(side).items():
        for edge in ("wrap", "clamp"):
            field = HeightField([heights], edge)
            baked = Texture([baking.bounds(heights, edge, engine)], edge)
            values = {"seed": Seed(total[0], part, bend), "field": field, "baked": baked}
            counts, worst, early = [], [], []
            for method in (by_exact, by_cells):
                planes = engine.run(Program(traced, {trace: method}, edge), values, size)
                behind, before = end_errors(planes, heights, edge)
                counts.append(int((behind > LATE).sum()))
                worst.append(float(behind.max()))
                early.append(before)
            total += (behind.size, *counts)
            print(
                f"{kind}, {name:8} {edge:5} {behind.size} rays: "
                f"exact {counts[0]} (worst {worst[0]:.4f}), cell by cell {counts[1]} "
                f"(worst {worst[1]:.4f}); early {early[0]} and {early[1]}",
                flush=True,
            )
    spent = time.perf_counter() - begun
    print(
        f"{kind}: of {total[0]} rays exact {total[1]} late, cell by cell {total[2]}; {spent:.0f} s"
    )
    return int(total[0]), int(total[1]), int(total[2])


if __name__ == "__main__":
    main()
