"""Where the time goes: steps that exclude one another, and `render --timings`."""

import re
import threading
import time
from pathlib import Path

import pytest

import basrelief
from basrelief.engine.cpu import CpuEngine
from basrelief.timings import STEPS, Timings, step
from helpers.command_line import run, write_material


def test_a_step_pauses_the_one_around_it() -> None:
    with Timings() as timings, step("draw"):
        time.sleep(0.02)
        with step("compile"):
            time.sleep(0.05)
    assert timings.seconds["compile"] == pytest.approx(0.05, abs=0.02)
    assert timings.seconds["draw"] == pytest.approx(0.02, abs=0.015)
    assert sum(timings.seconds.values()) <= timings.total


def test_steps_of_all_threads_count() -> None:
    @step("encode")
    def encode() -> None:
        time.sleep(0.02)

    with Timings() as timings:
        threads = [threading.Thread(target=encode) for _ in range(3)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
    assert timings.seconds["encode"] >= 0.06


def test_steps_outside_timings_do_not_count() -> None:
    with Timings() as timings:
        pass
    with step("load"):
        time.sleep(0.01)
    assert timings.seconds == dict.fromkeys(STEPS, 0.0)
    total = timings.total
    time.sleep(0.01)
    assert timings.total == total


def test_the_steps_of_a_picture_are_at_most_the_whole() -> None:
    """With normals to make from heights, by a program that is compiled first."""
    stones = basrelief.sample("gravel", 64)
    bare = basrelief.Material("bare", height=stones.height, base_color=stones.base_color)
    with Timings() as timings:
        basrelief.render(bare, size=(64, 36), device=CpuEngine()).codes.any()
    assert sum(timings.seconds.values()) <= timings.total


@pytest.mark.parametrize("device", ["cpu", "gpu"])
@pytest.mark.parametrize("film", [(), ("--frames", "3")])
def test_render_prints_a_line_for_each_step(
    tmp_path: Path, device: str, film: tuple[str, ...]
) -> None:
    folder = write_material(tmp_path / "wall")
    arguments = ("render", folder, "--technique", "exact", "--size", "64x36", *film, "-o")
    outcome = run(*arguments, tmp_path / "a.png", "--device", device, "--timings")
    assert outcome.code == 0
    assert "ms" not in outcome.out
    lines = re.findall(r"^(\w+) +([0-9.]+) ms$", outcome.err, re.MULTILINE)
    assert [name for name, _ in lines] == [*STEPS, "other", "total"]
    times = {name: float(value) for name, value in lines}
    for name in ("load", "compile", "draw", "encode", "write"):
        assert times[name] > 0.0
