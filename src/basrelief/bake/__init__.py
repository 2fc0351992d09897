"""What is worked out from the maps of a material once, before anything is drawn."""

from basrelief.bake.bounds import bounds

__all__ = ["bounds"]
