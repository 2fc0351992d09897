"""Compiling printed GLSL by the reference compiler."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest


def assert_compiles(text: str, folder: Path) -> None:
    """Assert that glslangValidator compiles a fragment shader; skips the test without it.

    `scripts/test` installs it, and on CI a skip fails.
    """
    if shutil.which("glslangValidator") is None:
        pytest.skip("glslangValidator is not installed; on Debian: apt-get install glslang-tools")
    file = folder / "shader.frag"
    file.write_text(text, encoding="ascii")
    done = subprocess.run(["glslangValidator", file], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout
