"""A steel grating with holes: wide and narrow bars, and one brace across them."""

from __future__ import annotations

import numpy as np

from basrelief.material.patterns.canvas import Canvas, Plane, Relief, mix, shade, smoothstep

TILE, DEPTH = 0.3, 0.036
WIDE, NARROW = 3, 4
"""Number of vertical bars, and of the horizontal ones that hold them together."""
HALF_WIDE, HALF_NARROW, HALF_BRACE = 0.048, 0.021, 0.034
"""Half the bars' widths, in widths of the tile: 29, 13 and 20 mm."""
RIVET = 0.024
TOP_WIDE, TOP_NARROW, TOP_BRACE = 1.0, 0.55, 0.78
PAINT, BRACE_PAINT = (0.36, 0.43, 0.41), (0.80, 0.60, 0.16)
STEEL = (0.80, 0.79, 0.77)
RUST, DARK_RUST = (0.47, 0.25, 0.13), (0.27, 0.14, 0.09)


def grating(canvas: Canvas) -> Relief:
    """30 cm of painted floor grating, bare where worn, 36 mm from the holes to the top.

    `opacity` is 0 in the holes and 1 on the bars. Heights are 0 exactly in the holes.
    """
    bars = _Bars(canvas)
    grain = canvas.noise("grain", 128, octaves=2)
    patches = canvas.noise("patches", 5, octaves=5, gain=0.65)
    rust = smoothstep(0.55, 1.15, patches + 0.25 * grain)
    bare = smoothstep(0.25, 0.7, bars.crown + 0.12 * patches + 0.10 * grain) * (1 - rust)
    height = bars.height - 0.010 * np.maximum(0.6 * bare, rust * (1 + 0.5 * grain))
    height = np.where(bars.solid, np.maximum(height, 0.2), 0).astype(np.float32)

    dirt = 1 - 0.16 * smoothstep(-0.6, 1.2, canvas.noise("dirt", 9, octaves=4))
    color = shade(mix(PAINT, BRACE_PAINT, bars.is_brace), dirt + 0.03 * grain)
    color = mix(color, shade(mix(STEEL, STEEL, bare), 1 + 0.04 * grain), bare)
    oxide = shade(mix(RUST, DARK_RUST, smoothstep(-0.5, 1.2, grain)), 1 + 0.10 * patches)
    color = mix(color, oxide, rust)
    color = shade(color, 0.45 + 0.55 * smoothstep(0.1, 0.55, bars.height))
    roughness = mix(mix(0.55 + 0.04 * grain, 0.30, bare), 0.93, rust)
    opacity = bars.solid.astype(np.float32)
    return Relief(height, color, roughness, DEPTH, TILE, 0.9 * bare, opacity)


class _Bars:
    """The topmost bar at each texel: height, wear, and whether it is the brace."""

    def __init__(self, canvas: Canvas) -> None:
        random = canvas.random("place")
        shift_x, shift_y, shift = random.uniform(0, 1, 3).astype(np.float32)
        shape = (canvas.height, canvas.width)
        self.height = np.zeros(shape, np.float32)
        self.crown = np.zeros(shape, np.float32)
        self.is_brace = np.zeros(shape, np.float32)
        self.solid = np.zeros(shape, bool)
        self.bevel = canvas.softness(0.006)
        down = canvas.rows(NARROW)
        x = _to_nearest(canvas.x * WIDE + shift_x) / np.float32(WIDE)
        pitch = np.float32(canvas.aspect / down)
        y = _to_nearest(canvas.y / pitch + shift_y) * pitch
        self._draw_bar(HALF_NARROW - np.abs(y), TOP_NARROW, HALF_NARROW)  # round
        # offset right of the brace's centre line, which falls by the tile's height over its width
        right = _to_nearest(canvas.x - canvas.y / np.float32(canvas.aspect) + shift)
        across = np.abs(right) * np.float32(canvas.aspect / np.hypot(canvas.aspect, 1))
        before = self.height
        self._draw_bar(HALF_BRACE - across, TOP_BRACE, self.bevel)
        self.is_brace = (self.height > before).astype(np.float32)
        self._draw_bar(HALF_WIDE - np.abs(x), TOP_WIDE, self.bevel)
        self.is_brace *= np.abs(x) >= HALF_WIDE
        self._rivet(x, (x - right) * np.float32(canvas.aspect))

    def _draw_bar(self, inside: Plane, top: float, bevel: float) -> None:
        """Draw a bar over the others; `inside` is the distance from its edge, positive within."""
        edge = np.clip(inside / np.float32(bevel), 0, 1)
        rounded = np.float32(top) * (0.72 + 0.28 * np.sqrt(1 - (1 - edge) ** 2))
        on_top = (inside > 0) & (rounded > self.height)
        self.height = np.where(on_top, rounded, self.height).astype(np.float32)
        worn = smoothstep(2.2 * self.bevel, 0.3 * self.bevel, inside) * np.float32(top)
        self.crown = np.where(on_top, worn, self.crown).astype(np.float32)
        self.solid |= np.broadcast_to(inside > 0, self.solid.shape)

    def _rivet(self, x: Plane, y: Plane) -> None:
        """Draw a round head where the brace passes under a wide bar, at offset (x, y)."""
        distance = np.hypot(x, y)
        dome = np.sqrt(np.clip(1 - (distance / np.float32(RIVET)) ** 2, 0, 1))
        head = distance < RIVET
        groove = smoothstep(1.3 * RIVET, RIVET, distance) * (np.abs(x) < HALF_WIDE)
        height = np.where(head, 0.85 + 0.15 * dome, self.height - 0.08 * groove)
        self.height = height.astype(np.float32)
        self.crown = np.where(head, dome, self.crown).astype(np.float32)


def _to_nearest(values: Plane) -> Plane:
    """Signed distance from the nearest integer."""
    distance: Plane = (values - np.round(values)).astype(np.float32)
    return distance
