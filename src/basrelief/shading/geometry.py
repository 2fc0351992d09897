"""Geometry buffers, for shapes made of triangles.

The shapes of `shading.shapes` are formulas and read none of them. The entries take the buffers all
the same, so that a shape made of triangles will change neither entries nor engines nor pages: a
program has only the buffers that it reads.
"""

from __future__ import annotations

from basrelief.lang import Buffer, Vec2, Vec3, resources, struct


@struct
class Vertex:
    """A triangle vertex in object space, with its unit normal and texture coordinates."""

    position: Vec3
    normal: Vec3
    uv: Vec2


@resources
class Geometry:
    """The geometry buffers of an object; each three consecutive vertices are a triangle."""

    vertices: Buffer[Vertex]
