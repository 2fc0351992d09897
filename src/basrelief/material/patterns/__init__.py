"""Procedural patterns: each draws height, colour and roughness on a periodic canvas."""

from __future__ import annotations

from collections.abc import Callable

from basrelief.material.patterns.bricks import bricks
from basrelief.material.patterns.canvas import Canvas, Relief

PATTERNS: dict[str, Callable[[Canvas], Relief]] = {
    "bricks": bricks,
}
"""All patterns by name."""
