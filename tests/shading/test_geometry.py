"""Geometry is given to programs that read it, and to no others."""

from __future__ import annotations

import pytest

from basrelief.engine.cpu import CpuEngine
from basrelief.lang import Buffer, IVec2, Vec2, Vec3, shader, struct
from basrelief.lang.program import Program
from basrelief.material import sample
from basrelief.rendering.programs import program_of, view_ray_program_of
from basrelief.scene import Object
from basrelief.shading.geometry import Geometry, Vertex
from basrelief.shading.pixel import pixel
from basrelief.shading.view_ray import view_ray


@struct
class Corner:
    position: Vec3
    uv: Vec2


@shader
def corner(at: IVec2, geometry: Geometry) -> Corner:
    return Corner(geometry.vertices[at.x].position, geometry.vertices[at.x].uv)


def test_a_program_that_reads_geometry_is_given_it() -> None:
    vertices = [Vertex(Vec3(k, 2, 3), Vec3(0, 0, 1), Vec2(k / 4, 0.5)) for k in range(3)]
    program = Program(corner)
    planes = CpuEngine().run(program, {"geometry_vertices": Buffer(vertices, Vertex)}, (3, 1))
    assert "geometry_vertices" in str(program.module)
    assert planes["position.x"].tolist() == [[0.0, 1.0, 2.0]]
    assert planes["uv.x"].tolist() == [[0.0, 0.25, 0.5]]


@pytest.mark.parametrize("shape", ["plane", "box", "sphere", "cylinder"])
def test_entries_take_geometry_and_no_shape_reads_it(shape: str) -> None:
    obj = Object(sample("cobbles", 8), shape=shape, technique="exact")
    for entry, program in (
        (pixel, program_of(obj.resolved)),
        (view_ray, view_ray_program_of(obj.resolved)),
    ):
        assert entry.signature[0]["geometry"] is Geometry
        assert "geometry" not in str(program.module)
