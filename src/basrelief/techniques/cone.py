r"""Cone stepping: leap through the empty space of a cone that is baked for each cell.

The bake stores for each cell the slope s of a cone: from any point x of the surface over the cell,
no point y of the surface is higher than

    f(x) + s · |y − x|                                             distances in texels

    height                       __/   cone of slope s
      r *                    __/
        |  \             __/         A ray at height r, a above the surface at x, loses at most
      a |     \      __/             `descent` of height per t and moves by `travel` texels per t.
        |        \_/                 It is above the cone, and so above the surface, until
        |     __/
   f(x) *  __/                           r − descent · Δt = f(x) + s · travel · Δt
    ____|/______________________         Δt = a ÷ (descent + s · travel)
        x

The table holds c = 1 ÷ (1 + s), from 0 (a wall) to 1 (a half space), so s = (1 − c) ÷ c and

    Δt = a · c ÷ (c · descent + (1 − c) · travel)                  (`cone_reach` is Δt ÷ a)

Next to a steep wall such leaps are tiny. `cone` therefore solves the cell's patch first, as `exact`
does, and leaps from the cell's far side: every step leaves a cell, and no hit is missed.

A relaxed cone is wider. The surface may rise into it, but a ray that goes below the surface within
the cone does not come out again within it. A leap then ends either above the surface or below it
with a single crossing in between, which a binary search finds.

The cones are circular in texels. A record is read for the cell below the ray and not interpolated.
`basrelief.baking` makes them: `cone_map`, `relaxed_cone_map`.
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
    cell_exits,
    cell_of_map,
    clearance,
    clearance_at,
    first_root,
    hits_patch,
    mirrored_ray,
    next_cell,
)
from basrelief.techniques.height import cell_at, extent_of, sharp
from basrelief.techniques.ray import Hit, Ray, at, height_at, hit_at, max_descent
from basrelief.techniques.technique import technique

UNIT = 1.0 / 65535.0
"""The unit of the table's 16-bit numbers."""
MIN_STEP = 1e-6
"""The least advance of t; by less, float32 might not move the ray."""


@struct
class Cones:
    """Settings of cone stepping."""

    steps: int = setting(default=48, doc="maximum number of cells visited", low=1, high=4096)


@struct
class RelaxedCones:
    """Settings of relaxed cone stepping and of the search that follows."""

    steps: int = setting(default=15, doc="maximum number of leaps", low=1, high=4096)
    search_steps: int = setting(
        default=6, doc="binary search steps in the last leap", low=0, high=24
    )


@technique(bake=CONE_MAP, most_reads=96)
def cone(field: HeightField, baked: Texture, ray: Ray, settings: Cones) -> Hit:
    """Cone stepping: solve the cell below the ray; without a hit, leap out of its cone.

        t ← t_exit + a · c ÷ (c · descent + (1 − c) · travel),  a the clearance at t_exit

    No feature is missed and no hit passed: a ray that runs out of steps stops short of the surface
    and is not found.
    Cost: two reads a step, the cell's heights and its cone.

    References
    ----------
    J. Dummer, Cone Step Mapping, 2006. There a step begins within the cell, so that next to a steep
    wall it hardly moves, and cones are those of texels, into which the surface between texels may
    rise.
    """
    extent = extent_of(field, 0)
    line = mirrored_ray(ray, extent, 0, 0)
    travel = length(line.travel)
    cell = Vec2(0.0, 0.0)
    patch = Clearance(0.0, 0.0, 0.0, 0.0)
    t = 0.0
    found = False
    reads = 0
    k = 0
    while k < settings.steps and not found and t < 1.0:
        exits = cell_exits(line, cell)
        t_exit = min(max(min(exits.x, exits.y), t), 1.0)
        patch = clearance(field, line, cell, extent, t, t_exit)
        found = hits_patch(patch)
        reads = reads + 1
        if not found:
            # at the far side the ray is above this cell, and within its cone
            above = max(clearance_at(patch, patch.span), 0.0)
            in_map = cell_of_map(baked, line, cell, extent)
            descent = max_descent(ray, t_exit)
            t = t_exit + above * cone_reach(
                baked, IVec2(int(in_map.x), int(in_map.y)), descent, travel
            )
            t = min(t, 1.0)
            cell = next_cell(line, cell, exits, t)
            reads = reads + 1
        k = k + 1
    return hit_at(ray, t + first_root(patch) if found else t, found, reads)


@technique(bake=RELAXED_CONE_MAP, most_reads=36)
def relaxed_cone(field: HeightField, baked: Texture, ray: Ray, settings: RelaxedCones) -> Hit:
    """Relaxed cone stepping: leap out of wider cones, into the surface but not out again, then
    halve the last leap.

        t ← t + a · c ÷ (c · descent + (1 − c) · travel) while a = height_at(t) − surface(t) > 0

    Features narrower than one or two texels can be missed; see `basrelief.baking.relaxed_cone_map`.
    A ray that runs out of steps above the surface stops there and is not found: usually close to
    it, but at grazing angles rays that skim a crest stay above it, where `cone` continues.
    Cost: two reads a leap, height and cone, and one for each halving.

    References
    ----------
    F. Policarpo and M. M. Oliveira, Relaxed Cone Stepping for Relief Mapping, GPU Gems 3, 2007.
    """
    extent = size(field, 0)
    travel = length(ray.travel * Vec2(float(extent.x), float(extent.y)))
    t = 0.0
    previous_t = 0.0
    above = ray.height - sharp(field, ray.uv)
    reads = 1
    k = 0
    while k < settings.steps and above > 0.0 and t < 1.0:
        previous_t = t
        cell = map_cell(field, at(ray, t), extent)
        leap = above * cone_reach(baked, cell, max_descent(ray, t), travel)
        t = min(t + max(leap, MIN_STEP), 1.0)
        above = height_at(ray, t) - sharp(field, at(ray, t))
        reads = reads + 2
        k = k + 1
    found = above <= 0.0
    rounds = settings.search_steps if found and k > 0 else 0
    for _ in range(rounds):
        middle = 0.5 * (previous_t + t)
        is_above = sharp(field, at(ray, middle)) < height_at(ray, middle)
        previous_t = middle if is_above else previous_t
        t = t if is_above else middle
    return hit_at(ray, t, found, reads + rounds)


@shader
def map_cell(field: HeightField, uv: Vec2, extent: IVec2) -> IVec2:
    """The cell of the map at texture coordinates."""
    corner = cell_at(field, uv, extent).corner
    return IVec2(cell_in_map(field, corner.x, extent.x), cell_in_map(field, corner.y, extent.y))


@shader
def cone_reach(baked: Texture, cell: IVec2, descent: float, travel: float) -> float:
    """The t in which a ray leaves a cell's cone, per height above its tip: c ÷ (c · descent +
    (1 − c) · travel).

    `descent` is the upper limit of the height that the ray loses per t, `travel` the texels per t.
    """
    # before the first cell of a clamped border the surface is no steeper than in that cell
    c = stored(baked, IVec2(max(cell.x, 0), max(cell.y, 0))).x * UNIT
    return c / max(c * descent + (1.0 - c) * travel, 1e-9)
