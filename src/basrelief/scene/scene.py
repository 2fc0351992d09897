"""Scenes: objects, a camera, lights, shading, shadows and fog."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from basrelief.errors import InputError
from basrelief.scene.checks import FAR, FOG_IS_NUMBERS, check_choice, check_range, settings_record
from basrelief.scene.lights import LIGHT_CONSTRUCTORS, directional, light_kind
from basrelief.scene.objects import Object
from basrelief.scene.shapes import SHAPES
from basrelief.scene.views import LookAt, Orbit
from basrelief.shading.brdf import Shading
from basrelief.shading.camera import Camera
from basrelief.shading.fog import Fog
from basrelief.shading.kinds import (
    FogKind,
    OcclusionKind,
    ShadingModel,
    ShadowsKind,
    ShadowsOnKind,
    menus_of,
)
from basrelief.shading.lights import Light
from basrelief.shading.self_shadow import Shadowing

BACKGROUND = (0.05, 0.055, 0.065)
"""Default background, a dark grey; linear RGB."""


def _default_lights() -> tuple[Light, ...]:
    return (
        directional(-50.0, 35.0, (1.0, 0.96, 0.9), 2.2),
        directional(80.0, 20.0, (0.8, 0.9, 1.0), 0.8),
    )


@dataclass(frozen=True, eq=False)
class Scene:
    """Objects, a camera, lights, and the options of shading, shadows and fog.

    Parameters
    ----------
    objects : tuple of Object
        Objects of the scene; a single one is accepted.
    camera : Orbit or LookAt, default Orbit()
        Camera.
    lights : tuple of Light, optional
        Lights, from `directional`, `point` and `spot`. By default two directional lights.
    shading : Shading or mapping, optional
        Parameters of the shading model, or the fields of them to change.
    shading_model : {"ggx", "phong"}, default "ggx"
        GGX metallic-roughness shading, or Phong's.
    shadows : {"none", "hard", "soft"}, default "none"
        Shadows of each relief on itself, and those that several objects cast on one another, which
        are hard-edged in either case.
    shadows_on : {"relief", "polygon"}, default "relief"
        Where shadows of other objects land: on the relief, or on the polygon, as in game engines
        whose shadows ignore the displacement.
    shadow_map_size : int, default 1024
        Side of a light's shadow map in texels, 16 to 8192.
    shadowing : record or mapping, optional
        Parameters of self-shadows, or the fields of them to change.
    occlusion_kind : {"ambient", "directional"}, default "ambient"
        Light that occlusion darkens: the ambient light, or every light, the more the more grazing
        it is.
    fog_mode : {"none", "linear", "exponential", "exponential_squared"}, default "none"
        Attenuation of the fog with distance.
    fog : record or mapping, optional
        Parameters of the fog, or the fields of them to change.
    background : (float, float, float) or None, default a dark grey
        Linear RGB, 0 or above; None is transparent.

    Raises
    ------
    InputError
        For values out of range, and unknown names and fields.
    """

    objects: tuple[Object, ...]
    camera: Orbit | LookAt = field(default_factory=Orbit)
    lights: tuple[Light, ...] = field(default_factory=_default_lights)
    shading: Any = field(default_factory=dict)
    shading_model: ShadingModel = "ggx"
    shadows: ShadowsKind = "none"
    shadows_on: ShadowsOnKind = "relief"
    shadow_map_size: int = 1024
    shadowing: Any = field(default_factory=dict)
    occlusion_kind: OcclusionKind = "ambient"
    fog_mode: FogKind = "none"
    fog: Any = field(default_factory=dict)
    background: tuple[float, float, float] | None = BACKGROUND

    def __post_init__(self) -> None:
        objects = tuple(self.objects) if np.iterable(self.objects) else (self.objects,)
        if not all(isinstance(obj, Object) for obj in objects):
            raise InputError("objects are a tuple of Object, as (Object(material),)")
        for name, values in menus_of(Scene).items():
            check_choice(name, getattr(self, name), values)
        self._check_lights()
        check_range("shadow_map_size", self.shadow_map_size, 16, 8192)
        if isinstance(self.fog, str):
            raise InputError(FOG_IS_NUMBERS.format(self.fog))
        for name, record, owner in (
            ("shading", Shading, "the shading"),
            ("shadowing", Shadowing, "the shadows"),
            ("fog", Fog, "the fog"),
        ):
            object.__setattr__(self, name, settings_record(record, getattr(self, name), owner))
        background = (0.0,) * 3 if self.background is None else self.background
        if len(background) != 3 or not all(0.0 <= c <= FAR for c in background):
            raise InputError(f"background {background}: give three finite numbers from 0, or None")
        if self.fog_mode == "linear" and self.fog.fog_start > self.fog.fog_end:
            raise InputError(
                f"fog from {self.fog.fog_start:g} to {self.fog.fog_end:g}: "
                "give a fog_end no nearer than fog_start"
            )
        object.__setattr__(self, "objects", objects)

    def _check_lights(self) -> None:
        if not np.iterable(self.lights):
            raise InputError("lights are a tuple, as (directional(),)")
        object.__setattr__(self, "lights", tuple(self.lights))
        for light in self.lights:
            if not isinstance(light, Light):
                raise InputError(f"a light is {light!r}: give one made by {LIGHT_CONSTRUCTORS}")
            light_kind(light)

    @property
    def casts(self) -> bool:
        """Whether objects cast shadows on one another."""
        return self.shadows != "none" and len(self.objects) > 1

    def shader_camera(self, size: tuple[int, int]) -> Camera:
        """The shaders' camera for a picture of (width, height), framing the first object."""
        camera = self.camera
        if isinstance(camera, Orbit) and camera.distance is None and self.objects:
            camera = camera.framing(self.objects[0].bounding_points(), size)
        return camera.camera(size)

    def back_to_front(self, size: tuple[int, int]) -> list[Object]:
        """The objects by falling distance of their centres, in the order of compositing."""
        eye = np.array([*self.shader_camera(size).position], np.float64)
        distances = [float(np.linalg.norm(obj.to_world[:3, 3] - eye)) for obj in self.objects]
        order = sorted(range(len(distances)), key=lambda index: -distances[index])
        return [self.objects[index] for index in order]

    def with_camera(self, camera: Orbit | LookAt) -> Scene:
        """The same scene with another camera."""
        return replace(self, camera=camera)

    def check_camera(self) -> None:
        """Raise InputError if the camera is inside an object, or behind the only plane."""
        eye = np.array([*self.shader_camera((1, 1)).position, 1.0], np.float64)
        for obj in self.objects:
            x, y, z, _ = np.linalg.inv(obj.to_world) @ eye
            advice = "move it away, for example --camera distance=3"
            facts = SHAPES[obj.shape]
            # inside a flat shape means inside its raised relief
            if facts.contains(x, y, z) and (not facts.flat or 0.0 <= z <= obj.raised):
                raise InputError(f"the camera is inside the {obj.shape}; {advice}")
            if facts.flat and z <= 0.0 and len(self.objects) == 1:
                raise InputError(
                    f"the camera is behind the {obj.shape}, which has no back; lift it to the "
                    "other side, for example --camera elevation=35"
                )
