"""A circuit board: plateaus, traces, pads and cans at a few heights, with hard edges."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from basrelief.material.patterns.canvas import Canvas, Plane, Relief, mix, shade, smoothstep

TILE, DEPTH = 0.06, 0.0036
ACROSS = 26
"""Nodes across the lattice of the layout."""
EDGE = 0.0018
BOARD, TRACE, PAD, DRILLED = 0.36, 0.10, 0.15, 0.30
"""Height of the board; heights of traces and pads above it, depth of drill holes."""
TERRACES = ((11, 8, 0.20), (9, 10, -0.20), (6, 5, 0.10), (5, 7, -0.10))
"""Raised and milled-out areas of the board: nodes across and down, and the change of height."""
COMPONENTS = (
    (8, 5, 1.00, "can"),
    (5, 7, 0.80, "chip"),
    (4, 4, 0.92, "can"),
    (7, 3, 0.80, "chip"),
    (2, 4, 0.70, "chip"),
    (3, 2, 0.70, "can"),
    (2, 2, 0.88, "chip"),
)
"""Components: nodes across and down, height of the top, kind."""
STEPS = ((0, 1), (1, 1), (1, 0), (1, -1), (0, -1), (-1, -1), (-1, 0), (-1, 1))
"""The eight directions from node to node, (row, column), in steps of 45°."""
LACQUER, RAISED, MILLED = (0.11, 0.21, 0.25), (0.15, 0.30, 0.32), (0.07, 0.13, 0.17)
COPPER, TIN = (0.83, 0.58, 0.36), (0.78, 0.77, 0.74)
EPOXY, STEEL = (0.13, 0.13, 0.14), (0.62, 0.63, 0.65)


def circuit(canvas: Canvas) -> Relief:
    """6 cm of board, 3.6 mm from the drill holes to the top of the highest can."""
    board = _Board(canvas)
    board.terrace()
    board.place_components()
    board.route()
    fine = canvas.noise("fine", 96, octaves=2)
    smudge = canvas.noise("smudge", 4, octaves=5)
    brushed = canvas.noise("brushed", 160)

    height = board.height + 0.004 * fine
    level = board.level
    color = mix(
        mix(LACQUER, RAISED, smoothstep(0.02, 0.18, level)), MILLED, smoothstep(0, 0.18, -level)
    )
    color = shade(color, 1 + 0.05 * smudge + 0.03 * fine)
    metal = mix(mix(COPPER, TIN, board.tinned), STEEL, board.can)
    metal = shade(metal, 1 + 0.02 * brushed + 0.05 * smudge)
    metallic = np.maximum(board.metal, board.can)
    color = mix(color, metal, metallic)
    color = mix(color, shade(mix(EPOXY, EPOXY, board.chip), 1 + 0.10 * fine), board.chip)
    color = shade(color, 1 - 0.8 * board.drilled)
    matt = mix(0.50, 0.72, board.chip)
    roughness = mix(matt, 0.34 + 0.02 * brushed, metallic) + 0.05 * smudge
    roughness = np.maximum(roughness, 0.1).astype(np.float32)
    return Relief(height, color, roughness, DEPTH, TILE, metallic * (1 - board.drilled))


class _Board:
    """The layout on a periodic lattice, with its planes, (height, width)."""

    def __init__(self, canvas: Canvas) -> None:
        self.canvas = canvas
        self.down = canvas.rows(ACROSS)
        self.occupied = np.zeros((self.down, ACROSS), bool)
        self.random = canvas.random("layout")
        self.soft = canvas.softness(EDGE)
        self.pitch = (canvas.aspect / self.down, 1 / ACROSS)
        shape = (canvas.height, canvas.width)
        self.level, self.metal, self.tinned, self.can, self.chip, self.drilled = np.zeros(
            (6, *shape), np.float32
        )
        self.height = np.full(shape, BOARD, np.float32)

    # --- plateaus

    def terrace(self) -> None:
        """Raise and mill out areas of the board; later ones replace earlier ones."""
        for across, down, height_change in TERRACES:
            texels, coverage = self._box(self._random_node(), across - 0.4, down - 0.4)
            self.level[texels] = mix(self.level[texels], height_change, coverage)
        self.height += self.level

    def place_components(self) -> None:
        """Place each component where there is room, with a gap to the others."""
        for across, down, top, kind in COMPONENTS:
            for _ in range(60):
                row, column = self._random_node()
                rows = (row + np.arange(-1, down + 1)) % self.down
                columns = (column + np.arange(-1, across + 1)) % ACROSS
                if down + 2 > self.down or self.occupied[np.ix_(rows, columns)].any():
                    continue
                self.occupied[np.ix_(rows[1:-1], columns[1:-1])] = True
                self._place_component((row, column), across, down, top, kind)
                break

    def _place_component(
        self, node: tuple[int, int], across: int, down: int, top: float, kind: str
    ) -> None:
        middle = (node[0] + (down - 1) / 2, node[1] + (across - 1) / 2)
        texels, coverage = self._box(middle, across - 0.45, down - 0.45)
        self.height[texels] = mix(self.height[texels], top, coverage)
        plane = self.can if kind == "can" else self.chip
        plane[texels] = np.maximum(plane[texels], coverage)
        self.metal[texels] *= 1 - coverage
        if kind == "can":  # a lid, sunk or raised, a little off centre
            texels, coverage = self._box((middle[0] + 0.2, middle[1]), across - 1.5, down - 1.6)
            self.height[texels] -= 0.12 * coverage
        else:  # the mark of the first pin
            texels, distance = self._disc(node, off=(0.45, 0.45))
            coverage = smoothstep(0.010, 0.010 - self.soft, distance)
            self.height[texels] -= 0.06 * coverage

    # --- traces

    def route(self) -> None:
        """Draw traces from node to node, turning by at most 45° and never crossing."""
        free = np.argwhere(~self.occupied)
        self.random.shuffle(free)
        for row, column in free:
            if not self.occupied[row, column]:
                self._trace((int(row), int(column)))

    def _trace(self, start: tuple[int, int]) -> None:
        direction = int(self.random.choice([0, 2, 4, 6, 1, 3], p=[0.3, 0.2, 0.2, 0.2, 0.07, 0.03]))
        nodes, node = [start], start
        self.occupied[start] = True
        for _ in range(int(self.random.integers(3, 15))):
            turns = (0, 1, -1) if self.random.random() < 0.8 else (1, -1, 0)
            step = next((t for t in turns if self._is_free(node, STEPS[(direction + t) % 8])), None)
            if step is None:
                break
            direction = (direction + step) % 8
            node = (node[0] + STEPS[direction][0], node[1] + STEPS[direction][1])
            self.occupied[node[0] % self.down, node[1] % ACROSS] = True
            nodes.append(node)
        if len(nodes) == 1:
            if self.random.random() < 0.35:
                self._pad(start, drilled=True)
            return
        width = float(self.random.choice([0.0052, 0.0052, 0.0095]))
        for start_node, end_node in pairwise(nodes):
            self._segment(start_node, end_node, width)
        self._pad(nodes[0], drilled=True)
        self._pad(nodes[-1], drilled=bool(self.random.random() < 0.4))

    def _is_free(self, node: tuple[int, int], step: tuple[int, int]) -> bool:
        def occupied(down: int, right: int) -> bool:
            return bool(self.occupied[(node[0] + down) % self.down, (node[1] + right) % ACROSS])

        diagonal = step[0] != 0 and step[1] != 0
        crossing = diagonal and occupied(step[0], 0) and occupied(0, step[1])
        return not crossing and not occupied(*step)

    def _segment(
        self, start_node: tuple[int, int], end_node: tuple[int, int], width: float
    ) -> None:
        x, y = self._position(start_node)
        to_x, to_y = self._position(end_node)
        window = self.canvas.around(x, y, 1.5 / ACROSS + 2 * width)
        distance = window.to_segment(to_x - x, to_y - y)
        self._add_metal(window.texels, smoothstep(width, width - self.soft, distance), TRACE)

    def _pad(self, node: tuple[int, int], *, drilled: bool) -> None:
        texels, distance = self._disc(node)
        coverage = smoothstep(0.0125, 0.0125 - self.soft, distance)
        self._add_metal(texels, coverage, PAD)
        self.tinned[texels] = np.maximum(self.tinned[texels], coverage)
        if drilled:
            hole = smoothstep(0.0058, 0.0058 - self.soft, distance)
            self.drilled[texels] = np.maximum(self.drilled[texels], hole)
            self.height[texels] = mix(self.height[texels], BOARD - DRILLED, hole)

    def _add_metal(
        self, texels: tuple[np.ndarray, ...], coverage: Plane, height_change: float
    ) -> None:
        """Add metal of a height above the board; over other metal, the higher one wins."""
        up = BOARD + self.level[texels] + np.float32(height_change) * coverage
        self.height[texels] = np.where(
            coverage > 0, np.maximum(self.height[texels], up), self.height[texels]
        )
        self.metal[texels] = np.maximum(self.metal[texels], coverage)

    # --- from the lattice to texels

    def _random_node(self) -> tuple[int, int]:
        return int(self.random.integers(self.down)), int(self.random.integers(ACROSS))

    def _position(self, node: tuple[float, float]) -> tuple[float, float]:
        return (node[1] + 0.5) * self.pitch[1], (node[0] + 0.5) * self.pitch[0]

    def _disc(
        self, node: tuple[int, int], off: tuple[float, float] = (0, 0)
    ) -> tuple[tuple[np.ndarray, ...], Plane]:
        window = self.canvas.around(*self._position((node[0] + off[0], node[1] + off[1])), 0.02)
        return window.texels, np.hypot(window.x, window.y)

    def _box(
        self, middle: tuple[float, float], across: float, down: float
    ) -> tuple[tuple[np.ndarray, ...], Plane]:
        """A box of nodes around a position: its texels, and its coverage of them."""
        half_x, half_y = across / 2 * self.pitch[1], down / 2 * self.pitch[0]
        window = self.canvas.around(*self._position(middle), max(half_x, half_y) + self.soft)
        inside = -window.to_box(half_x, half_y)
        return window.texels, smoothstep(0, self.soft, inside)
