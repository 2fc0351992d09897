"""`basrelief view`: the page that it writes and opens, and its data."""

from __future__ import annotations

import base64
import json
import re
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from basrelief.images import write_data
from helpers.command_line import refused, run
from helpers.stills import no_stills


@pytest.fixture
def without_stills() -> Iterator[None]:
    with no_stills():
        yield


def page_data(page: Path) -> dict[str, Any]:
    """The data of a page."""
    match = re.search(r'id="data">([^<]*)</script>', page.read_text("utf-8"))
    assert match is not None
    data: dict[str, Any] = json.loads(zlib.decompress(base64.b64decode(match[1])))
    return data


@pytest.mark.usefixtures("without_stills")
def test_the_page_starts_with_the_options(tmp_path: Path) -> None:
    page = tmp_path / "page.html"
    done = run(
        "view", "sample:bricks", "-o", page, "--texels", "64", "--technique", "steep", "--set",
        "steps=9", "--shape", "cylinder", "--heights", "smooth", "--edge", "clamp", "--fog-mode",
        "linear", "--set", "fog_end=7", "--surface", "landscape", "--map-tiling", "normal=2x3",
        "--shadows", "soft", "--light", "spot,position=1/2/1,angle=50,intensity=3", "--camera",
        "azimuth=10,elevation=20", "--device", "cpu",
    )  # fmt: skip
    assert done.code == 0, done.err
    assert done.out.strip() == str(page)
    assert "scaled to 64 × 64" in done.err
    state = page_data(page)["state"]
    assert state["technique"] == "steep"
    assert state["settings"]["steep"]["steps"] == 9
    assert (state["shape"], state["heights"], state["edge"]) == ("cylinder", "smooth", "clamp")
    assert (state["fog_mode"], state["fog"]["fog_end"]) == ("linear", 7.0)
    assert (state["surface"], state["shadows"]) == ("landscape", "soft")
    assert state["tilings"]["normal"]["tiles"] == [2.0, 3.0]
    (light,) = state["lights"]
    assert (light["kind"], light["angle"], light["intensity"]) == ("spot", 50.0, 3.0)
    assert (state["camera"]["azimuth"], state["camera"]["elevation"]) == (10.0, 20.0)


@pytest.mark.usefixtures("without_stills")
def test_options_of_reading_are_on_the_page(tmp_path: Path) -> None:
    ramp = np.linspace(0, 255, 32).astype(np.uint8)[None, :, None].repeat(32, 0)
    write_data(tmp_path / "wall_height.png", ramp)
    page = tmp_path / "page.html"
    done = run(
        "view", tmp_path, "-o", page, "--height-polarity", "depth", "--stretch-height",
        "--layer", "sample:gravel", "--device", "cpu",
    )  # fmt: skip
    assert done.code == 0, done.err
    data = page_data(page)
    # a page says nothing of the folders above
    assert data["source"] == tmp_path.name
    assert data["relative"] == [tmp_path.name]
    assert data["reading"] == {"height_polarity": "depth", "stretch_height": True}
    assert data["layerSource"] == "sample:gravel"
    assert data["state"]["layer"] is True


@pytest.mark.usefixtures("without_stills")
def test_a_wall_is_one_on_the_page(tmp_path: Path) -> None:
    page = tmp_path / "page.html"
    done = run("view", "sample:noise", "-o", page, "--texels", "32", "--turn", "x/90", "--stretch",
               "1,1,0.5", "--device", "cpu")  # fmt: skip
    assert done.code == 0, done.err
    shapes = page_data(page)["shapes"]
    assert shapes["plane"]["placement"] == {"stretch": "1,1,0.5", "turn": "x/90"}
    # a camera may look up at it; other shapes are where they always are
    assert not shapes["plane"]["lying"]
    assert shapes["box"]["placement"] is None


@pytest.mark.parametrize(
    ("options", "line"),
    [
        (["--texels", "0"], "--texels 0: give at least 1"),
        (["--light", "none", "--light", "point,position=1/1/1"], "or give none alone"),
        (["-o", "page.png"], "--output page.png: name an HTML file"),
        (["--add", "sphere"], "No such option"),
        (["--technique", "warp"], "warp"),
        (["--camera", "distance=0"], "distance"),
    ],
)
def test_impossible_options_are_refused(tmp_path: Path, options: list[str], line: str) -> None:
    page = tmp_path / "page.html"
    assert line in refused("view", "sample:bricks", "-o", page, *options)
    assert not page.exists()


@pytest.mark.usefixtures("without_stills")
def test_samples_are_named_and_no_lights_are_none(tmp_path: Path) -> None:
    page = tmp_path / "page.html"
    done = run(
        "view", "sample:noise", "-o", page, "--preset", "habrador", "--texels", "64", "--light",
        "none", "--device", "cpu",
    )  # fmt: skip
    assert done.code == 0, done.err
    data = page_data(page)
    assert (data["source"], data["layerSource"]) == ("sample:noise", "sample:stone")
    assert data["state"]["lights"] == []


@pytest.mark.usefixtures("without_stills")
@pytest.mark.parametrize("opens", [True, False])
def test_without_a_file_the_page_is_opened(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], opens: bool
) -> None:
    import webbrowser

    from basrelief.cli import main

    opened: list[str] = []
    monkeypatch.setattr(webbrowser, "open", lambda url: opened.append(url) or opens)
    monkeypatch.setattr(
        "sys.argv", ["basrelief", "view", "sample:bricks", "--texels", "64", "--device", "cpu"]
    )
    with pytest.raises(SystemExit) as exit_info:
        main.main()
    assert not exit_info.value.code
    output = capsys.readouterr()
    page = Path(output.out.strip())
    assert page.is_file()
    assert ("no browser could be opened" in output.err) != opens
    assert opened == [page.resolve().as_uri()]
