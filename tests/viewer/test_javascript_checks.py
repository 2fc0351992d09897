"""The checks of the viewer's JavaScript find planted faults, and its types fit pages' data."""

from __future__ import annotations

import base64
import json
import re
import shutil
import subprocess
import zlib
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from basrelief.material import sample
from basrelief.scene import Layer, LookAt, Object, Scene, Tiling, directional, placed, point, spot
from basrelief.viewer import write_view
from helpers.repository import REPOSITORY
from helpers.stills import no_stills

WEB = "src/basrelief/viewer/web"


def check(folder: Path, name: str) -> subprocess.CompletedProcess[str]:
    """Run one of the checks that package.json names, as scripts/test does."""
    command = ["npm", "run", "--silent", name]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)


@pytest.fixture
def copy(tmp_path: Path) -> Path:
    """A folder with copies of the JavaScript and of the configuration of its checks."""
    modules = REPOSITORY / "node_modules"
    if shutil.which("npm") is None or not modules.is_dir():
        pytest.skip("Node.js or the packages of package-lock.json are missing; run scripts/test")
    shutil.copytree(REPOSITORY / WEB, tmp_path / WEB)
    for name in ("package.json", "biome.json", "tsconfig.json"):
        shutil.copy(REPOSITORY / name, tmp_path)
    (tmp_path / "node_modules").symlink_to(modules)
    return tmp_path


def test_lint_passes(copy: Path) -> None:
    result = check(copy, "lint")
    assert result.returncode == 0, result.stderr


@pytest.mark.parametrize(
    ("planted", "found"),
    [
        ("export const planted  = 1;\n", "Formatter would have printed"),
        ("export const planted = (x) => x == 1;\n", "suspicious/noDoubleEquals"),
        ("const planted = 1;\n", "correctness/noUnusedVariables"),
        # only a warning
        ("let planted = 1;\n\nexport default planted;\n", "style/useConst"),
    ],
)
def test_lint_finds_a_planted_fault(copy: Path, planted: str, found: str) -> None:
    (copy / WEB / "planted.js").write_text(planted)
    result = check(copy, "lint")
    assert result.returncode != 0
    assert f"{WEB}/planted.js" in result.stderr
    assert found in result.stderr


def test_type_check_finds_planted_faults(copy: Path) -> None:
    planted = {
        "planted_untyped": ("export const planted = (x) => x;\n", "TS7006"),
        "planted_misuse": ('import { words } from "view/text.js";\n\nwords(1);\n', "TS2345"),
        "planted_import": ('import { words } from "view/missing.js";\n\nwords("a");\n', "TS2307"),
        "planted_type": ("/** @type {Colour} */\nexport const planted = 1;\n", "TS2304"),
    }
    for name, (text, _) in planted.items():
        (copy / WEB / f"{name}.js").write_text(text)
    result = check(copy, "types")
    assert result.returncode != 0
    found = re.findall(rf"^{WEB}/(\w+)\.js\S* error (TS\d+)", result.stdout, re.MULTILINE)
    assert sorted(found) == sorted((name, error) for name, (_, error) in planted.items())


# --- the data of pages ----------------------------------------------------------------------------


@pytest.fixture
def data_of(tmp_path: Path) -> Callable[..., dict[str, Any]]:
    """A function that returns the data of the page of a scene."""

    def of(scene: Scene, **options: Any) -> dict[str, Any]:
        file = tmp_path / "page.html"
        with no_stills():
            write_view(scene, file, device="cpu", **options)
        packed = re.search(r'id="data">([^<]*)<', file.read_text("utf-8"))
        assert packed
        data: dict[str, Any] = json.loads(zlib.decompress(base64.b64decode(packed[1])))
        return data

    return of


def plant_data(copy: Path, name: str, data: dict[str, Any]) -> None:
    """Write a module that declares data with the type that the page's code expects."""
    text = f"export const data: Data = {json.dumps(data)};\n"
    (copy / WEB / f"{name}.ts").write_text(f'import type {{ Data }} from "view/data";\n{text}')


def test_types_fit_the_data(copy: Path, data_of: Callable[..., dict[str, Any]]) -> None:
    """For a page with everything it can show, and for a minimal page."""
    full = Object(
        sample("bricks", 64),
        shape="sphere",
        layer=Layer(sample("gravel", 64), Tiling((2.0, 3.0))),
        tilings={"normal": Tiling((2.0, 2.0), (0.1, 0.2))},
        fade=(1.0, 2.0),
        transform=placed((0.0, 0.0, 0.0)),
    )
    lights = (directional(10.0, 20.0), point((0.0, 2.0, 0.0)), spot((0.0, 2.0, 0.0)))
    camera = LookAt((1.0, 2.0, 3.0), orthographic_height=2.0)
    full.material.with_origin("FOLDER", {"height_channel": "g", "stretch_height": True})
    data = data_of(Scene((full,), camera=camera, lights=lights), texels=32)
    assert data["scaledTo"]
    assert data["constants"]["layer"]
    assert any("why" in each for each in data["presets"].values())
    plant_data(copy, "planted_full", data)
    flat = Object(replace(sample("bricks", 8), height=None), technique="flat")
    plant_data(copy, "planted_flat", data_of(Scene((flat,), background=None)))
    result = check(copy, "types")
    assert result.returncode == 0, result.stdout


def test_types_refuse_other_data(copy: Path, data_of: Callable[..., dict[str, Any]]) -> None:
    flat = Object(replace(sample("bricks", 8), height=None), technique="flat")
    data = data_of(Scene((flat,)))
    plant_data(copy, "planted_text", {**data, "filled": "0.9"})
    plant_data(copy, "planted_null", {**data, "filled": None})
    plant_data(copy, "planted_more", {**data, "planted": 1})
    plant_data(copy, "planted_name", {**data, "shows": ["color", "depths"]})
    del data["limits"]
    plant_data(copy, "planted_less", data)
    result = check(copy, "types")
    assert result.returncode != 0
    found = re.findall(rf"^{WEB}/planted_(\w+)\.ts", result.stdout, re.MULTILINE)
    assert sorted(found) == ["less", "more", "name", "null", "text"]


def test_lock_file_names_no_registry() -> None:
    lock = json.loads((REPOSITORY / "package-lock.json").read_text())
    assert not [name for name, package in lock["packages"].items() if "resolved" in package]
