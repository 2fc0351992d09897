"""Tangent frames: orthonormal, of the right handedness, and the one sign between y and v."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from basrelief.lang import Vec2, Vec3
from basrelief.lang.frontend import analyse
from basrelief.shading.shapes import ShapeRay, chart, intersect_shape
from basrelief.shading.tangent_frame import (
    TangentFrame,
    aspect,
    from_tangent,
    tangent_frame,
    to_tangent,
    to_texture,
)
from basrelief.shading.variant import Variant

SHADERS = [tangent_frame, aspect, to_tangent, from_tangent, to_texture]

# A ray from outside to each patch of each shape, not through its middle.
RAYS = {
    "plane": ("plane", (0.2, 0.1, 2), (0, 0, -1)),
    "box right": ("box", (2, 0.1, 0.3), (-1, 0.05, 0)),
    "box top": ("box", (0.2, 2, 0.1), (0, -1, 0.1)),
    "box bottom": ("box", (0.2, -2, 0.1), (0.1, 1, 0)),
    "sphere": ("sphere", (1, 1.5, 2), (-1, -1.4, -1.8)),
    "sphere near the pole": ("sphere", (0.01, 2, 0.02), (0, -1, 0)),
    "cylinder": ("cylinder", (-2, 0.3, 1), (1.9, -0.2, -1)),
    "cylinder top": ("cylinder", (0.2, 2, 0.1), (0, -1, 0.1)),
}


def a(vector) -> np.ndarray:
    return np.array([*vector], np.float64)


def unit(vector) -> np.ndarray:
    return np.asarray(vector, np.float64) / np.linalg.norm(vector)


def columns(frame: TangentFrame) -> np.ndarray:
    """Tangent, bitangent and normal as the columns of a matrix."""
    return np.stack([a(frame.tangent), a(frame.bitangent), a(frame.normal)], 1)


@st.composite
def patches(draw):
    """A unit normal, orthogonal ∂P/∂u and ∂P/∂v in its plane, and the handedness."""
    around, above, spin = (draw(st.floats(-3, 3)) for _ in range(3))
    normal = (np.cos(above) * np.sin(around), np.sin(above), np.cos(above) * np.cos(around))
    lean = (np.cos(spin), np.sin(spin), 1 - abs(np.sin(around)))
    if np.linalg.norm(np.cross(normal, lean)) < 0.1:
        lean = (-normal[1], normal[2], normal[0])
    normal = unit(normal)
    u = unit(np.cross(normal, lean))
    handedness = draw(st.sampled_from([1.0, -1.0]))
    v = -np.cross(normal, u) * handedness
    along_u = u * draw(st.floats(0.0625, 20, width=32))
    along_v = v * draw(st.floats(0.0625, 20, width=32))
    return normal, along_u, along_v, handedness


def frame_from(normal, along_u, along_v) -> TangentFrame:
    return tangent_frame(Vec3(*normal), Vec3(*along_u), Vec3(*along_v))


@pytest.mark.parametrize("function", SHADERS, ids=lambda f: f.name)
def test_the_shaders_are_in_the_subset(function) -> None:
    assert analyse(function).entry.name == function.name


@given(patches())
def test_frames_are_orthonormal_with_x_along_u_and_y_against_v(patch) -> None:
    normal, along_u, along_v, handedness = patch
    frame = frame_from(normal, along_u, along_v)
    matrix = columns(frame)
    np.testing.assert_allclose(matrix.T @ matrix, np.eye(3), atol=2e-6)
    np.testing.assert_allclose(a(frame.tangent), unit(along_u), atol=2e-6)
    np.testing.assert_allclose(a(frame.bitangent), -unit(along_v), atol=2e-6)
    expected = np.cross(a(frame.normal), a(frame.tangent)) * handedness
    np.testing.assert_allclose(a(frame.bitangent), expected, atol=2e-6)
    assert frame.width == pytest.approx(np.linalg.norm(along_u), rel=1e-5)
    assert frame.height == pytest.approx(np.linalg.norm(along_v), rel=1e-5)
    assert frame.shear == pytest.approx(0.0, abs=2e-6 * np.linalg.norm(along_v))
    ratio = np.linalg.norm(along_u) / np.linalg.norm(along_v)
    assert aspect(frame) == pytest.approx(ratio, rel=1e-5)


@given(patches(), st.tuples(*[st.floats(-2, 2, width=32)] * 3))
def test_to_tangent_and_from_tangent_are_inverse(patch, v) -> None:
    frame = frame_from(*patch[:3])
    taken = to_tangent(frame, Vec3(*v))
    np.testing.assert_allclose(a(taken), columns(frame).T @ np.array(v), atol=5e-6)
    np.testing.assert_allclose(a(from_tangent(frame, taken)), v, atol=1e-5)


@given(patches(), st.floats(-1, 1, width=32), st.floats(-1, 1, width=32))
def test_to_texture_converts_a_move_of_the_point_to_uv(patch, x, y) -> None:
    """The move in tangent space, in tile widths, equals ∂P/∂u du + ∂P/∂v dv."""
    normal, along_u, along_v, _ = patch
    frame = frame_from(normal, along_u, along_v)
    got = a(to_texture(frame, Vec2(x, y) * frame.width))
    wanted = solved_move(frame, along_u, along_v, np.array([x, y]) * float(frame.width))
    np.testing.assert_allclose(got, wanted, atol=1e-5 * max(1.0, float(aspect(frame))))


def solved_move(frame: TangentFrame, along_u, along_v, move) -> np.ndarray:
    """The move of texture coordinates, by least squares in float64."""
    tangent, bitangent, _ = columns(frame).T
    moved = tangent * move[0] + bitangent * move[1]
    return np.linalg.lstsq(np.stack([along_u, along_v], 1), moved, rcond=None)[0]


@given(
    patches(),
    st.floats(-3, 3, width=32),
    st.floats(-1, 1, width=32),
    st.floats(-1, 1, width=32),
)
def test_moves_on_a_sheared_tile(patch, shear, x, y) -> None:
    """∂P/∂v is sheared along ∂P/∂u by up to three times its length, mirrored or not."""
    normal, along_u, across, handedness = patch
    along_v = across + unit(along_u) * np.linalg.norm(across) * shear
    frame = frame_from(normal, along_u, along_v)
    matrix = columns(frame)
    np.testing.assert_allclose(matrix.T @ matrix, np.eye(3), atol=2e-6)
    assert np.linalg.det(matrix) == pytest.approx(handedness, abs=1e-5)
    # ∂P/∂v = shear · tangent − height · bitangent
    size = np.linalg.norm(along_v)
    assert frame.width == pytest.approx(np.linalg.norm(along_u), rel=1e-5)
    assert frame.height == pytest.approx(np.linalg.norm(across), rel=1e-5, abs=2e-6 * size)
    rebuilt = matrix[:, 0] * float(frame.shear) - matrix[:, 1] * float(frame.height)
    np.testing.assert_allclose(rebuilt, along_v, atol=4e-6 * size)
    got = a(to_texture(frame, Vec2(x, y) * frame.width))
    wanted = solved_move(frame, along_u, along_v, np.array([x, y]) * float(frame.width))
    most = max(1.0, float(aspect(frame))) * (1.0 + size / np.linalg.norm(along_u))
    np.testing.assert_allclose(got, wanted, atol=1e-5 * most)


def test_a_sheared_mirrored_tile_worked_out_by_hand() -> None:
    """4 wide along +y, 2 high along +x, leaning 3 along +y: seen from +z it is mirrored."""
    frame = tangent_frame(Vec3(0, 0, 1), Vec3(0, 4, 0), Vec3(2, 3, 0))
    assert a(frame.tangent).tolist() == [0.0, 1.0, 0.0]
    assert a(frame.bitangent).tolist() == [-1.0, 0.0, 0.0]
    assert (frame.width, frame.height, frame.shear) == (4.0, 2.0, 3.0)
    assert aspect(frame) == 2.0
    # the tile's own sides
    assert a(to_texture(frame, Vec2(4.0, 0.0))).tolist() == [1.0, 0.0]
    assert a(to_texture(frame, Vec2(3.0, -2.0))).tolist() == [0.0, 1.0]
    # ½ along the tangent and 1 along the bitangent: −½ in v, and then (½ + 1½) ÷ 4 in u
    assert a(to_texture(frame, Vec2(0.5, 1.0))).tolist() == [0.5, -0.5]


def test_y_up_is_v_down() -> None:
    square = tangent_frame(Vec3(0, 0, 1), Vec3(2, 0, 0), Vec3(0, -2, 0))
    assert a(to_texture(square, Vec2(0.5, 1.0))).tolist() == [0.25, -0.5]
    wide = tangent_frame(Vec3(0, 0, 1), Vec3(3, 0, 0), Vec3(0, -1, 0))
    assert a(to_texture(wide, Vec2(0.75, 1.5))).tolist() == [0.25, -1.5]


@pytest.mark.parametrize("where", RAYS)
@pytest.mark.parametrize(
    ("tiling", "handedness"),
    [((1, 1), 1), ((3, 2), 1), ((-3, 2), -1), ((3, -2), -1), ((-3, -2), 1)],
)
def test_mirrored_tilings_flip_the_handedness(where, tiling, handedness) -> None:
    """A negative tiling of one axis mirrors a shape; of both it does not."""
    name, origin, direction = RAYS[where]
    intersection = intersect_shape(ShapeRay(Vec3(*origin), Vec3(*direction)), Variant(shape=name))
    assert intersection.found
    surface_chart = chart(intersection.position, intersection.normal, Variant(shape=name))
    along_u, along_v = a(surface_chart.along_u) / tiling[0], a(surface_chart.along_v) / tiling[1]
    frame = frame_from(a(intersection.normal), along_u, along_v)
    matrix = columns(frame)
    np.testing.assert_allclose(matrix.T @ matrix, np.eye(3), atol=3e-6)
    assert np.linalg.det(matrix) == pytest.approx(handedness, abs=1e-5)
    assert a(frame.tangent) @ along_u > 0
    assert a(frame.bitangent) @ along_v < 0


def test_a_derivative_is_projected_onto_the_surface() -> None:
    frame = tangent_frame(Vec3(0, 0, 1), Vec3(2, 0, 1), Vec3(0, -3, 0))
    np.testing.assert_allclose(columns(frame), np.eye(3), atol=1e-6)
    assert (frame.width, frame.height, frame.shear) == (2.0, 3.0, 0.0)
