"""Every script in benchmarks/ runs with `--quick` and stores its figures."""

from __future__ import annotations

import json
import math
import os
import subprocess
import sys
from pathlib import Path

import pytest

from helpers.command_line import environment
from helpers.repository import REPOSITORY

BENCHMARKS = REPOSITORY / "benchmarks"
SHARED = {"figures", "scenes"}
"""Modules that the scripts import."""
MODES = {"exact": ("", "--cpu", "--growth")}
"""Options with which a script runs other code, besides engines."""
ON_GPU = {"cpu_frame", "gpu_kernel", "linked", "sources", "exact", "exact --growth"}

RAYS = ("whole", "straight", "bent down", "bent up")
FIGURES = {
    "startup": {
        "basrelief --help, wall s",
        "basrelief --help, processor s",
        "basrelief --help ÷ an empty Python",
    },
    "cpu_frame": {
        "compiled cold, wall s",
        "loaded from the cache, processor s",
        "cpu ÷ software, wall",
        "cpu ÷ software, processor",
    },
    "gpu_kernel": {
        "bricks, generated ÷ by hand",
        "gravel, generated ÷ by hand",
        "terrain, generated ÷ by hand",
    },
    "linked": {"relief, linked ÷ whole", "landscape, linked ÷ whole", "worst ratio"},
    "sources": {
        "cpu, gamedev, 4 to 20 samples, ms",
        "cpu, gamedev, 4 to 20 samples, processor ms",
        "cpu, halliwell with ÷ without self-shadow",
        "gpu, gamedev, 4 to 20 samples, ms",
        "gpu, halliwell with ÷ without self-shadow",
    },
    "exact": {
        "gpu, 128², bounds of fractal, timestamps ms",
        "gpu, 64 × 36, 128², exact ÷ march, timestamps, geometric mean",
        "gpu, 64 × 36, 128², exact ÷ filter, timestamps, worst",
    },
    "exact --cpu": {
        "cpu, 128², bounds of bricks, processor ms",
        "cpu, 64 × 36, 128², exact ÷ march, wall, geometric mean",
        "cpu, 64 × 36, 128², exact ÷ march, processor, worst",
    },
    "exact --growth": {"exact at 64 × 36, 144², mean ms", "exact at 64 × 36, 144² ÷ 128²"},
    "misses": {f"cpu, {kind}, rays" for kind in RAYS},
    "techniques": {
        "cpu, bricks, exact, time ÷ parallax_occlusion",
        "cpu, gravel, parallax_occlusion, missed at 85°, share",
    },
    "cones": {
        "cpu, 96², fractal, cone_map, processor s",
        "cpu, 96², bricks, relaxed_cone_map, wall s",
    },
    "memory": {"cpu, most held, GB"},
    "frame": {
        "cpu, 96 × 54, 2 samples, kernel, ms",
        "cpu, 96 × 54, 2 samples, codes, ms",
        "cpu, 96 × 54, 2 samples, all planes, ms",
        "cpu, soft shadows, 1 threads, codes, ms",
    },
    "film": {"cpu, mp4, frames a second", "cpu, png, frames a second"},
}
"""Figures above 0 that each command stores, not all of them."""
ZERO = {
    "gpu_kernel": {f"{sample}, share that differs" for sample in ("bricks", "gravel", "terrain")},
    "linked": {"words that differ"},
    "misses": {
        f"cpu, {kind}, {method}, late" for kind in RAYS for method in ("exact", "cell by cell")
    },
    "techniques": {"cpu, bricks, exact, missed at 75°, share"},
}
"""Figures that must be 0."""


def commands() -> list[object]:
    """Each script of the folder, in each of its modes."""
    scripts = sorted({path.stem for path in BENCHMARKS.glob("*.py")} - SHARED)
    named = [f"{script} {mode}".strip() for script in scripts for mode in MODES.get(script, ("",))]
    return [pytest.param(name, marks=pytest.mark.gpu if name in ON_GPU else ()) for name in named]


@pytest.mark.parametrize("command", commands())
def test_benchmark_runs(command: str, tmp_path: Path) -> None:
    script, *mode = command.split()
    file = tmp_path / "figures.json"
    file.write_text(json.dumps({"another script": {"its figure": 1.5}}))
    options = [*mode, "--quick", "--json", file]
    result = subprocess.run(
        [sys.executable, "-W", "error", BENCHMARKS / f"{script}.py", *options],
        env={**os.environ, **environment(), "PYTHONIOENCODING": "utf-8"},
        capture_output=True,
        encoding="utf-8",
        timeout=300,
        check=False,
    )
    assert result.returncode == 0, result.stderr
    assert result.stdout.strip()
    stored = json.loads(file.read_text("utf-8"))
    assert stored.pop("another script") == {"its figure": 1.5}
    assert list(stored) == [script], "it stores its figures under its own name"
    figures = stored[script]
    assert all(math.isfinite(value) for value in figures.values()), figures
    assert {name: figures[name] for name in FIGURES[command] if figures[name] <= 0} == {}
    assert {name: figures[name] for name in ZERO.get(command, ()) if figures[name] != 0} == {}
