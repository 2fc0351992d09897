"""Scenes: objects, a camera, lights, shading, shadows and fog.

The command line's help imports this module, so it imports little.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from basrelief.errors import InputError
from basrelief.scene.checks import FAR, FOG_IS_NUMBERS, check_settings
from basrelief.scene.objects import Object
from basrelief.scene.views import LookAt, Orbit
from basrelief.settings import setting
from basrelief.settings.kinds import (
    FogKind,
    OcclusionKind,
    ShadingModel,
    ShadowsKind,
    ShadowsOnKind,
)

if TYPE_CHECKING:
    from basrelief.scene.resolve import ResolvedObject
    from basrelief.shading.camera import Camera
    from basrelief.shading.lights import Light

BACKGROUND = (0.05, 0.055, 0.065)
"""Default background, a dark grey; linear RGB."""


def default_lights() -> tuple[Light, ...]:
    """The lights of a scene that names none: a warm key light, and a weaker cold one."""
    from basrelief.scene.lights import directional

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
        Colour behind the objects, linear RGB, 0 or above; transparent if None, on the command line
        `none`.

    Raises
    ------
    InputError
        For values out of range, and unknown names and fields.
    """

    objects: tuple[Object, ...]
    camera: Orbit | LookAt = setting(factory=Orbit, group="Camera")
    lights: tuple[Light, ...] = setting(factory=default_lights, group="Light")
    shading: Any = setting(factory=dict, kind="numbers", group="Light")
    shading_model: ShadingModel = setting(default="ggx", group="Light")
    shadows: ShadowsKind = setting(default="none", group="Light")
    shadows_on: ShadowsOnKind = setting(default="relief", group="Light")
    shadow_map_size: int = setting(default=1024, low=16, high=8192, group="Light")
    shadowing: Any = setting(factory=dict, kind="numbers", group="Light")
    occlusion_kind: OcclusionKind = setting(default="ambient", group="Light")
    fog_mode: FogKind = setting(default="none", group="Fog")
    fog: Any = setting(factory=dict, kind="numbers", group="Fog")
    background: tuple[float, float, float] | None = setting(
        default=BACKGROUND, low=0.0, high=FAR, spelling="R,G,B", group="Fog"
    )

    def __post_init__(self) -> None:
        several = isinstance(self.objects, Iterable)
        objects = tuple(self.objects) if several else (self.objects,)
        if not all(isinstance(obj, Object) for obj in objects):
            raise InputError("objects are a tuple of Object, as (Object(material),)")
        object.__setattr__(self, "objects", objects)
        if isinstance(self.fog, str):
            raise InputError(FOG_IS_NUMBERS.format(self.fog))
        if not isinstance(self.camera, Orbit | LookAt):
            raise InputError(f"camera is {self.camera!r}: give an Orbit or a LookAt")
        check_settings(self)
        self._check_background()
        self._resolve_records()

    def _check_background(self) -> None:
        if self.background is not None and not all(0.0 <= c <= FAR for c in self.background):
            raise InputError(
                f"background {self.background}: give three finite numbers from 0, or None"
            )

    def _resolve_records(self) -> None:
        from basrelief.scene.lights import checked_lights
        from basrelief.scene.records import SCENE_RECORDS, settings_record

        object.__setattr__(self, "lights", checked_lights(self.lights))
        for name, (record, owner) in SCENE_RECORDS.items():
            object.__setattr__(self, name, settings_record(record, getattr(self, name), owner))
        if self.fog_mode == "linear" and self.fog.fog_start > self.fog.fog_end:
            raise InputError(
                f"fog from {self.fog.fog_start:g} to {self.fog.fog_end:g}: "
                "give a fog_end no nearer than fog_start"
            )

    @property
    def casts(self) -> bool:
        """Whether objects cast shadows on one another."""
        return self.shadows != "none" and len(self.objects) > 1

    @property
    def resolved(self) -> tuple[ResolvedObject, ...]:
        """The objects with every option decided."""
        return tuple(obj.resolved for obj in self.objects)

    def shader_camera(self, size: tuple[int, int]) -> Camera:
        """The shaders' camera for a picture of (width, height), framing the first object."""
        camera = self.camera
        if isinstance(camera, Orbit) and camera.distance is None and self.objects:
            camera = camera.framing(self.objects[0].resolved.bounding_points(), size)
        return camera.camera(size)

    def back_to_front(self, size: tuple[int, int]) -> list[Object]:
        """The objects by falling distance of their centres, in the order of compositing."""
        import numpy as np

        if len(self.objects) == 1:
            return [*self.objects]
        eye = np.array([*self.shader_camera(size).position], np.float64)
        distances = [float(np.linalg.norm(obj.transform[:3, 3] - eye)) for obj in self.resolved]
        order = sorted(range(len(distances)), key=lambda index: -distances[index])
        return [self.objects[index] for index in order]

    def with_camera(self, camera: Orbit | LookAt) -> Scene:
        """The same scene with another camera."""
        return replace(self, camera=camera)

    def check_camera(self) -> None:
        """Raise InputError if the camera is inside an object, or behind the only plane."""
        import numpy as np

        from basrelief.scene.shapes import SHAPES

        eye = np.array([*self.shader_camera((1, 1)).position, 1.0], np.float64)
        for obj in self.resolved:
            x, y, z, _ = np.linalg.inv(obj.transform) @ eye
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
