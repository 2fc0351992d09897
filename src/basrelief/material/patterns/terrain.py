"""A landscape from above: eroded mountains, a lake in the lowest part, snow on the summits."""

from __future__ import annotations

import numpy as np

from basrelief.material.patterns.canvas import Canvas, Plane, Relief, mix, shade, smoothstep

TILE, DEPTH = 2400.0, 360.0
OCTAVES = 7
BLUNT = 0.12
UNDER_WATER, SNOW = 0.10, 0.66
WATER, SHORE = (0.16, 0.30, 0.36), (0.66, 0.60, 0.46)
GRASS, FOREST = (0.45, 0.49, 0.25), (0.23, 0.32, 0.17)
ROCK, SCREE, ICE = (0.44, 0.40, 0.37), (0.56, 0.52, 0.47), (0.95, 0.96, 0.98)


def terrain(canvas: Canvas) -> Relief:
    """2.4 km of mountains that reach 360 m above the bottom of the lake's valley."""
    land = _eroded(canvas)
    lake = np.quantile(land, UNDER_WATER)
    land = (land - lake) / max(land.max() - lake, np.float32(1e-6))
    height = np.maximum(land, 0)
    steep = _steepness(land)
    patchy = canvas.noise("patches", 12, octaves=5, gain=0.6)
    fine = canvas.noise("fine", 64, octaves=3, gain=0.7)

    wooded = smoothstep(-0.3, 0.6, patchy) * smoothstep(0.50, 0.34, land + 0.03 * fine)
    color = mix(GRASS, FOREST, wooded)
    stony = smoothstep(0.55, 0.95, steep + 0.06 * patchy + 0.35 * smoothstep(0.4, 0.65, land))
    rock = mix(ROCK, SCREE, smoothstep(-1, 1, patchy + fine))
    color = mix(color, rock, stony)
    snowy = smoothstep(SNOW - 0.10, SNOW + 0.02, land + 0.03 * patchy - 0.22 * (steep - 0.6))
    color = mix(color, ICE, snowy)
    color = mix(color, SHORE, smoothstep(0.035, 0.012, land))
    color = shade(color, 1 + 0.06 * fine * (1 - snowy) + 0.04 * patchy * (1 - snowy))
    water = smoothstep(0.002, -0.002, land)
    deep = smoothstep(0.0, -0.12, land)
    color = mix(color, shade(mix(WATER, WATER, deep), 1.15 - 0.45 * deep), water)
    roughness = mix(0.92 - 0.25 * snowy, 0.08, water)
    return Relief(height, color, roughness, DEPTH, TILE)


def _eroded(canvas: Canvas) -> Plane:
    """Ridged multifractal noise over hills: octaves are weighted by the ridges before them.

    Ridges branch into ridges while the valleys stay smooth, as after erosion by water
    (F. K. Musgrave, *Texturing and Modeling: A Procedural Approach*, 3rd ed. 2003, ch. 16). The
    crests are rounded: a ridge is 1 − √(noise² + BLUNT²).
    """
    hills = canvas.noise("hills", 2, octaves=3)
    total = np.float32(0.06) * hills
    octave_weight = 0.45 + 0.55 * smoothstep(-1.5, 1.2, hills)
    weight = 1.0
    for octave in range(OCTAVES):
        across = 4 << octave
        if octave and across > canvas.width // 2:
            break
        layer = canvas.noise(f"ridges {octave}", across)
        ridge = 1 - np.sqrt((0.7 * layer) ** 2 + BLUNT**2)
        total = total + np.float32(weight) * octave_weight * ridge
        octave_weight = np.clip(octave_weight * (0.30 + 0.95 * ridge), 0.12, 1)
        weight *= 0.58
    return total.astype(np.float32)


def _slope(values: Plane, axis: int) -> Plane:
    """Slope per width of the picture, by periodic central differences."""
    rise: Plane = np.roll(values, -1, axis) - np.roll(values, 1, axis)
    return rise * np.float32(values.shape[1] / 2)


def _steepness(land: Plane) -> Plane:
    scale = np.float32(DEPTH / TILE)
    return scale * np.hypot(_slope(land, 0), _slope(land, 1))
