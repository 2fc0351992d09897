"""What is worked out from the maps of a material once, before anything is drawn."""

from basrelief.bake.bounds import bounds
from basrelief.bake.cones import cone_map, relaxed_cone_map
from basrelief.bake.height import Integrated, height_map
from basrelief.bake.horizon import ambient_occlusion, horizon_map
from basrelief.bake.normal import normal_map

__all__ = [
    "Integrated",
    "ambient_occlusion",
    "bounds",
    "cone_map",
    "height_map",
    "horizon_map",
    "normal_map",
    "relaxed_cone_map",
]
