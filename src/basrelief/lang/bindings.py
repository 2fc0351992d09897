"""Resource bindings of a program on a GPU, formats of maps, and the size of workgroups.

The WGSL printer, the GPU engine and pages share this description; `layout.py` describes the content
of buffers.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

import numpy as np

from basrelief.lang import tree
from basrelief.lang.resources import HeightField, Texture, buffer_record, is_handle

GROUP = (8, 8)
"""Width and height of a workgroup in pixels; among the fastest shapes measured."""

RUN = ("width", "first_row", "last_row", "plane_row", "plane_stride")
"""32-bit words of the binding `run`: width of the picture, the rows that a dispatch computes (the
last one excluded), the row at which the planes begin, and the words from one plane to the next."""


class MapFormat(NamedTuple):
    """Format of a map on a GPU: WebGPU's formats of texels and samples, the type in WGSL, and that
    of the channels in NumPy."""

    texels: str
    texel_bytes: int
    sample_type: str
    wgsl: str
    numpy: type


MAP_FORMATS: dict[type, MapFormat] = {
    HeightField: MapFormat("r32float", 4, "unfilterable-float", "texture_2d<f32>", np.float32),
    Texture: MapFormat("rgba16uint", 8, "uint", "texture_2d<u32>", np.uint16),
}
FILTERED_FORMATS = {
    "r32float": MapFormat("r32float", 4, "float", "texture_2d<f32>", np.float32),
    "r16float": MapFormat("r16float", 2, "float", "texture_2d<f32>", np.float16),
}
"""Formats of heights that `sampled` reads, by name: GPUs filter the first if they have the feature
float32-filterable, and all filter the second."""

_ACCESS = {
    "run": "uniform",
    "planes": "storage",
    "sampler": "non-filtering",
    "uniform": "uniform",
    "buffer": "read-only-storage",
}


@dataclass(frozen=True)
class Binding:
    """Resource binding of group 0; its number is its index in the list.

    `filtered` are the maps that `sampled` reads, and their sampler.
    """

    kind: Literal["run", "planes", "sampler", "uniform", "buffer", "map"]
    name: str
    type: Any = None
    filtered: bool = False

    @property
    def access(self) -> str:
        """WebGPU's type of the buffer or sampler, or the sample type of the map."""
        if self.filtered:
            return "float" if self.kind == "map" else "filtering"
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
    filtered = _sampled_parameters(entry, {})
    result = [
        Binding("run", "run"),
        Binding("planes", "planes"),
        Binding("sampler", "edge_sampler"),
    ]
    if filtered:
        result.append(Binding("sampler", "filter_sampler", filtered=True))
    for name, t in list(entry.parameters.items())[1:]:
        # what the planes hold
        if t is entry.result:
            continue
        kind: Literal["uniform", "buffer", "map"] = "uniform"
        if is_handle(t):
            kind = "map" if buffer_record(t) is None else "buffer"
        result.append(Binding(kind, name, t, filtered=name in filtered))
    return result


def _sampled_parameters(
    function: tree.Function, known: dict[tree.Function, frozenset[str]]
) -> frozenset[str]:
    """The parameters of a function that it, or a function that it calls, passes to `sampled`;
    `known` are those of the functions visited before."""
    if function not in known:
        fields: list[tree.Expression] = []
        # only a function that takes heights can pass them on
        has_heights = HeightField in function.parameters.values()
        for node in tree.expressions(function.body if has_heights else ()):
            match node:
                case tree.IntrinsicCall(name="sampled", arguments=arguments):
                    fields.append(arguments[0])
                case tree.Call(function=called, arguments=arguments):
                    sampled = _sampled_parameters(called, known)
                    pairs = zip(called.parameters, arguments, strict=True)
                    fields += [argument for name, argument in pairs if name in sampled]
        known[function] = frozenset(f.name for f in fields if isinstance(f, tree.Local))
    return known[function]
