"""Planes that stay on a device: programs that draw over what they hold."""

from __future__ import annotations

import os
import subprocess
import sys
import textwrap
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

from basrelief.engine import choose_device
from basrelief.engine import gpu as gpu_module
from basrelief.engine.cpu import CpuEngine
from basrelief.engine.engine import Engine
from basrelief.errors import DeviceError
from basrelief.lang.program import Program
from basrelief.lang.targets.wgsl import print_wgsl
from basrelief.material import Material, sample
from basrelief.rendering.frame import Frame
from basrelief.rendering.render import render
from basrelief.scene import Object, Scene
from helpers.comparing import write_module
from helpers.repository import REPOSITORY

SOURCE = """
@struct
class Inner:
    place: Vec2
    odd: bool

@struct
class Total:
    sum: float
    count: int
    inner: Inner

@struct
class Step:
    size: float

@shader
def add(at: IVec2, step: Step, below: Total) -> Total:
    place = Vec2(float(at.x), float(at.y)) + below.inner.place * 0.5
    odd = (at.x + below.count) % 2 == 1
    return Total(below.sum * 2.0 + step.size, below.count + at.y, Inner(place, odd))
"""
SIZE = (37, 23)
DEVICES = ["cpu", pytest.param("gpu", marks=pytest.mark.gpu)]


def engine_named(name: str) -> Engine:
    return CpuEngine(8, 2) if name == "cpu" else choose_device("gpu")


@pytest.fixture(scope="module")
def module(tmp_path_factory: pytest.TempPathFactory):
    return write_module(tmp_path_factory.mktemp("source"), SOURCE)


def expected(steps: tuple[float, ...]) -> dict[str, np.ndarray]:
    """The planes after runs of `add`, in NumPy."""
    y, x = np.mgrid[: SIZE[1], : SIZE[0]]
    total, count, place = np.zeros(x.shape), np.zeros(x.shape, int), np.zeros((*x.shape, 2))
    odd = np.zeros(x.shape, bool)
    for step in steps:
        total, odd = total * 2 + step, (x + count) % 2 == 1
        count, place = count + y, np.stack([x, y], -1) + place * 0.5
    return {"sum": total, "count": count, "inner.place.x": place[..., 0],
            "inner.place.y": place[..., 1], "inner.odd": odd}  # fmt: skip


def drawn_over(engine: Engine, module, steps: tuple[float, ...], rows=None):
    """A canvas after runs of `add`, from 0 everywhere."""
    program = Program(module.add)
    canvas = engine.canvas(program, SIZE)
    for step in steps:
        engine.draw(program, {"step": module.Step(step)}, canvas, rows)
    return canvas


