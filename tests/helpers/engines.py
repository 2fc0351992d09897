"""An engine that records its runs, to show which engine computes a result."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from basrelief.engine import Canvas, Planes
from basrelief.engine.cpu import CpuEngine
from basrelief.lang import Shader
from basrelief.lang.program import Program


class RecordingEngine:
    """A CPU engine under another name that records entries and texels of its runs.

    It is a separate instance: runs on `choose_device("cpu")` are not recorded.
    """

    adapter = "a recording engine"

    def __init__(self, name: str = "recording", rounding: str = "recording") -> None:
        self.name, self.rounding = name, rounding
        self.entries: list[Shader[..., Any]] = []
        self.texels: list[int] = []
        self._cpu = CpuEngine()

    def compile(self, program: Program) -> None:
        """Make the program ready."""
        self._cpu.compile(program)

    def run(
        self,
        program: Program,
        values: Mapping[str, Any],
        size: tuple[int, int],
        rows: tuple[int, int] | None = None,
    ) -> Planes:
        """Record the program and run it."""
        first, last = rows or (0, size[1])
        self._record(program, size[0] * (last - first))
        return self._cpu.run(program, values, size, rows)

    def canvas(self, program: Program, size: tuple[int, int]) -> Canvas:
        """Planes of the CPU engine."""
        return self._cpu.canvas(program, size)

    def draw(
        self,
        program: Program,
        values: Mapping[str, Any],
        canvas: Any,
        rows: tuple[int, int] | None = None,
    ) -> None:
        """Record the program and run it over a canvas."""
        first, last = rows or (0, canvas.size[1])
        self._record(program, canvas.size[0] * (last - first))
        self._cpu.draw(program, values, canvas, rows)

    def _record(self, program: Program, texels: int) -> None:
        self.entries.append(program.entry)
        self.texels.append(texels)
