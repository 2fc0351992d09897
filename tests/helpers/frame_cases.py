"""Small named scenes that together cover every technique, shape and option.

A name lists a technique, a shape, and the options that differ from the defaults, as in "relief
sphere clamp hard linear".

- `PLAIN`: every technique on every shape, with no option.
- `DEEP`: the same programs with other numbers: a deep relief, seen and lit at grazing angles.
- `PAIRS`: with the others, every two options of different menus occur together in a case;
  techniques and shapes count as menus.
- `MORE`: single cases.

Compilation takes nearly all of the time: a case that needs no new program is cheap.

Pictures are bit-identical on every processor with IEEE 754 arithmetic. Maps are integer arithmetic.
Cameras, lights and transforms use elementary functions and linear algebra in 64 bits, with results
that are exact or far from the middle between two 32-bit numbers, so that a different last bit is
rounded away.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace
from typing import Any

from basrelief import (
    TECHNIQUES,
    Frame,
    Layer,
    LookAt,
    Object,
    Orbit,
    Scene,
    Tiling,
    directional,
    placed,
    point,
    render,
    rotated,
    spot,
)
from basrelief.scene import SHAPES
from basrelief.techniques import (
    HeightField,
    Hit,
    Ray,
    height_under,
    hit_at,
    setting,
    struct,
    t_at,
    technique,
)
from helpers import exact_maps

SIZE = (33, 21)
"""Width and height of the pictures in pixels."""


# --- a user-defined technique ---------------------------------------------------------------------


@struct
class Guesses:
    """Settings of `own`."""

    guesses: int = setting(default=2, doc="heights read", low=1, high=16)


@technique(reference_height=0.5, most_reads=2)
def own(field: HeightField, ray: Ray, settings: Guesses) -> Hit:
    """Fixed-point iteration: read the height at the point where the ray has the last height."""
    height = ray.reference_height
    for _ in range(settings.guesses):
        height = height_under(field, ray, t_at(ray, height))
    return hit_at(ray, t_at(ray, height), True, settings.guesses)


ALL_TECHNIQUES = {**TECHNIQUES, "own": own}


# --- numbers --------------------------------------------------------------------------------------

SETTINGS = {
    "max_offset": 0.03,
    "steps": 23,
    "min_steps": 5,
    "max_steps": 19,
    "steps_per_texel": 0.75,
    "search_steps": 2,
    "step_length": 0.03,
    "guesses": 3,
}
"""Settings of the techniques, by name; none is at its default."""
SMOOTHING = {"mip_bias": 0.4, "mip_fade": 2.5}
"""Parameters of smooth heights; none is at its default."""
SURFACE_PARAMETERS = {
    "standard": {
        "base_color": (0.9, 0.7, 0.8),
        "normal_strength": 1.4,
        "roughness": 0.6,
        "metallic": 0.5,
        "occlusion": 0.8,
        "emission": (0.5, 0.2, 0.3),
        "cutoff": 0.7,
        "layer_color": 0.6,
        "layer_normal": 1.7,
        "specular": (0.6, 0.7, 0.5),
        "shininess": 21.0,
    },
    "landscape": {
        "water_color": (0.2, 0.5, 0.4),
        "water_level": 0.55,
        "sky_color": (0.7, 0.8, 1.0),
        "base_color": (0.8, 0.9, 0.7),
        "normal_strength": 0.6,
        "roughness": 0.7,
        "metallic": 0.4,
        "occlusion": 0.6,
        "emission": (0.3, 0.4, 0.2),
        "cutoff": 0.6,
        "layer_color": 0.7,
        "layer_normal": 1.6,
        "specular": (0.6, 0.7, 0.5),
        "shininess": 21.0,
    },
}
"""Parameters of the surfaces; none is at its default."""
SCENE_NUMBERS = {
    "shading": {
        "ambient": (0.2, 0.15, 0.1),
        "diffuse": 0.8,
        "directional_occlusion": 0.7,
    },
    "shadowing": {"max_shadow_steps": 9, "light_angle": 25.0, "shadow_offset": 0.06},
    "fog": {
        "fog_color": (0.3, 0.4, 0.2),
        "fog_density": 0.45,
        "fog_start": 1.3,
        "fog_end": 4.1,
    },
}
"""Parameters of scenes; none is at its default."""


# --- options --------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Option:
    """Arguments of the material, the object, the scene and `render`, and further objects."""

    material: dict[str, Any] = field(default_factory=dict)
    object: dict[str, Any] = field(default_factory=dict)
    scene: dict[str, Any] = field(default_factory=dict)
    render: dict[str, Any] = field(default_factory=dict)
    more_objects: Callable[[Object], tuple[Object, ...]] = lambda first: ()


def copy(first: Object) -> tuple[Object, ...]:
    """A smaller copy of the object above it; solid shapes intersect."""
    return (replace(first, transform=placed((0.2, 0.45, 0.1), 0.6) @ first.resolved.transform),)


def floor_and_ball(first: Object) -> tuple[Object, ...]:
    """Objects with other shapes, techniques and maps, behind and in front of the first."""
    plain = replace(exact_maps.material(), normal=None, base_color=None)
    ball = Object(plain, "sphere", "steep", transform=placed((0.35, 0.3, 0.4), 0.4))
    return Object(plain, "box", "flat", transform=placed((0.1, -0.6, -0.2), (1.9, 0.2, 1.4))), ball


def layer(*missing: str) -> Option:
    """A second layer, tiled and mirrored along v, without the missing maps."""
    material = replace(exact_maps.layer_material(), **dict.fromkeys(missing))
    return Option(object={"layer": Layer(material, Tiling((4.6, -3.4), (0.25, 0.1)))})


def translucent(alpha: str) -> Option:
    """An opacity map with an alpha mode."""
    return Option({"opacity": exact_maps.opacity()}, {"alpha": alpha})


def without(*maps: str) -> Option:
    """A material without some maps."""
    return Option(dict.fromkeys(maps))


def casting(shadows: str, casts: str = "shape", **scene: Any) -> Option:
    """Two objects that cast shadows on each other."""
    return Option(
        object={"casts": casts},
        scene={"shadows": shadows, "shadow_map_size": 48, **scene},
        more_objects=copy,
    )


CAMERA = Orbit(27.0, 48.0)
OVERHEAD = LookAt((0.0, 2.0, 0.0), up=(0.0, 0.0, -1.0), orthographic_height=1.1)
SUN = directional(-35.0, 41.0, (1.0, 0.95, 0.85), 1.7)
LAMP = point((0.9, 1.3, 0.8), (0.8, 0.9, 1.0), 2.5)
NEAR_LAMP = point((-0.55, 0.62, 0.41), (0.5, 0.6, 0.4), 0.6, falloff=1.0)
FAR_LAMP = point((9e3, 2.1e4, 1.7e4), (1.0, 0.9, 0.8), 3e4, falloff=1.0)
SPOT = spot((-0.7, 1.5, 1.1), (0.1, 0.05, -0.1), (1.0, 0.8, 0.6), 4.0, angle=42.0, softness=0.4)
WIDE_SPOT = spot((1.2, 1.1, -0.6), (0.0, 0.1, 0.0), (0.6, 0.6, 1.0), 2.0, angle=130.0)
OWN_TILINGS = {
    "base_color": Tiling((2.3, 1.7), (0.15, 0.4)),
    "normal": Tiling((1.6, 2.9), (0.3, 0.2)),
    "response": Tiling((3.2, 1.4), (0.7, 0.1)),
    "emission": Tiling((1.9, 2.2), (0.2, 0.6)),
}
MIRRORED = {
    name: replace(tiling, tiles=(-tiling.tiles[0], tiling.tiles[1]))
    for name, tiling in OWN_TILINGS.items()
}
TURNED = placed((0.07, -0.04, 0.05)) @ rotated("y", 31.0) @ rotated("x", -67.0)
STRETCHED = rotated("y", -23.0) @ placed(scale=(1.2, 0.7, 0.9)) @ rotated("x", -71.0)

MENUS: dict[str, dict[str, Option]] = {
    "projection": {
        "biased": Option(object={"projection": "biased", "bias": 0.31}),
        "limited": Option(object={"projection": "limited"}),
    },
    "reference_height": {
        "level-0": Option(object={"reference_height": 0.0}),
        "level-half": Option(object={"reference_height": 0.5}),
        "level-1": Option(object={"reference_height": 1.0}),
    },
    "heights": {
        "smooth": Option(object={"heights": "smooth"}),
        "mip": Option(object={"heights": "mip"}),
    },
    "edge": {"clamp": Option(object={"edge": "clamp"}), "clip": Option(object={"edge": "clip"})},
    "tiling": {"tiled": Option(object={"tiling": (2.3, -1.6), "shift": (0.35, 0.2)})},
    "fade": {"fades": Option(object={"fade": (1.6, 2.9)})},
    "mapping": {"triplanar": Option(object={"mapping": "triplanar"})},
    "tilings": {
        "apart": Option(object={"tilings": OWN_TILINGS}),
        "mirrored": Option(object={"tilings": MIRRORED}),
    },
    "alpha": {name: translucent(name) for name in ("blend", "mask", "opaque")},
    "surface": {"landscape": Option(object={"surface": "landscape"})},
    "layer": {
        "layer": layer(),
        "layer-color": layer("normal", "height"),
        "layer-height": layer("base_color", "normal"),
        "layer-bare": layer("base_color", "normal", "height"),
    },
    "color": {"no-color": without("base_color")},
    "normal": {"no-normal": without("normal")},
    "response": {"no-response": without("occlusion", "roughness", "metallic", "layer_mask")},
    "emission": {"emission": Option({"emission": exact_maps.emission()})},
    "transform": {
        "turned": Option(object={"transform": TURNED}),
        "stretched": Option(object={"transform": STRETCHED}),
    },
    "shadows": {
        "hard": Option(scene={"shadows": "hard"}),
        "soft": Option(scene={"shadows": "soft"}),
        "cast": casting("hard"),
    },
    "model": {"phong": Option(scene={"shading_model": "phong"})},
    "occlusion": {"directional": Option(scene={"occlusion_kind": "directional"})},
    "fog_mode": {
        "linear": Option(scene={"fog_mode": "linear"}),
        "exponential": Option(scene={"fog_mode": "exponential"}),
        "squared": Option(scene={"fog_mode": "exponential_squared"}),
    },
    "lights": {
        "dark": Option(scene={"lights": ()}),
        "lamp": Option(scene={"lights": (LAMP,)}),
        "spot": Option(scene={"lights": (SPOT,)}),
        "lights": Option(scene={"lights": (NEAR_LAMP, SUN, WIDE_SPOT)}),
    },
    "camera": {
        "grazing": Option(scene={"camera": Orbit(-58.0, 17.0, field_of_view=41.0)}),
        "orthographic": Option(scene={"camera": Orbit(34.0, 28.0, orthographic_height=1.1)}),
        "tilted": Option(
            scene={"camera": LookAt((0.9, 1.4, 1.2), (0.05, -0.1, 0.02), (0.3, 1.0, -0.2))}
        ),
    },
    "numbers": {"numbers": Option(scene=SCENE_NUMBERS)},
}
"""The options of each menu other than its default."""

OTHER_OPTIONS: dict[str, Option] = {
    "full": Option(object={"projection": "full"}),
    "scale-0": Option(object={"scale": 0.0}),
    "deep": Option(object={"scale": 0.7}),
    "towers": Option({"height": exact_maps.towers()}),
    "leaning": Option(object={"surface_parameters": {"normal_strength": 4.0}}),
    "polished": Option(object={"surface_parameters": {"roughness": 0.02}}),
    "no-height": without("height"),
    "noise": Option(object={"mapping": "noise"}),
    "layer-unscaled": Option(object={"layer_offset": "unscaled"}),
    "layer-still": Option(object={"layer_offset": "none"}),
    "single-texels": Option(exact_maps.single_texels()),
    "twice": Option(more_objects=copy),
    "cast-soft": casting("soft"),
    "cast-polygon": casting("hard", shadows_on="polygon"),
    "cast-opaque": casting("hard", "opaque"),
    "cast-none": casting("soft", "none"),
    "cast-undisplaced": casting("hard", "polygon"),
    "others": Option(more_objects=floor_and_ball),
    "far-lamp": Option(scene={"lights": (FAR_LAMP,)}),
    "overhead": Option(scene={"camera": OVERHEAD}),
    "transparent": Option(scene={"background": None}),
    "samples": Option(render={"samples": 3}),
}
"""Options outside the menus."""
OPTIONS = {
    name: option for menu in (*MENUS.values(), OTHER_OPTIONS) for name, option in menu.items()
}


# --- cases ----------------------------------------------------------------------------------------

PLAIN = tuple(f"{technique} {shape}" for technique in ALL_TECHNIQUES for shape in SHAPES)
DEEP = tuple(f"{case} tiled level-half stretched lights grazing numbers deep" for case in PLAIN)
PAIRS = """
flat plane limited level-1 smooth clip apart mask layer-color emission stretched hard linear lamp orthographic
flat plane clip apart opaque layer-height no-color no-normal no-response stretched soft directional exponential dark grazing numbers
flat plane biased level-1 tiled fades blend layer-color emission turned soft linear spot tilted numbers
flat box biased clamp mirrored layer-bare no-color no-normal no-response emission turned soft phong directional squared lights tilted numbers
flat cylinder biased mip tiled blend landscape layer stretched cast phong directional exponential spot numbers
flat sphere level-0 triplanar
flat box level-half landscape layer-height
offset plane limited level-half smooth clip tiled apart opaque landscape layer-bare no-color no-normal emission stretched hard spot orthographic numbers
offset plane limited level-half mip clip opaque landscape layer-color emission stretched soft directional linear lights
offset box level-1 smooth clamp tiled opaque layer no-normal no-response emission hard directional exponential dark tilted numbers
offset sphere biased level-0 smooth clamp fades mirrored mask layer-height no-color emission stretched cast directional squared lamp tilted numbers
offset sphere mip clip tiled fades triplanar blend emission turned soft phong linear lights grazing numbers
offset_limited plane limited level-half mip clip mirrored mask layer-color no-color no-normal turned hard phong directional squared orthographic numbers
offset_limited box clip tiled fades mirrored blend landscape layer no-color no-response emission phong exponential lights orthographic numbers
offset_limited sphere limited tiled triplanar mirrored opaque layer-height no-normal no-response emission turned phong directional dark numbers
offset_limited sphere level-1 mip clamp fades triplanar blend layer-bare no-normal no-response cast phong directional linear lamp grazing
offset_limited cylinder biased level-0 smooth apart blend layer-bare no-response emission stretched soft spot tilted
steep plane biased tiled fades apart blend layer-color no-normal hard phong directional squared lamp tilted numbers
steep plane limited level-half smooth clip triplanar layer-height no-response emission stretched soft phong exponential dark orthographic
steep cylinder limited level-0 mip clamp tiled mirrored opaque layer no-color turned soft directional linear spot grazing numbers
steep cylinder limited level-1 clamp tiled mirrored mask layer-bare no-response stretched cast phong directional squared lights
steep cylinder limited mip tiled mask landscape no-normal no-response emission phong directional exponential lights tilted
exact plane biased level-1 clamp fades triplanar apart opaque layer-height emission stretched cast phong exponential lamp tilted
exact plane level-half clip mirrored mask landscape layer-bare no-response emission phong exponential lights
exact box limited mip clamp tiled fades triplanar apart blend layer no-color turned hard directional squared spot orthographic numbers
exact sphere limited level-half clip fades mirrored mask layer-color no-color no-normal emission turned soft phong directional lights numbers
exact cylinder biased level-0 mip clip tiled layer-color no-color no-response stretched phong linear dark grazing numbers
contact plane limited level-half smooth clamp mask layer-bare no-response hard exponential lights orthographic
contact plane level-1 mip clip tiled fades apart blend landscape no-color no-normal no-response emission stretched cast phong directional
contact box limited smooth clamp tiled triplanar apart opaque landscape layer-color no-response turned squared spot grazing
contact sphere biased level-0 fades mirrored blend layer-height no-color emission turned soft phong linear numbers
contact sphere level-half mip clamp apart opaque layer emission turned cast phong squared lamp tilted
contact cylinder clip tiled blend layer-color no-response emission turned hard phong directional exponential dark tilted
parallax_occlusion box level-0 mip blend layer emission turned cast phong directional exponential dark tilted numbers
parallax_occlusion sphere level-1 smooth clamp fades mirrored opaque landscape layer-color emission stretched squared lamp grazing
parallax_occlusion sphere biased level-0 mip clip opaque layer-height stretched soft directional linear spot tilted numbers
parallax_occlusion cylinder limited level-half mip clip tiled fades triplanar apart blend layer-bare no-color no-normal no-response emission turned hard phong directional exponential lights orthographic numbers
parallax_occlusion cylinder limited level-1 smooth clamp tiled mask layer no-color no-normal emission cast exponential spot orthographic
secant plane limited level-half clamp fades mirrored opaque layer-height no-normal stretched soft directional dark grazing
secant sphere limited level-half mip tiled fades triplanar mirrored mask landscape layer-bare emission stretched soft phong directional exponential orthographic numbers
secant sphere level-1 smooth clip fades apart layer-height no-color no-normal no-response emission hard phong linear spot grazing
secant sphere biased level-1 smooth clip mirrored mask layer no-normal no-response lamp orthographic
secant cylinder biased level-0 mip clamp tiled mirrored blend layer-color emission turned cast phong directional squared lights tilted numbers
relaxed_cone box limited level-half clamp fades apart blend landscape layer-bare no-color no-normal no-response emission turned directional squared dark grazing numbers
relaxed_cone box biased level-1 tiled triplanar layer emission hard phong linear grazing numbers
relaxed_cone cylinder level-half clip tiled fades triplanar mirrored opaque no-normal emission turned hard phong exponential lamp tilted numbers
relaxed_cone cylinder biased level-0 tiled mirrored mask layer-height no-color no-normal no-response stretched soft phong directional linear lights orthographic numbers
relaxed_cone cylinder level-1 clip fades blend layer-color turned cast phong directional spot grazing numbers
relief plane biased level-0 smooth clip opaque layer-bare no-normal emission stretched soft phong squared lamp grazing numbers
relief box biased smooth clamp tiled triplanar apart mask layer no-color no-normal no-response emission turned hard phong directional linear
relief box limited level-1 mip clip fades mirrored blend layer-height no-normal directional exponential dark tilted
relief sphere level-half tiled apart blend landscape layer-color no-normal emission stretched soft phong directional lights orthographic numbers
relief cylinder limited level-1 clip opaque layer-bare no-normal cast phong linear spot numbers
texel plane limited level-0 clamp mirrored layer no-normal no-response emission turned cast phong directional lamp orthographic
texel plane biased level-1 clip tiled fades opaque layer-bare no-color no-normal soft directional squared lights numbers
texel box limited level-half clip tiled fades triplanar apart mask layer-bare emission turned phong directional exponential
texel sphere biased clip blend layer-height no-color no-normal emission stretched soft phong directional linear dark grazing
texel cylinder biased level-half triplanar apart blend landscape layer-color no-normal no-response emission stretched hard exponential spot tilted numbers
cone plane limited level-0 mask layer-height no-normal no-response stretched soft phong directional linear lamp numbers
cone box limited level-1 tiled fades apart opaque layer no-color turned soft linear spot grazing numbers
cone box biased level-half clamp tiled fades triplanar mask landscape layer-color no-response turned directional squared lights orthographic
cone sphere biased level-0 clip tiled mirrored opaque no-normal no-response emission stretched hard phong directional exponential grazing numbers
cone sphere limited clip triplanar opaque layer-height soft exponential dark grazing
cone cylinder biased level-0 clip tiled blend layer-bare emission stretched cast phong directional squared tilted
fixed_length plane biased level-1 smooth clamp tiled triplanar mirrored opaque landscape layer-color no-normal no-response stretched soft phong directional linear spot grazing
fixed_length sphere limited level-half mip clip fades apart opaque layer no-color emission turned phong linear lights tilted numbers
fixed_length sphere biased level-0 mip tiled apart blend layer-height no-normal emission stretched cast phong directional exponential lamp numbers
fixed_length sphere biased level-1 mask layer-bare no-normal no-response turned hard phong directional linear tilted
fixed_length cylinder level-1 mip clamp fades mask no-color no-normal no-response emission turned directional squared spot orthographic numbers
fixed_length cylinder biased level-0 mip apart landscape layer-color emission stretched soft phong dark grazing numbers
own box level-0 mip clip triplanar blend landscape layer no-normal no-response soft phong squared lamp tilted
own box biased level-half clamp fades triplanar mirrored opaque layer-color no-color no-response emission stretched cast exponential lights orthographic
own box limited level-1 smooth clamp tiled fades apart mask no-color no-normal emission turned hard phong directional linear dark grazing numbers
own sphere limited level-0 mip clip blend layer-bare stretched soft phong exponential numbers
own cylinder biased mip tiled mirrored blend layer-height no-normal no-response turned hard directional exponential spot
""".strip().splitlines()  # noqa: E501
MORE = (
    "offset_limited plane full",
    "relief plane scale-0 directional",
    "exact plane grazing deep towers",
    "exact box grazing deep towers",
    "cone plane grazing deep towers",
    "relaxed_cone plane grazing deep towers",
    "texel plane grazing deep towers",
    "relief plane grazing leaning",
    "relief sphere polished",
    "relief box far-lamp",
    "relief plane overhead",
    "exact sphere overhead",
    "texel box overhead",
    "flat plane no-height",
    "flat sphere no-height no-color no-normal no-response",
    "relief cylinder no-color no-normal no-response",
    "exact plane single-texels",
    "relief plane single-texels mip",
    "relief box twice blend transparent",
    "relief sphere samples transparent",
    "cone sphere cast-soft lights",
    "contact plane cast-polygon level-0 spot",
    "parallax_occlusion plane cast-opaque mask lights",
    "exact box cast-none clip lamp",
    "relief plane cast-undisplaced mask lights",
    "relief plane others soft lights",
    "relief plane noise level-half stretched lights",
    "exact box noise clamp apart layer-color deep",
    "parallax_occlusion sphere noise tiled landscape layer numbers",
    "relief box tiled layer layer-unscaled",
    "offset plane mirrored landscape layer-color layer-still",
)
CASES = (*PLAIN, *DEEP, *PAIRS, *MORE)


def scene_of(case: str) -> Scene:
    """The scene of a case."""
    technique_name, shape, *names = case.split()
    drawn_technique = ALL_TECHNIQUES[technique_name]
    options = [OPTIONS[name] for name in names]
    material = replace(exact_maps.material(), **merged(option.material for option in options))
    arguments = merged(option.object for option in options)
    if "numbers" in names:
        known = drawn_technique.settings.__dataclass_fields__
        arguments["settings"] = {key: SETTINGS[key] for key in SETTINGS if key in known}
        arguments["smoothing"] = SMOOTHING
        arguments["surface_parameters"] = SURFACE_PARAMETERS[arguments.get("surface", "standard")]
    first = Object(material, shape, drawn_technique, **arguments)
    more_objects = [obj for option in options for obj in option.more_objects(first)]
    scene = merged(option.scene for option in options)
    return Scene((first, *more_objects), **{"camera": CAMERA, "lights": (SUN, LAMP), **scene})


def merged(parts: Iterable[dict[str, Any]]) -> dict[str, Any]:
    """The entries of all dictionaries; for equal names, the last."""
    return {name: value for part in parts for name, value in part.items()}


def drawn(case: str, device: Any = "cpu") -> Frame:
    """The frame of a case."""
    arguments = merged(OPTIONS[name].render for name in case.split()[2:])
    return render(scene_of(case), **{"size": SIZE, "samples": 1, "device": device, **arguments})
