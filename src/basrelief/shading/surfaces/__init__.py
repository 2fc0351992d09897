"""Surfaces: material properties at the hit, sampled from the material's maps."""
