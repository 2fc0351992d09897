"""Projections: the direction of the ray below the polygon, true or limited in length.

A projection is applied before any technique, single reads and marches alike. Each takes the unit
vector V to the viewer in tangent space and returns the offset of the ray along the surface, towards
the viewer, per unit of height.
"""

from __future__ import annotations

from basrelief.lang import Vec2, Vec3, shader

MIN_COSINE = 1e-5
"""Lower limit of V · N in divisions: the offset of a grazing ray stays finite."""


@shader
def full(view: Vec3, bias: float) -> Vec2:
    """V.xy ÷ V.z: the true ray.

    T. Kaneko et al., Detailed Shape Representation with Parallax Mapping, 2001.
    """
    return view.xy / max(view.z, MIN_COSINE)


@shader
def biased(view: Vec3, bias: float) -> Vec2:
    """V.xy ÷ (V.z + bias): flatter than the true ray, with shorter offsets at grazing angles.

    Unity's standard shader has a bias of 0.42. A bias below 0 lengthens the offsets; where
    V.z + bias would be 0 or less they are as long as those of a grazing ray, not reversed.
    """
    return view.xy / max(view.z + bias, MIN_COSINE)


@shader
def limited(view: Vec3, bias: float) -> Vec2:
    """V.xy: at most 1 long, offset limiting.

    T. Welsh, Parallax Mapping with Offset Limiting, 2004.
    """
    return view.xy
