"""Procedural patterns: each draws height, colour and roughness on a periodic canvas."""

from __future__ import annotations

from collections.abc import Callable

from basrelief.material.patterns.bricks import bricks
from basrelief.material.patterns.canvas import Canvas, Relief
from basrelief.material.patterns.cobbles import cobbles
from basrelief.material.patterns.gravel import gravel
from basrelief.material.patterns.terrain import terrain
from basrelief.material.patterns.tiles import tiles

__all__ = ["PATTERNS", "Canvas", "Relief"]

PATTERNS: dict[str, Callable[[Canvas], Relief]] = {
    "bricks": bricks,
    "cobbles": cobbles,
    "gravel": gravel,
    "tiles": tiles,
    "terrain": terrain,
}
"""All patterns by name."""
