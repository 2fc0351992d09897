"""Rendering of scenes: textures, programs, shadow maps, frames and films."""
