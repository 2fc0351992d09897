"""BRDFs: how much of the light that arrives at a point is reflected to the viewer.

Colours are linear Rec. 709. Direction vectors are of unit length and point away from the surface.
"""

from __future__ import annotations

from basrelief.lang import (
    Vec3,
    cross,
    dot,
    mix,
    normalize,
    pow,
    reflect,
    saturate,
    setting,
    shader,
    sqrt,
    struct,
)
from basrelief.shading.lights import Incoming
from basrelief.shading.variant import Variant

SMOOTHEST = 0.045
"""The least roughness: its fourth power is still clear of float32's rounding of 1 (R. Guy and
M. Agopian, Physically Based Rendering in Filament, 2018)."""
EDGE_ON = 1e-4
"""The least cosine between normal and view: a bent normal may well face away from the viewer."""
DIELECTRIC = 0.04
"""What a dielectric reflects head-on: an index of refraction of 1.5 (glTF 2.0)."""
PI = 3.14159265358979
OPPOSITE = 1e-6
"""The squared length of light + view below which the two count as opposite."""


@struct
class ShadingPoint:
    """A point of a surface, ready to be lit.

    `normal` is the shading normal, `view` points to the viewer, both unit. `base_color`,
    `roughness` (perceptual), `metallic` and `occlusion` (1 where nothing occludes) are 0 to 1, as
    in glTF 2.0; `emission` is the radiance the point sends out by itself.
    """

    position: Vec3
    normal: Vec3
    view: Vec3
    base_color: Vec3
    roughness: float
    metallic: float
    occlusion: float
    emission: Vec3


@struct
class Shading:
    """The numbers of the lighting that a user turns."""

    ambient: Vec3 = setting(default=Vec3(0.1), doc="light from everywhere, linear colour", low=0.0)
    diffuse: float = setting(
        default=1.0, doc="share of the base colour in Phong's diffuse term", low=0.0
    )
    specular: Vec3 = setting(default=Vec3(1.0), doc="colour of Phong's highlight, linear", low=0.0)
    shininess: float = setting(
        default=10.0, doc="exponent of Phong's highlight", low=1.0, high=1000.0
    )
    directional_occlusion: float = setting(
        default=1.0,
        doc="how much occlusion acts on lights, where it has a direction",
        low=0.0,
        high=1.0,
    )


@shader
def ambient_light(point: ShadingPoint, shading: Shading) -> Vec3:
    """Ambient light · base colour · occlusion.

    The same for a metal: it has no diffuse term, but mirrors its surroundings in its base colour.
    """
    return shading.ambient * point.base_color * point.occlusion


# --- light reflected -------------------------------------------------------------------------


@shader
def reflectance(
    point: ShadingPoint, shading: Shading, incoming: Incoming, variant: Variant
) -> Vec3:
    """The radiance that the point sends to the viewer for one light, the cosine included."""
    if variant.shading_model == "phong":
        return phong(point, shading, incoming)
    return ggx(point, shading, incoming)


@shader
def phong(point: ShadingPoint, shading: Shading, incoming: Incoming) -> Vec3:
    """B. T. Phong, Illumination for Computer Generated Pictures, 1975, after wikibooks.

    Diffuse: the base colour · n·l; specular: the reflected light's cosine with the view, to the
    power of the shininess, not scaled by n·l. Neither from a light behind the surface. Takes no
    notice of roughness and metallic.
    """
    facing = dot(point.normal, incoming.direction)
    if facing <= 0.0:
        return Vec3(0.0)
    mirrored = reflect(-incoming.direction, point.normal)
    highlight = pow(max(dot(mirrored, point.view), 0.0), shading.shininess)
    diffuse = point.base_color * (shading.diffuse * facing)
    return incoming.radiance * (diffuse + shading.specular * highlight)


@shader
def ggx(point: ShadingPoint, shading: Shading, incoming: Incoming) -> Vec3:
    """Metallic-roughness as in glTF 2.0, appendix B, with π · the reflectance function.

    Masking and shadowing are correlated by height, where the appendix has them independent.
    Lights' radiance counts π-fold, so that a white diffuse surface facing a directional light of
    colour 1 comes out as 1 (less what the Fresnel term takes for the highlight): Lambert's term
    is the base colour itself. Takes no notice of `shading`: the material's maps say it all.
    """
    facing = dot(point.normal, incoming.direction)
    if facing <= 0.0:
        return Vec3(0.0)
    seen = max(dot(point.normal, point.view), EDGE_ON)
    halfway = halfway_between(incoming.direction, point.view, point.normal)
    held = max(point.roughness, SMOOTHEST)
    alpha = held * held
    head_on = mix(Vec3(DIELECTRIC), point.base_color, point.metallic)
    fresnel = schlick_fresnel(head_on, saturate(dot(point.view, halfway)))
    microfacets = trowbridge_reitz(point.normal, halfway, alpha) * smith(facing, seen, alpha)
    diffuse = point.base_color * (1.0 - point.metallic) * (1.0 - fresnel)
    return incoming.radiance * (diffuse + fresnel * (microfacets * PI)) * facing


@shader
def halfway_between(light: Vec3, view: Vec3, normal: Vec3) -> Vec3:
    """The unit vector between two; the normal where they are opposite."""
    total = light + view
    if dot(total, total) > OPPOSITE:
        return normalize(total)
    return normal


@shader
def trowbridge_reitz(normal: Vec3, halfway: Vec3, alpha: float) -> float:
    """The density of microfacets that face halfway, alpha the squared roughness.

    T. S. Trowbridge and K. P. Reitz, Average Irregularity Representation of a Rough Surface for
    Ray Reflection, 1975. Facets that face into the surface do not count.
    """
    cosine = saturate(dot(normal, halfway))
    across = cross(normal, halfway)
    squared = alpha * alpha
    # 1 − cosine² as |n × h|², which does not cancel near the highlight
    spread = cosine * cosine * squared + dot(across, across)
    return squared / (PI * spread * spread)


@shader
def smith(facing: float, seen: float, alpha: float) -> float:
    """Height-correlated masking and shadowing ÷ (4 · n·l · n·v).

    E. Heitz, Understanding the Masking-Shadowing Function in Microfacet-Based BRDFs, 2014.
    """
    squared = alpha * alpha
    light = seen * sqrt(facing * facing * (1.0 - squared) + squared)
    view = facing * sqrt(seen * seen * (1.0 - squared) + squared)
    return 0.5 / (light + view)


@shader
def schlick_fresnel(head_on: Vec3, cosine: float) -> Vec3:
    """What is reflected at an angle, given what is reflected head-on.

    C. Schlick, An Inexpensive BRDF Model for Physically-based Rendering, 1994.
    """
    rest = 1.0 - cosine
    squared = rest * rest
    return head_on + (1.0 - head_on) * (squared * squared * rest)
