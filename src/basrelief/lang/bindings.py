"""Resource bindings of a program on a GPU, formats of maps, and the size of workgroups.

The WGSL printer, the GPU engine and pages share this description; `layout.py` describes the content
of buffers.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

from basrelief.lang import tree
from basrelief.lang.resources import HeightField, Texture, buffer_record, is_handle

GROUP = (8, 8)
"""Width and height of a workgroup in pixels; among the fastest shapes measured."""

RUN = ("width", "first_row", "last_row", "plane_row", "plane_stride")
"""32-bit words of the binding `run`: width of the picture, the rows that a dispatch computes (the
last one excluded), the row at which the planes begin, and the words from one plane to the next."""


class MapFormat(NamedTuple):
    """Format of a map on a GPU: WebGPU's formats of texels and samples, and the type in WGSL."""

    texels: str
    texel_bytes: int
    sample_type: str
    wgsl: str


MAP_FORMATS: dict[type, MapFormat] = {
    HeightField: MapFormat("r32float", 4, "unfilterable-float", "texture_2d<f32>"),
    Texture: MapFormat("rgba16uint", 8, "uint", "texture_2d<u32>"),
}

_ACCESS = {
    "run": "uniform",
    "planes": "storage",
    "sampler": "non-filtering",
    "uniform": "uniform",
    "buffer": "read-only-storage",
}


@dataclass(frozen=True)
class Binding:
    """Resource binding of group 0; its number is its index in the list."""

    kind: Literal["run", "planes", "sampler", "uniform", "buffer", "map"]
    name: str
    type: Any = None

    @property
    def access(self) -> str:
        """WebGPU's type of the buffer or sampler, or the sample type of the map."""
        if self.kind == "map":
            return MAP_FORMATS[self.type].sample_type
        return _ACCESS[self.kind]

    @property
    def variable(self) -> str:
        """Name of the WGSL variable."""
        is_builtin = self.kind in ("run", "planes", "sampler")
        return self.name if is_builtin else f"{self.name}_{self.kind}"


def bindings(entry: tree.Function) -> list[Binding]:
    """Resource bindings of a program with this entry, in order."""
    result = [
        Binding("run", "run"),
        Binding("planes", "planes"),
        Binding("sampler", "edge_sampler"),
    ]
    for name, t in list(entry.parameters.items())[1:]:
        # what the planes hold
        if t is entry.result:
            continue
        kind: Literal["uniform", "buffer", "map"] = "uniform"
        if is_handle(t):
            kind = "map" if buffer_record(t) is None else "buffer"
        result.append(Binding(kind, name, t))
    return result
