"""Every technique, one file a family. Add one: write it in a file here and name it below."""

from __future__ import annotations

from basrelief.shaders.ray import Hit, Ray, at
from basrelief.shaders.techniques.march import parallax_occlusion, relief, steep
from basrelief.shaders.techniques.offset import flat, offset, offset_limited
from basrelief.shaders.techniques.technique import Nothing, Technique, displace, technique

__all__ = [
    "TECHNIQUES", "Hit", "Nothing", "Ray", "Technique", "at", "displace", "flat", "offset",
    "offset_limited", "parallax_occlusion", "relief", "steep", "technique",
]  # fmt: skip

TECHNIQUES: dict[str, Technique[..., Hit]] = {
    made.name: made for made in (flat, offset, offset_limited, steep, parallax_occlusion, relief)
}
"""The techniques by name, from the cheapest on."""
