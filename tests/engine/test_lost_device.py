"""A GPU that is lost or has no memory left, and several engines in one process."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from basrelief.engine import choose_device, select
from basrelief.engine.gpu import GpuEngine
from basrelief.errors import DeviceError
from basrelief.images import encode_light, read_picture
from basrelief.material import Material, sample
from basrelief.rendering.frame import Frame
from basrelief.rendering.programs import frame_program_of, frame_values, values_of
from basrelief.rendering.render import render
from basrelief.rendering.video import video_picture
from basrelief.scene import Object, Scene
from basrelief.shading.video import FourCodes

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


def test_a_lost_device_is_recognised_wherever_it_is_used(stones: Material) -> None:
    scene = Scene((Object(stones, technique="relief"),))
    obj = scene.resolved[0]
    program = frame_program_of(obj, scene)
    engine = GpuEngine()
    values = {**values_of(obj, scene, SIZE, engine), **frame_values(scene, [(0.5, 0.5)])}
    with engine.prepare(program, values, SIZE) as job:
        engine.gpu.destroy()
        for use in (
            lambda: engine.compile(frame_program_of(obj, replace(scene, fog_mode="linear"))),
            lambda: engine.seconds(job, SIZE[1]),
            lambda: engine.run(program, values, SIZE),
        ):
            engine.is_lost = False
            with pytest.raises(DeviceError, match="the GPU was lost"):
                use()
            assert engine.is_lost


def test_a_buffer_that_cannot_be_mapped_means_a_lost_device(
    stones: Material, monkeypatch: pytest.MonkeyPatch
) -> None:
    import wgpu

    engine = GpuEngine()
    frame = drawn(stones, engine)

    def failed(*_: object) -> None:
        raise RuntimeError("Could not map buffer (4): lost")

    monkeypatch.setattr(wgpu.GPUBuffer, "map_sync", failed)
    with pytest.raises(DeviceError, match="the GPU was lost"):
        _ = frame.codes
    assert engine.is_lost


def test_a_read_that_is_interrupted_leaves_the_engine_usable(
    stones: Material, monkeypatch: pytest.MonkeyPatch
) -> None:
    import wgpu

    engine = GpuEngine()
    frame = drawn(stones, engine)
    assert frame.reads.any()
    map_sync = wgpu.GPUBuffer.map_sync

    def interrupted(buffer: Any, *arguments: Any) -> None:
        map_sync(buffer, *arguments)
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(wgpu.GPUBuffer, "map_sync", interrupted)
        with pytest.raises(KeyboardInterrupt):
            _ = frame.codes
    assert (frame.codes == drawn(stones, engine).codes).all()


def test_codes_that_were_read_make_a_film_without_the_device(stones: Material) -> None:
    engine = GpuEngine()
    frame, same = (render(stones, size=(48, 28), device=engine) for _ in range(2))
    expected = video_picture(same)
    assert frame.codes.any()
    engine.gpu.destroy()
    assert (video_picture(frame) == expected).all()


def test_planes_that_no_buffer_takes_are_encoded_in_memory(
    stones: Material, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As if the limit were a kilobyte: the frame is in many bands."""
    engine = GpuEngine()
    expected = render(stones, size=(48, 28), device=engine)
    monkeypatch.setitem(engine.limits, "max-storage-buffer-binding-size", 48 * 10 * 4 * 2)
    frame, another = (render(stones, size=(48, 28), device=engine) for _ in range(2))
    assert len(frame._canvas.bands) > 1
    assert frame.on_device("codes", FourCodes) is None
    assert (video_picture(frame) == video_picture(expected)).all()
    stored = read_picture(another.save(tmp_path / "a.png", bits=16)).pixels
    assert (stored == encode_light(expected.color, 16)[:, :, :3]).all()
