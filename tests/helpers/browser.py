"""A headless Chromium with its own software WebGPU adapter, for tests of pages."""

from __future__ import annotations

import base64
import os
import shutil
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import numpy as np
import pytest

from basrelief.rendering.frame import Frame
from basrelief.shading.pixel import SOLID

SOFTWARE = (
    "--enable-unsafe-webgpu",
    "--use-webgpu-adapter=swiftshader",
    "--enable-unsafe-swiftshader",
    # SwiftShader's Vulkan has to draw the canvas too, or its buffers cannot be shared
    "--enable-features=Vulkan",
    "--use-vulkan=swiftshader",
    "--use-angle=swiftshader",
)
PATIENCE = 120_000
"""Timeout of a page in milliseconds: test machines are slow and busy."""
WITHOUT = ("--disable-gpu", "--disable-features=WebGPU", "--disable-blink-features=WebGPU")


def find_chromium() -> str | None:
    """The system's Chromium, or Chrome."""
    for name in ("chromium", "chromium-browser", "google-chrome"):
        found = shutil.which(name)
        if found is not None:
            return found
    return None


@contextmanager
def chromium(flags: tuple[str, ...]) -> Iterator[Any]:
    """A running browser; skips the test without Chromium or Playwright."""
    api = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    found = find_chromium()
    if found is None:
        pytest.skip("no Chromium on the path; on Debian: apt-get install chromium")
    # root, as in a container, may not use the browser's sandbox
    root = ("--no-sandbox",) if hasattr(os, "getuid") and os.getuid() == 0 else ()
    with api.sync_playwright() as driver, pytest.MonkeyPatch.context() as patch:
        for kind in (api.Page, api.Frame):
            patch.setattr(kind, "wait_for_function", wait_for_function)
        try:
            browser = driver.chromium.launch(executable_path=found, args=[*flags, *root])
        except api.Error as error:
            pytest.skip(f"{found} does not start here: {str(error).splitlines()[0]}")
        try:
            yield browser
        finally:
            browser.close()


def wait_for_function(
    page: Any, condition: str, *, arg: Any = None, timeout: float = PATIENCE
) -> None:
    """Wait until a condition holds in a page or a frame; with `arg`, a function of it.

    Playwright's own function polls by `eval` in the page, which the content policy of our pages
    forbids; `evaluate` is allowed.
    """
    from playwright.sync_api import Error

    # promises, such as that a page is ready, are not awaited
    holds = f"() => Boolean({condition})" if arg is None else f"x => Boolean(({condition})(x))"
    end = time.monotonic() + timeout / 1000.0
    why = "it does not hold"
    while time.monotonic() < end:
        try:
            if page.evaluate(holds, arg):
                return
        except Error as error:
            why = error.message
        page.wait_for_timeout(20)
    raise AssertionError(f"waited {timeout / 1000.0:g} s for {condition}: {why}")


# --- arrays ---------------------------------------------------------------------------------------

WITH_ARRAYS = """async (given) => {
  const kinds = {
    Uint8Array, Uint8ClampedArray, Uint16Array, Uint32Array, Int32Array, Float32Array, Float64Array,
  };
  const read = (x) => {
    if (Array.isArray(x)) return x.map(read);
    if (!x?.typed) return x;
    const bytes = Uint8Array.from(atob(x.base64), (c) => c.charCodeAt(0));
    return new kinds[x.typed](bytes.buffer);
  };
  const written = (x) => {
    if (Array.isArray(x)) return x.map(written);
    if (!ArrayBuffer.isView(x)) return x;
    const bytes = new Uint8Array(x.buffer, x.byteOffset, x.byteLength);
    let text = "";
    // a call takes only so many arguments
    for (let k = 0; k < bytes.length; k += 8192) {
      text += String.fromCharCode(...bytes.subarray(k, k + 8192));
    }
    return { typed: x.constructor.name, base64: btoa(text) };
  };
  return written(await (SCRIPT)(read(given)));
}"""
TYPED = {
    "Uint8Array": np.uint8, "Uint8ClampedArray": np.uint8, "Uint16Array": np.uint16,
    "Uint32Array": np.uint32, "Int32Array": np.int32, "Float32Array": np.float32,
    "Float64Array": np.float64,
}  # fmt: skip
"""NumPy types by the names of JavaScript's typed arrays."""
WORDS = "async side => new Uint32Array(await viewer.drawing.frames.words(side))"
"""Script that returns the planes of the viewer's picture as 32-bit words; see `planes`."""
NAMES = {np.dtype(kind): name for name, kind in TYPED.items() if name != "Uint8ClampedArray"}


def evaluate(page: Any, script: str, argument: Any = None) -> Any:
    """Result of a function in a page or a frame, with NumPy arrays as typed arrays.

    Arrays come back flat, also within lists. Playwright serialises numbers one by one, which would
    take longer for a picture than drawing it.
    """
    return _read(page.evaluate(WITH_ARRAYS.replace("SCRIPT", script), _written(argument)))


def _written(x: Any) -> Any:
    if isinstance(x, np.ndarray):
        return {"typed": NAMES[x.dtype], "base64": base64.b64encode(x.tobytes()).decode()}
    return [_written(each) for each in x] if isinstance(x, list | tuple) else x


def _read(x: Any) -> Any:
    if isinstance(x, dict) and "typed" in x:
        return np.frombuffer(base64.b64decode(x["base64"]), TYPED[x["typed"]])
    return [_read(each) for each in x] if isinstance(x, list) else x


def planes(words: np.ndarray, size: tuple[int, int], background: Sequence[float]) -> Frame:
    """The library's frame from the planes of a page's picture of (width, height)."""
    width, height = size
    plane_words = words.view(np.uint32).reshape(9, height, width)
    real = plane_words.view(np.float32)
    coverage = np.where(plane_words[7] != 0, real[3], 0.0)[:, :, None]
    hit = coverage[:, :, 0] >= SOLID
    color = np.zeros((height, width, 4), np.float32)
    behind = np.array(background, np.float32)
    color[:, :, :3] = behind * (1.0 - coverage) + real[:3].transpose(1, 2, 0) * coverage
    color[:, :, 3] = 1.0
    depth = np.where(hit, real[4], np.inf).astype(np.float32)
    uv = real[5:7].transpose(1, 2, 0)
    return Frame(color, depth, uv, hit, plane_words[8].astype(np.int32), "browser")
