"""Cone stepping: from each place leap to where the ray leaves the cone that is baked for it.

`basrelief.baking.cone_map` makes cones that the surface does not rise into, `relaxed_cone_map` such
that a ray may enter it in but not leave. Cones are circular in
texels, and a record is read for the cell below the ray, as it stands, not interpolated.
"""

from __future__ import annotations

from basrelief.lang import (
    HeightField,
    IVec2,
    Texture,
    Vec2,
    length,
    setting,
    shader,
    size,
    stored,
    struct,
)
from basrelief.techniques.cone_bake import CONE_MAP, RELAXED_CONE_MAP
from basrelief.techniques.edge import cell_in_map
from basrelief.techniques.exact import (
    Clearance,
    cell_after,
    cell_of_map,
    clearance,
    clearance_after,
    first_root,
    is_met,
    line_of,
    walls_of,
)
from basrelief.techniques.height import cell_at, extent_of, sharp
from basrelief.techniques.ray import Hit, Ray, at, fastest_fall, height_at, hit_at
from basrelief.techniques.technique import technique

UNIT = 1.0 / 65535.0
SHORTEST = 1e-6
"""The least of its way that a ray goes on by: less, and float32 would leave it where it is."""


@struct
class Cones:
    """Settings of a march by cones."""

    steps: int = setting(default=48, doc="cells visited at most", low=1, high=4096)


@struct
class RelaxedCones:
    """Settings of a march by relaxed cones, and of the search that follows."""

    steps: int = setting(default=15, doc="leaps at most", low=1, high=4096)
    search_steps: int = setting(default=6, doc="halvings of the last leap", low=0, high=24)


@technique(bake=CONE_MAP, most_reads=96)
def cone(field: HeightField, baked: Texture, ray: Ray, settings: Cones) -> Hit:
    """Solve the cell below the ray; where that is not met, leap to the end of its cone.

    No feature is missed, and no hit passed: where the steps run out the ray stays short of it, and
    is not found. Cost: two reads a step, the cell's heights and its cone. J. Dummer, Cone Step
    Mapping, 2006; there a step begins within the cell, so that next to a steep wall it
    freezes, and cones are those of texels, which the surface between them may rise into.
    """
    extent = extent_of(field, 0)
    line = line_of(ray, extent, 0, 0)
    travel = length(line.way)
    cell = Vec2(0.0, 0.0)
    above = Clearance(0.0, 0.0, 0.0, 0.0)
    t = 0.0
    found = False
    reads = 0
    k = 0
    while k < settings.steps and not found and t < 1.0:
        walls = walls_of(line, cell)
        out = min(max(min(walls.x, walls.y), t), 1.0)
        above = clearance(field, line, cell, extent, t, out)
        found = is_met(above)
        reads = reads + 1
        if not found:
            # at its far wall the ray is still above this cell, and in its cone
            room = max(clearance_after(above, above.span), 0.0)
            held = cell_of_map(baked, line, cell, extent)
            rate = fastest_fall(ray, out)
            t = out + room * share_of_cone(baked, IVec2(int(held.x), int(held.y)), rate, travel)
            t = min(t, 1.0)
            cell = cell_after(line, cell, walls, t)
            reads = reads + 1
        k = k + 1
    return hit_at(ray, t + first_root(above) if found else t, found, reads)


@technique(bake=RELAXED_CONE_MAP, most_reads=36)
def relaxed_cone(field: HeightField, baked: Texture, ray: Ray, settings: RelaxedCones) -> Hit:
    """Leap to the end of wider cones, into the surface but not out again, then halve the last leap.

    Features narrower than a texel or two can be missed, others are not: see
    `basrelief.baking.relaxed_cone_map`. Where the steps run out above the surface, the ray
    stays there, and is not found: mostly close to it, but at a grazing angle rays that skim a crest
    freeze above it, where `cone` goes on. Cost: two reads a step, height
    and cone, and one for each halving. F. Policarpo and M. M. Oliveira, Relaxed Cone Stepping for
    Relief Mapping, GPU Gems 3, 2007.
    """
    extent = size(field, 0)
    travel = length(ray.travel * Vec2(float(extent.x), float(extent.y)))
    t = 0.0
    before = 0.0
    clearance = ray.height - sharp(field, ray.uv)
    reads = 1
    k = 0
    while k < settings.steps and clearance > 0.0 and t < 1.0:
        before = t
        here = cell_of_baked(field, at(ray, t), extent)
        ahead = clearance * share_of_cone(baked, here, fastest_fall(ray, t), travel)
        t = min(t + max(ahead, SHORTEST), 1.0)
        clearance = height_at(ray, t) - sharp(field, at(ray, t))
        reads = reads + 2
        k = k + 1
    found = clearance <= 0.0
    rounds = settings.search_steps if found and k > 0 else 0
    for _ in range(rounds):
        middle = 0.5 * (before + t)
        above = sharp(field, at(ray, middle)) < height_at(ray, middle)
        before = middle if above else before
        t = t if above else middle
    return hit_at(ray, t, found, reads + rounds)


@shader
def cell_of_baked(field: HeightField, uv: Vec2, extent: IVec2) -> IVec2:
    """The cell of the map at texture coordinates."""
    corner = cell_at(field, uv, extent).corner
    return IVec2(cell_in_map(field, corner.x, extent.x), cell_in_map(field, corner.y, extent.y))


@shader
def share_of_cone(baked: Texture, cell: IVec2, rate: float, travel: float) -> float:
    """How far a ray goes on within a cell's cone for each height that it is above the tip.

    In all of its t the ray moves by `travel` texels, and falls by no more than `rate`. With the
    slope s of the cone it leaves it after 1 ÷ (rate + s · travel) of the height, or never where it
    rises as steeply; stored is c = 1 ÷ (1 + s).
    """
    # before the first cell of a border that goes on, the surface is no steeper than in that cell
    c = stored(baked, IVec2(max(cell.x, 0), max(cell.y, 0))).x * UNIT
    return c / max(c * rate + (1.0 - c) * travel, 1e-9)
