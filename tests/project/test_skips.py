"""On CI, an unexpected skip fails; elsewhere a skip is a skip."""

from __future__ import annotations

import ast

import pytest

from helpers.repository import TESTS

pytest_plugins = ["pytester"]

QUICK = ("--no-header",)
"""Options without the adapter's name, which would load a driver."""

SKIPPING = """
    import pytest

    @pytest.mark.parametrize("n", [1, 2])
    def test_without_driver(n):
        pytest.skip("no driver")

    @pytest.mark.skip(reason="not today")
    def test_marked():
        pass

    @pytest.mark.xfail(reason="known")
    def test_expected_failure():
        assert False
"""


@pytest.fixture
def suite(pytester: pytest.Pytester) -> pytest.Pytester:
    """A small suite under our own conftest, with three skips and one expected failure."""
    pytester.makeconftest((TESTS / "conftest.py").read_text())
    pytester.makepyfile(test_some=SKIPPING)
    return pytester


def test_skip_elsewhere(suite: pytest.Pytester, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("CI", raising=False)
    suite.runpytest_subprocess(*QUICK).assert_outcomes(skipped=3, xfailed=1)


@pytest.mark.parametrize("processes", ["0", "2"])
def test_unlisted_skip_fails_on_ci(
    suite: pytest.Pytester, monkeypatch: pytest.MonkeyPatch, processes: str
) -> None:
    monkeypatch.setenv("CI", "true")
    result = suite.runpytest_subprocess(*QUICK, "--numprocesses", processes)
    result.assert_outcomes(failed=2, errors=1, xfailed=1)
    result.stdout.fnmatch_lines(["FAILED *test_without_driver* - skipped on CI (*no driver*"])
    assert result.ret == pytest.ExitCode.TESTS_FAILED


def test_listed_skip_passes_on_ci(suite: pytest.Pytester, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CI", "true")
    listed = "# reasons\n\ntest_some.py::test_without_driver  none there\n"
    (suite.path / "allowed_skips.txt").write_text(listed)
    suite.runpytest_subprocess(*QUICK).assert_outcomes(skipped=2, errors=1, xfailed=1)


def test_skipped_module_fails_on_ci(
    pytester: pytest.Pytester, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("CI", "true")
    pytester.makeconftest((TESTS / "conftest.py").read_text())
    pytester.makepyfile(test_whole="import pytest; pytest.importorskip('no_such_module')")
    result = pytester.runpytest_subprocess(*QUICK)
    result.assert_outcomes(errors=1)
    result.stdout.fnmatch_lines(["*skipped on CI (*no_such_module*"])


def test_allowed_skips_exist() -> None:
    """Each listed test exists and has a reason."""
    for line in (TESTS / "allowed_skips.txt").read_text().splitlines():
        if not line.strip() or line.startswith("#"):
            continue
        node, *reason = line.split(maxsplit=1)
        assert reason, f"{node}: say why it may be skipped"
        path, name = node.split("::")
        module = ast.parse((TESTS.parent / path).read_text())
        assert name in {n.name for n in ast.walk(module) if isinstance(n, ast.FunctionDef)}, node
