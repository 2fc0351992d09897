"""A circuit board of our own: plateaus, traces, pads and cans at a few heights, all edges hard."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from basrelief.material.patterns.canvas import Canvas, Plane, Relief, mix, shade, smoothstep

TILE, DEPTH = 0.06, 0.0036
ACROSS = 26
"""Nodes of the lattice that everything is laid out on."""
EDGE = 0.0018
BOARD, TRACE, PAD, DRILLED = 0.36, 0.10, 0.15, 0.30
"""The board's height; how high traces and pads stand on it, how deep the drill went."""
TERRACES = ((11, 8, 0.20), (9, 10, -0.20), (6, 5, 0.10), (5, 7, -0.10))
"""Parts of the board that are raised or milled out: nodes across and down, and by how much."""
PARTS = (
    (8, 5, 1.00, "can"),
    (5, 7, 0.80, "chip"),
    (4, 4, 0.92, "can"),
    (7, 3, 0.80, "chip"),
    (2, 4, 0.70, "chip"),
    (3, 2, 0.70, "can"),
    (2, 2, 0.88, "chip"),
)
"""What stands on the board: nodes across and down, the height of its top, of what kind."""
STEPS = ((0, 1), (1, 1), (1, 0), (1, -1), (0, -1), (-1, -1), (-1, 0), (-1, 1))
"""The eight ways from node to node, (row, column), each an eighth of a turn on."""
LACQUER, RAISED, MILLED = (0.11, 0.21, 0.25), (0.15, 0.30, 0.32), (0.07, 0.13, 0.17)
COPPER, TIN = (0.83, 0.58, 0.36), (0.78, 0.77, 0.74)
EPOXY, STEEL = (0.13, 0.13, 0.14), (0.62, 0.63, 0.65)


