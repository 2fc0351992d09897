"""Procedural patterns: functions that draw height, colour and roughness on a periodic canvas."""

from __future__ import annotations

from collections.abc import Callable

from basrelief.material.patterns.bricks import bricks
from basrelief.material.patterns.canvas import Canvas, Relief
from basrelief.material.patterns.circuit import circuit
from basrelief.material.patterns.cobbles import cobbles
from basrelief.material.patterns.cracks import cracks
from basrelief.material.patterns.dust import dust
from basrelief.material.patterns.grass import grass
from basrelief.material.patterns.grating import grating
from basrelief.material.patterns.gravel import gravel
from basrelief.material.patterns.grid import grid
from basrelief.material.patterns.noise import noise
from basrelief.material.patterns.stone import stone
from basrelief.material.patterns.terrain import terrain
from basrelief.material.patterns.tiles import tiles

__all__ = ["PATTERNS", "Canvas", "Relief"]

PATTERNS: dict[str, Callable[[Canvas], Relief]] = {
    "bricks": bricks,
    "cobbles": cobbles,
    "gravel": gravel,
    "tiles": tiles,
    "terrain": terrain,
    "circuit": circuit,
    "grating": grating,
    "grid": grid,
    "noise": noise,
    "grass": grass,
    "stone": stone,
    "cracks": cracks,
    "dust": dust,
}
"""All patterns by name."""