@pytest.mark.parametrize("device", DEVICES)
@pytest.mark.parametrize("bands", [1, 5])
def test_a_program_draws_over_what_the_planes_hold(
    device: str, bands: int, module, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In bands of rows too, where a GPU's buffers hold no more."""
    monkeypatch.setattr(gpu_module, "_MAX_CANVAS_BYTES", 4 * 5 * SIZE[0] * -(-SIZE[1] // bands))
    canvas = drawn_over(engine_named(device), module, (0.5, 3.0, -1.0))
    assert canvas.size == SIZE
    for name, plane in expected((0.5, 3.0, -1.0)).items():
        np.testing.assert_array_equal(canvas.read(name)[0], plane)
    places = canvas.read("inner.place.x", 2)
    np.testing.assert_array_equal(places[1], expected((0.5, 3.0, -1.0))["inner.place.y"])


@pytest.mark.parametrize("device", DEVICES)
def test_rows_can_be_drawn_alone(device: str, module) -> None:
    canvas = drawn_over(engine_named(device), module, (1.0, 1.0), rows=(7, 12))
    wanted = expected((1.0, 1.0))
    for name, plane in wanted.items():
        np.testing.assert_array_equal(canvas.read(name)[0, 7:12], plane[7:12])
        assert not canvas.read(name)[0, :7].any()
        assert not canvas.read(name)[0, 12:].any()


def test_a_canvas_outlives_others(module) -> None:
    engine = CpuEngine(8, 2)
    first = drawn_over(engine, module, (1.0,))
    drawn_over(engine, module, (5.0, 5.0))
    np.testing.assert_array_equal(first.read("sum")[0], expected((1.0,))["sum"])


def test_what_the_planes_hold_is_no_value(module) -> None:
    program = Program(module.add)
    assert list(program.parameters) == ["step"]
    assert "below" not in print_wgsl(program.module, "wrap").split("fn main")[0].split("fn add")[0]
    with pytest.raises(DeviceError, match="needs a value for step"):
        CpuEngine(8, 1).draw(program, {}, CpuEngine(8, 1).canvas(program, SIZE))


def test_plain_python_takes_it_as_an_argument(module) -> None:
    """The same shader, called for one pixel."""
    below = module.Total(1.5, 3, module.Inner(module.Vec2(2.0, 4.0), False))
    found = module.add(module.IVec2(4, 2), module.Step(0.25), below)
    assert (float(found.sum), found.count, found.inner.odd) == (3.25, 5, True)


FORK = """
    import os, sys
    import basrelief

    def draw():
        return basrelief.render(basrelief.sample("tiles", 16), size=(64, 64), device="cpu").color

    before = draw()
    child = os.fork()
    if child == 0:
        os._exit(0 if (draw() == before).all() else 1)
    sys.exit(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
"""


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork on this system")
def test_a_forked_process_draws_with_threads_of_its_own(tmp_path: Path) -> None:
    environment = {**os.environ, "PYTHONPATH": str(REPOSITORY / "src")}
    script = tmp_path / "fork.py"
    script.write_text(textwrap.dedent(FORK), encoding="utf-8")
    run = subprocess.run(
        [sys.executable, "-W", "ignore", script], timeout=120, env=environment, check=False
    )
    assert run.returncode == 0


@pytest.mark.parametrize("device", DEVICES)
def test_several_threads_draw_on_one_engine(device: str) -> None:
    engine = engine_named(device)
    materials = [sample(name, 32) for name in ("tiles", "cobbles", "bricks", "gravel")]

    def color(material: Material) -> np.ndarray:
        return render(material, size=(48, 36), samples=2, device=engine).color

    alone = [color(material) for material in materials]
    with ThreadPoolExecutor(4) as threads:
        shared = list(threads.map(color, materials * 3))
    for number, found in enumerate(shared):
        np.testing.assert_array_equal(found, alone[number % len(materials)])


def test_frames_of_two_engines_are_kept_side_by_side() -> None:
    one, other = CpuEngine(8, 2), CpuEngine(16, 1)
    frames = [
        render(sample(name, 32), size=(48, 36), samples=1, device=engine)
        for engine in (one, other)
        for name in ("tiles", "cobbles")
    ]
    # read only now
    for first, second in ((0, 2), (1, 3)):
        np.testing.assert_array_equal(frames[first].color, frames[second].color)
    assert not np.array_equal(frames[0].color, frames[1].color)


@pytest.mark.gpu
def test_a_canvas_that_is_gone_leaves_its_planes_to_the_next() -> None:
    engine, material = gpu_module.GpuEngine(), sample("gravel", 32)

    def frame(size: tuple[int, int], scale: float) -> Frame:
        return render(material, size=size, samples=1, scale=scale, device=engine)

    def planes(of: Frame) -> object:
        return of._canvas.bands[0][2]

    first, second = frame(SIZE, 0.05), frame(SIZE, 0.1)
    assert planes(first) is not planes(second)
    freed, codes = planes(first), first.codes.copy()
    del first
    third = frame(SIZE, 0.05)
    assert planes(third) is freed
    # those that are kept are not drawn over
    assert not (second.codes == codes).all()
    assert (third.codes == codes).all()
    del third
    assert planes(frame((SIZE[0] + 1, SIZE[1]), 0.05)) is not freed
    assert engine._spare is not freed


@pytest.mark.gpu
def test_objects_are_composited_on_planes_that_were_used_before() -> None:
    engine, (stones, bricks) = gpu_module.GpuEngine(), (sample(n, 32) for n in ("gravel", "bricks"))
    both = Scene((Object(stones, shape="sphere"), Object(bricks)), background=None)
    expected = render(both, size=SIZE, samples=3, device=gpu_module.GpuEngine())
    other = render(Scene((Object(bricks), Object(stones))), size=SIZE, samples=2, device=engine)
    used = other._canvas.bands[0][2]
    del other
    frame = render(both, size=SIZE, samples=3, device=engine)
    assert frame._canvas.bands[0][2] is used
    for plane in ("color", "codes", "distance", "uv", "hit", "reads"):
        assert (getattr(frame, plane) == getattr(expected, plane)).all()