def circuit(canvas: Canvas) -> Relief:
    """6 cm of board, 3.6 mm from the drill holes to the top of the highest can."""
    board = _Board(canvas)
    board.terrace()
    board.place_parts()
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
    """The layout on a periodic lattice, drawn as it grows: each plane (height, width)."""

    def __init__(self, canvas: Canvas) -> None:
        self.canvas = canvas
        self.down = canvas.rows(ACROSS)
        self.taken = np.zeros((self.down, ACROSS), bool)
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
        """Raise and mill out parts of the board; where two meet the later one counts."""
        for across, down, by in TERRACES:
            there, share = self._box(self._anywhere(), across - 0.4, down - 0.4)
            self.level[there] = mix(self.level[there], by, share)
        self.height += self.level

    def place_parts(self) -> None:
        """Put each part where there is room, and none too close to another."""
        for across, down, top, kind in PARTS:
            for _ in range(60):
                row, column = self._anywhere()
                rows = (row + np.arange(-1, down + 1)) % self.down
                columns = (column + np.arange(-1, across + 1)) % ACROSS
                if down + 2 > self.down or self.taken[np.ix_(rows, columns)].any():
                    continue
                self.taken[np.ix_(rows[1:-1], columns[1:-1])] = True
                self._part((row, column), across, down, top, kind)
                break

    def _part(self, node: tuple[int, int], across: int, down: int, top: float, kind: str) -> None:
        middle = (node[0] + (down - 1) / 2, node[1] + (across - 1) / 2)
        there, share = self._box(middle, across - 0.45, down - 0.45)
        self.height[there] = mix(self.height[there], top, share)
        plane = self.can if kind == "can" else self.chip
        plane[there] = np.maximum(plane[there], share)
        self.metal[there] *= 1 - share
        if kind == "can":  # a lid, sunk or raised, a little off the middle
            there, share = self._box((middle[0] + 0.2, middle[1]), across - 1.5, down - 1.6)
            self.height[there] -= 0.12 * share
        else:  # the mark of the first pin
            there, away = self._disc(node, off=(0.45, 0.45))
            share = smoothstep(0.010, 0.010 - self.soft, away)
            self.height[there] -= 0.06 * share

    # --- traces

    def route(self) -> None:
        """Traces from node to node, straight on or an eighth of a turn, never through another."""
        free = np.argwhere(~self.taken)
        self.random.shuffle(free)
        for row, column in free:
            if not self.taken[row, column]:
                self._trace((int(row), int(column)))

    def _trace(self, start: tuple[int, int]) -> None:
        way = int(self.random.choice([0, 2, 4, 6, 1, 3], p=[0.3, 0.2, 0.2, 0.2, 0.07, 0.03]))
        nodes, node = [start], start
        self.taken[start] = True
        for _ in range(int(self.random.integers(3, 15))):
            turns = (0, 1, -1) if self.random.random() < 0.8 else (1, -1, 0)
            step = next((t for t in turns if self._is_free(node, STEPS[(way + t) % 8])), None)
            if step is None:
                break
            way = (way + step) % 8
            node = (node[0] + STEPS[way][0], node[1] + STEPS[way][1])
            self.taken[node[0] % self.down, node[1] % ACROSS] = True
            nodes.append(node)
        if len(nodes) == 1:
            if self.random.random() < 0.35:
                self._pad(start, drilled=True)
            return
        width = float(self.random.choice([0.0052, 0.0052, 0.0095]))
        for one, other in pairwise(nodes):
            self._segment(one, other, width)
        self._pad(nodes[0], drilled=True)
        self._pad(nodes[-1], drilled=bool(self.random.random() < 0.4))

    def _is_free(self, node: tuple[int, int], step: tuple[int, int]) -> bool:
        def taken(down: int, right: int) -> bool:
            return bool(self.taken[(node[0] + down) % self.down, (node[1] + right) % ACROSS])

        slanted = step[0] != 0 and step[1] != 0
        crossing = slanted and taken(step[0], 0) and taken(0, step[1])
        return not crossing and not taken(*step)

    def _segment(self, one: tuple[int, int], other: tuple[int, int], width: float) -> None:
        x, y = self._place(one)
        to_x, to_y = self._place(other)
        window = self.canvas.around(x, y, 1.5 / ACROSS + 2 * width)
        away = window.to_segment(to_x - x, to_y - y)
        self._stand(window.there, smoothstep(width, width - self.soft, away), TRACE)

    def _pad(self, node: tuple[int, int], *, drilled: bool) -> None:
        there, away = self._disc(node)
        share = smoothstep(0.0125, 0.0125 - self.soft, away)
        self._stand(there, share, PAD)
        self.tinned[there] = np.maximum(self.tinned[there], share)
        if drilled:
            hole = smoothstep(0.0058, 0.0058 - self.soft, away)
            self.drilled[there] = np.maximum(self.drilled[there], hole)
            self.height[there] = mix(self.height[there], BOARD - DRILLED, hole)

    def _stand(self, there: tuple[np.ndarray, ...], share: Plane, by: float) -> None:
        """Metal on the board, `by` high; over other metal the higher counts."""
        up = BOARD + self.level[there] + np.float32(by) * share
        self.height[there] = np.where(
            share > 0, np.maximum(self.height[there], up), self.height[there]
        )
        self.metal[there] = np.maximum(self.metal[there], share)

    # --- from the lattice to texels

    def _anywhere(self) -> tuple[int, int]:
        return int(self.random.integers(self.down)), int(self.random.integers(ACROSS))

    def _place(self, node: tuple[float, float]) -> tuple[float, float]:
        return (node[1] + 0.5) * self.pitch[1], (node[0] + 0.5) * self.pitch[0]

    def _disc(
        self, node: tuple[int, int], off: tuple[float, float] = (0, 0)
    ) -> tuple[tuple[np.ndarray, ...], Plane]:
        window = self.canvas.around(*self._place((node[0] + off[0], node[1] + off[1])), 0.02)
        return window.there, np.hypot(window.x, window.y)

    def _box(
        self, middle: tuple[float, float], across: float, down: float
    ) -> tuple[tuple[np.ndarray, ...], Plane]:
        """A box of so many nodes around a place: where it is drawn, and its share there."""
        half_x, half_y = across / 2 * self.pitch[1], down / 2 * self.pitch[0]
        window = self.canvas.around(*self._place(middle), max(half_x, half_y) + self.soft)
        inside = -window.to_box(half_x, half_y)
        return window.there, smoothstep(0, self.soft, inside)
