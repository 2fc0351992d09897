"""BRDFs: the light that a point reflects to the viewer.

Colours are linear Rec. 709. Direction vectors have unit length and point away from the surface.
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
from basrelief.shading.lights import IncidentLight
from basrelief.shading.variant import Variant

MIN_ROUGHNESS = 0.045
"""The lower limit of roughness: float32 still resolves its fourth power next to 1 (R. Guy and
M. Agopian, Physically Based Rendering in Filament, 2018)."""
MIN_N_DOT_V = 1e-4
"""The lower limit of n·v: a normal from a map may face away from the viewer."""
DIELECTRIC_F0 = 0.04
"""Reflectance of a dielectric at normal incidence: an index of refraction of 1.5 (glTF 2.0)."""
PI = 3.14159265358979
MIN_HALF_SQUARED = 1e-6
"""The squared length of light + view below which the two count as opposite."""


@struct
class ShadingPoint:
    """A surface point, ready for lighting.

    `normal` is the shading normal and `view` points to the viewer, both unit. `base_color`,
    `roughness` (perceptual), `metallic` and `occlusion` (1 is unoccluded) are 0 to 1, as in
    glTF 2.0; `emission` is the emitted radiance. `specular` and `shininess` are the linear colour
    and the exponent of Phong's highlight.
    """

    position: Vec3
    normal: Vec3
    view: Vec3
    base_color: Vec3
    roughness: float
    metallic: float
    occlusion: float
    emission: Vec3
    specular: Vec3
    shininess: float


@struct
class Shading:
    """Settings of the lighting.

    Attributes
    ----------
    ambient : Vec3
        Linear colour of the ambient light.
    diffuse : float
        Factor of the base colour in Phong's diffuse term.
    directional_occlusion : float
        Strength of the directional occlusion of lights, 0 to 1.
    """

    ambient: Vec3 = setting(default=Vec3(0.1), low=0.0)
    diffuse: float = setting(default=1.0, low=0.0)
    directional_occlusion: float = setting(default=1.0, low=0.0, high=1.0)


@shader
def ambient_light(point: ShadingPoint, shading: Shading) -> Vec3:
    """Ambient light · base colour · occlusion.

    The same for a metal: it has no diffuse term, but reflects its surroundings in its base colour.
    """
    return shading.ambient * point.base_color * point.occlusion


# --- reflected light -------------------------------------------------------------------------


@shader
def reflectance(
    point: ShadingPoint, shading: Shading, incident: IncidentLight, variant: Variant
) -> Vec3:
    """The radiance reflected to the viewer from one light, n·l included."""
    if variant.shading_model == "phong":
        return phong(point, shading, incident)
    return ggx(point, incident)


@shader
def phong(point: ShadingPoint, shading: Shading, incident: IncidentLight) -> Vec3:
    """Phong reflection, without roughness and metallic.

    Diffuse: base colour · n·l. Specular: (r·v) to the power of the shininess, r the mirrored light
    direction, not scaled by n·l. Both are 0 for a light behind the surface.
    B. T. Phong, Illumination for Computer Generated Pictures, 1975, after wikibooks.
    """
    n_dot_l = dot(point.normal, incident.direction)
    if n_dot_l <= 0.0:
        return Vec3(0.0)
    mirrored = reflect(-incident.direction, point.normal)
    highlight = pow(max(dot(mirrored, point.view), 0.0), point.shininess)
    diffuse = point.base_color * (shading.diffuse * n_dot_l)
    return incident.radiance * (diffuse + point.specular * highlight)


@shader
def ggx(point: ShadingPoint, incident: IncidentLight) -> Vec3:
    """Metallic-roughness BRDF of glTF 2.0, appendix B, times π.

        π · f · n·l = (c_diff (1 − F) + π F · D · V) · n·l

    Masking and shadowing are height-correlated, where the appendix has them independent. The factor
    π makes a white diffuse surface that faces a directional light of colour 1 come out as 1, less
    the Fresnel term's share for the highlight. The material's maps hold all.
    """
    n_dot_l = dot(point.normal, incident.direction)
    if n_dot_l <= 0.0:
        return Vec3(0.0)
    n_dot_v = max(dot(point.normal, point.view), MIN_N_DOT_V)
    half = half_vector(incident.direction, point.view, point.normal)
    roughness = max(point.roughness, MIN_ROUGHNESS)
    alpha = roughness * roughness
    f0 = mix(Vec3(DIELECTRIC_F0), point.base_color, point.metallic)
    fresnel = schlick_fresnel(f0, saturate(dot(point.view, half)))
    microfacets = trowbridge_reitz(point.normal, half, alpha) * smith(n_dot_l, n_dot_v, alpha)
    diffuse = point.base_color * (1.0 - point.metallic) * (1.0 - fresnel)
    return incident.radiance * (diffuse + fresnel * (microfacets * PI)) * n_dot_l


@shader
def half_vector(light: Vec3, view: Vec3, normal: Vec3) -> Vec3:
    """The unit vector halfway between light and view; the normal where they are opposite."""
    total = light + view
    if dot(total, total) > MIN_HALF_SQUARED:
        return normalize(total)
    return normal


@shader
def trowbridge_reitz(normal: Vec3, half: Vec3, alpha: float) -> float:
    """The microfacet distribution D of GGX, alpha the squared roughness.

    D = α² ÷ (π ((n·h)² (α² − 1) + 1)²), 0 for facets that face into the surface.
    T. S. Trowbridge and K. P. Reitz, Average Irregularity Representation of a Rough Surface for
    Ray Reflection, 1975.
    """
    n_dot_h = saturate(dot(normal, half))
    across = cross(normal, half)
    alpha_squared = alpha * alpha
    # 1 − (n·h)² as |n × h|², which does not cancel near the highlight
    spread = n_dot_h * n_dot_h * alpha_squared + dot(across, across)
    return alpha_squared / (PI * spread * spread)


@shader
def smith(n_dot_l: float, n_dot_v: float, alpha: float) -> float:
    """The visibility term V: height-correlated Smith masking and shadowing ÷ (4 · n·l · n·v).

    E. Heitz, Understanding the Masking-Shadowing Function in Microfacet-Based BRDFs, 2014.
    """
    alpha_squared = alpha * alpha
    light = n_dot_v * sqrt(n_dot_l * n_dot_l * (1.0 - alpha_squared) + alpha_squared)
    view = n_dot_l * sqrt(n_dot_v * n_dot_v * (1.0 - alpha_squared) + alpha_squared)
    return 0.5 / (light + view)


@shader
def schlick_fresnel(f0: Vec3, cosine: float) -> Vec3:
    """Fresnel reflectance F0 + (1 − F0) (1 − cosine)⁵, F0 that at normal incidence.

    C. Schlick, An Inexpensive BRDF Model for Physically-based Rendering, 1994.
    """
    rest = 1.0 - cosine
    squared = rest * rest
    return f0 + (1.0 - f0) * (squared * squared * rest)
