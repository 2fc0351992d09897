"""How the view ray runs below the polygon: straight, or bent so that it never runs too far.

Chosen before any technique, single reads and marches alike. Each takes the unit vector to the
viewer in tangent space, and gives how far the ray moves towards the viewer while it falls by one.
"""

from __future__ import annotations

from basrelief.lang import Vec2, Vec3, shader

SHALLOWEST = 1e-5
"""The least V · N that is divided by: a ray along the surface stays finite."""


@shader
def full(view: Vec3, bias: float) -> Vec2:
    """V.xy ÷ V.z, the true ray (T. Kaneko et al., Detailed Shape Representation with Parallax
    Mapping, 2001)."""
    return view.xy / max(view.z, SHALLOWEST)


@shader
def biased(view: Vec3, bias: float) -> Vec2:
    """V.xy ÷ (V.z + bias), the bias 0.42 in Unity's standard shader: flatter, but calmer."""
    return view.xy / max(view.z + bias, SHALLOWEST)


@shader
def limited(view: Vec3, bias: float) -> Vec2:
    """V.xy, never longer than 1 (T. Welsh, Parallax Mapping with Offset Limiting, 2004)."""
    return view.xy
