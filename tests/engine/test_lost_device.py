"""A GPU that is lost or has no memory left, and several engines in one process."""

from __future__ import annotations

import numpy as np
import pytest

from basrelief.engine import choose_device, select
from basrelief.engine.gpu import GpuEngine
from basrelief.errors import DeviceError
from basrelief.material import Material, sample
from basrelief.rendering.frame import Frame
from basrelief.rendering.render import render

pytestmark = pytest.mark.gpu
SIZE = (48, 27)


@pytest.fixture(scope="module")
def stones() -> Material:
    return sample("gravel", 32)


def drawn(stones: Material, engine: GpuEngine, **options) -> Frame:
    return render(stones, size=SIZE, device=engine, technique="relief", **options)


def test_frames_of_a_lost_device(stones: Material) -> None:
    engine = GpuEngine()
    used, unused = drawn(stones, engine), drawn(stones, engine)
    codes = used.codes.copy()
    assert not engine.is_lost
    engine.gpu.destroy()
    assert (used.codes == codes).all()
    with pytest.raises(DeviceError, match="the GPU was lost, and with it the frames on it"):
        _ = unused.codes
    assert engine.is_lost
    with pytest.raises(DeviceError, match="the GPU was lost"):
        _ = used.distance
    with pytest.raises(DeviceError, match="the GPU was lost"):
        drawn(stones, engine)


def test_a_named_device_is_opened_again(stones: Material, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(select, "_engines", {})
    before = choose_device("gpu")
    codes = render(stones, size=SIZE, device="gpu").codes
    before.gpu.destroy()
    with pytest.raises(DeviceError, match="the GPU was lost"):
        render(stones, size=SIZE, device="gpu")
    assert (render(stones, size=SIZE, device="gpu").codes == codes).all()
    assert choose_device("gpu") is choose_device("gpu") is not before


def test_no_memory_left(stones: Material, monkeypatch: pytest.MonkeyPatch) -> None:
    import wgpu

    engine = GpuEngine()
    frame = drawn(stones, engine)
    create = engine.gpu.create_buffer

    def full(*, size: int, **options):
        if size > 4 * SIZE[0] * SIZE[1]:
            raise wgpu.GPUOutOfMemoryError("not enough memory left")
        return create(size=size, **options)

    monkeypatch.setattr(engine.gpu, "create_buffer", full)
    with pytest.raises(DeviceError, match="the GPU has no memory left; draw smaller pictures"):
        drawn(stones, engine)
    monkeypatch.undo()
    assert not engine.is_lost
    assert (frame.codes == drawn(stones, engine).codes).all()


def test_two_engines_at_once(stones: Material) -> None:
    one, other = GpuEngine(), GpuEngine()
    frames = [
        drawn(stones, engine, scale=scale) for scale in (0.05, 0.1) for engine in (one, other)
    ]
    first, second, third, fourth = (frame.codes for frame in frames)
    assert (first == second).all()
    assert (third == fourth).all()
    assert not (first == third).all()
    one.gpu.destroy()
    assert np.isfinite(frames[1].uv).all()
