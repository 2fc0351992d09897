"""Fixtures of all tests: the GPU adapter, the rock material, and the rule that CI skips nothing.

On CI (the variable `CI` is set) a skip that `allowed_skips.txt` does not list is a failure, so a
missing driver or file does not count as success.
"""

from __future__ import annotations

import functools
import importlib
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import settings

TESTS = Path(__file__).parent

# The duration of an example depends more on other work of the machine than on the code.
settings.register_profile("unhurried", deadline=None)
settings.load_profile("unhurried")


# --- skips --------------------------------------------------------------------------------------


@functools.cache
def allowed_skips() -> frozenset[str]:
    """The listed node ids; each stands for all its parameters."""
    listed = TESTS / "allowed_skips.txt"
    lines = listed.read_text().splitlines() if listed.exists() else []
    return frozenset(line.split()[0] for line in lines if line.strip() and line[0] != "#")


def _fail_unexpected_skip(report: Any) -> None:
    """Turn the report of an unexpected skip on CI into that of a failure."""
    if not os.environ.get("CI") or not report.skipped or hasattr(report, "wasxfail"):
        return
    if report.nodeid.split("[")[0] in allowed_skips():
        return
    reason = report.longrepr[2] if isinstance(report.longrepr, tuple) else report.longrepr
    report.outcome = "failed"
    report.longrepr = (
        f"skipped on CI ({reason}); install what is missing, or list it in tests/allowed_skips.txt"
    )


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport() -> Iterator[None]:
    report = yield
    _fail_unexpected_skip(report)
    return report


@pytest.hookimpl(wrapper=True)
def pytest_make_collect_report() -> Iterator[None]:
    report = yield
    _fail_unexpected_skip(report)
    return report


# --- the GPU ------------------------------------------------------------------------------------


@functools.cache
def find_adapter() -> Any:
    """The WebGPU adapter that tests run on, or the reason why there is none."""
    try:
        import wgpu
    except ImportError:
        return "wgpu is not installed; pip install 'basrelief[gpu]'"
    try:
        return wgpu.gpu.request_adapter_sync(power_preference="high-performance")
    except (RuntimeError, OSError) as error:
        return f"no WebGPU adapter: {error}"


def pytest_report_header() -> str:
    adapter = find_adapter()
    return f"gpu: {adapter if isinstance(adapter, str) else adapter.summary}"


@pytest.fixture(scope="session")
def gpu_adapter() -> Any:
    """A WebGPU adapter; on CI the software one, with which expected values were computed."""
    adapter = find_adapter()
    if isinstance(adapter, str):
        pytest.skip(adapter)
    if os.environ.get("CI"):
        software = "llvmpipe" in adapter.summary and adapter.info["backend_type"] == "Vulkan"
        assert software, f"CI tests run on llvmpipe via Vulkan, not on {adapter.summary}"
    return adapter


@pytest.fixture(autouse=True)
def _gpu_where_marked(request: pytest.FixtureRequest) -> None:
    """Run tests marked `gpu` only if there is an adapter."""
    if request.node.get_closest_marker("gpu"):
        request.getfixturevalue("gpu_adapter")


# --- files --------------------------------------------------------------------------------------


def pytest_configure(config: pytest.Config) -> None:
    """Keep compiled programs and bakes of tests in the checkout, not in the user's cache."""
    os.environ.setdefault("BASRELIEF_CACHE", str(config.rootpath / ".pytest_cache" / "basrelief"))


@pytest.fixture(scope="session")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder for modules that tests write."""
    return tmp_path_factory.mktemp("modules")


# --- materials ----------------------------------------------------------------------------------


@pytest.fixture(scope="session", autouse=True)
def _small_samples() -> Iterator[None]:
    """Give samples that tests load by name, as `sample:stone`, 128 texels a side.

    They are loaded very often, and 512 texels take up to a second.
    """
    module = importlib.import_module("basrelief.material.loading")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(module, "sample", functools.partial(module.sample, size=128))
        yield


@pytest.fixture(scope="session")
def rock058() -> Path:
    """The folder of a scanned rock surface, 256² texels."""
    return TESTS / "data" / "Rock058"
