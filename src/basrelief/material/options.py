"""The maps of a material, and the options of reading them.

The command line's help imports this module, so it imports little.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, NamedTuple, TypeGuard

from basrelief.settings import check_choices, setting

NormalConvention = Literal["auto", "gl", "dx"]
HeightPolarity = Literal["auto", "height", "depth"]
HeightChannel = Literal["auto", "r", "g", "b", "a", "luminance", "a_or_r"]
Packing = Literal["rgb", "ag", "rg", "ag_or_rgb"]


class MapKind(NamedTuple):
    """A map of a material: its number of channels, and its meaning."""

    channels: int
    doc: str


MAPS = {
    "base_color": MapKind(3, "base colour map, with opacity in its alpha"),
    "normal": MapKind(3, "normal map"),
    "height": MapKind(1, "height map"),
    "occlusion": MapKind(1, "ambient occlusion map"),
    "roughness": MapKind(1, "roughness map"),
    "metallic": MapKind(1, "metallic map"),
    "emission": MapKind(3, "emission map"),
    "opacity": MapKind(1, "opacity map"),
    "layer_mask": MapKind(1, "mask of the second layer"),
    "dust": MapKind(1, "dust map, by which a hole opens"),
}
"""The maps of a material."""
SAMPLE = "sample:"
"""Prefix of the name of a procedural sample."""


def number_in_place_of_map(text: str) -> float | None:
    """The number that stands for a map with one value everywhere; None for files and samples."""
    try:
        return float(text)
    except ValueError:
        return None


def is_path(source: str | float) -> TypeGuard[str]:
    """Whether the source of a map is a file or folder, not a sample or a number."""
    return (
        isinstance(source, str)
        and not source.startswith(SAMPLE)
        and number_in_place_of_map(source) is None
    )


@dataclass(frozen=True)
class ReadOptions:
    """Options of `load` for what file names leave open.

    Attributes
    ----------
    normal_convention : {"auto", "gl", "dx"}
        Green of normal maps: up (gl), down (dx), or found from the file name and the heights.
    normal_packing : {"rgb", "ag", "rg", "ag_or_rgb"}
        Channels of normals.
    height_polarity : {"auto", "height", "depth"}
        White of height maps: high, deep, or found from the file name and the normals.
    height_channel : {"auto", "r", "g", "b", "a", "luminance", "a_or_r"}
        Channel of the heights.
    stretch_height : bool
        Stretch heights that use a part of their range to 0 to 1.
    """

    normal_convention: NormalConvention = setting(default="auto", group="Maps")
    normal_packing: Packing = setting(default="rgb", group="Maps")
    height_polarity: HeightPolarity = setting(default="auto", group="Maps")
    height_channel: HeightChannel = setting(default="auto", group="Maps")
    stretch_height: bool = setting(default=False, group="Maps")

    def __post_init__(self) -> None:
        check_choices(self)


@dataclass(frozen=True)
class Lengths:
    """Real sizes of a material, from which the scale of its relief follows.

    Attributes
    ----------
    depth : float
        Full height range in metres, above 0.
    tile : float
        Width of a tile in metres, above 0.
    """

    depth: float | None = setting(default=None, group="Maps")
    tile: float | None = setting(default=None, group="Maps")
