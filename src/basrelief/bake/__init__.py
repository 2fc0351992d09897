"""What is worked out from the maps of a material once, before anything is drawn."""

from basrelief.bake.bounds import bounds
from basrelief.bake.cones import cone_map, relaxed_cone_map

__all__ = ["bounds", "cone_map", "relaxed_cone_map"]
