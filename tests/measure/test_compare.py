"""`compare`: numbers as computed directly, a page without network, a stable JSON."""

from __future__ import annotations

import json
import re
import shlex
import sys

import numpy as np
import pytest

import basrelief
from basrelief.errors import InputError
from basrelief.material import Material
from basrelief.measure.advice import Advice, advice
from basrelief.measure.compare import Comparison, compare
from basrelief.measure.debug import debug_picture
from basrelief.measure.errors import errors, flip, missed, overshoot
from basrelief.measure.plot import Point, front
from basrelief.measure.report import error_picture
from basrelief.measure.truth import truth
from basrelief.measure.views import at_angle
from basrelief.rendering.render import render
from basrelief.techniques import TECHNIQUES
from helpers.command_line import done, refused, write_heights, write_material
from helpers.repository import blocks, commands
from helpers.synthetic import map_of, noise, uniform_material

SIZE = (48, 27)
ANGLES = (0.0, 60.0)
CHOSEN = ("flat", "steep", "offset", "steep,steps=40")


@pytest.fixture(scope="module")
def waves() -> Material:
    return Material(
        "waves & <sea>",
        base_color=map_of(noise(3, (32, 32))),
        height=map_of(noise(7, (32, 32), 1)),
    )


@pytest.fixture(scope="module")
def comparison(waves) -> Comparison:
    return compare(
        waves, CHOSEN, angles=ANGLES, size=SIZE, samples=1, device="cpu", runs=1, scale=0.2
    )


# --- measurements -----------------------------------------------------------------------------


def test_every_technique_is_compared(waves) -> None:
    """B4: all techniques that draw the bilinear surface; `exact` misses no hit. Techniques of
    columns are refused."""
    shares: list[float] = []
    whole = compare(
        waves, angles=[70], size=(16, 9), samples=1, device="cpu", runs=1,
        progress=lambda what, share: shares.append(share),
    )  # fmt: skip
    columns = {name for name, technique in TECHNIQUES.items() if technique.columns}
    assert set(whole.objects) == set(TECHNIQUES) - columns
    for name in columns:
        with pytest.raises(InputError, match=f"{name} draws columns"):
            compare(waves, [name], angles=[70], size=(16, 9), device="cpu")
    assert shares == sorted(shares)
    assert shares[-1] == 1.0
    (exact,) = whole.of("exact")
    assert exact.errors.missed == 0.0
    assert exact.flip == 0.0


def test_times_are_measured_while_nothing_else_runs(waves, monkeypatch) -> None:
    """An error in one of the threads that evaluate pictures reaches the caller."""
    running: list[str] = []

    def tracked(function, name):
        def call(*args, **kwargs):
            assert not (name == "seconds_of" and running)
            running.append(name)
            try:
                return function(*args, **kwargs)
            finally:
                running.remove(name)

        return call

    for name in ("seconds_of", "truth", "render", "errors", "flip"):
        function = getattr(sys.modules["basrelief.measure.compare"], name)
        monkeypatch.setattr(f"basrelief.measure.compare.{name}", tracked(function, name))
    options = {"size": (16, 9), "samples": 1, "device": "cpu", "runs": 1}
    compare(waves, CHOSEN, angles=[0, 30, 60], **options)

    def fail(*args):
        raise InputError("the disc is full")

    monkeypatch.setattr("basrelief.measure.compare.errors", fail)
    with pytest.raises(InputError, match="the disc is full"):
        compare(waves, CHOSEN, angles=[0, 30, 60], **options)


def test_numbers_are_those_computed_directly(waves, comparison) -> None:
    """B4: each result, computed again from the library's parts."""
    assert {result.technique for result in comparison.results} == {
        "flat", "steep", "offset", "exact", "steep steps=40",
    }  # fmt: skip
    for angle in ANGLES:
        scenes = {
            name: at_angle(
                waves, angle, SIZE,
                {"technique": name.split()[0], "settings": settings, "scale": 0.2},
            )
            for name, settings in (
                ("exact", {}), ("flat", {}), ("offset", {}), ("steep", {}),
                ("steep steps=40", {"steps": 40}),
            )
        }  # fmt: skip
        frames = {n: render(s, size=SIZE, samples=1, device="cpu") for n, s in scenes.items()}
        true = truth(scenes["exact"], SIZE, device="cpu")
        for result in comparison.at(angle):
            assert result.errors == errors(frames[result.technique], true)
            assert result.flip == flip(frames["exact"], frames[result.technique])
            assert result.seconds > 0.0
    by_name = {result.technique: result for result in comparison.at(60.0)}
    assert by_name["flat"].errors.short > 0.8
    assert by_name["steep steps=40"].errors.uv.median < by_name["steep"].errors.uv.median
    assert all(result.flip == 0.0 for result in comparison.at(0.0))


def test_one_technique_with_several_settings_and_settings_for_all(waves) -> None:
    tiny = {"angles": [50], "size": (16, 9), "samples": 1, "device": "cpu", "runs": 1}
    comparison = compare(waves, ["relief,max_steps=12,search_steps=1", "steep"],
                   settings={"steps": 5, "search_steps": 3}, **tiny)  # fmt: skip
    settings = {entry["name"]: entry["settings"] for entry in comparison.to_dict()["techniques"]}
    assert settings["steep"] == {"steps": 5}
    relief = settings["relief max_steps=12 search_steps=1"]
    assert relief == {"min_steps": 8, "max_steps": 12, "search_steps": 1}
    for wrong, words in (
        (["steep", "steep"], "twice"),
        (["steep,depth=3"], "no setting 'depth'; it has steps"),
        (["steep,steps"], "write a technique and its settings"),
        (["leap"], "no technique is called 'leap'"),
    ):
        with pytest.raises(InputError, match=words):
            compare(waves, wrong, **tiny)
    with pytest.raises(InputError, match="none of these techniques"):
        compare(waves, ["steep"], settings={"search_steps": 3}, **tiny)
    with pytest.raises(InputError, match="shape: a comparison sets it itself"):
        compare(waves, ["steep"], shape="box", **tiny)


def test_a_material_without_heights_is_refused(tmp_path) -> None:
    with pytest.raises(InputError, match="no height map"):
        compare(uniform_material())
    folder = write_material(tmp_path / "wall")
    (folder / "wall_Height.png").unlink()
    for command in (["compare"], ["tune", "--missed", "1%"]):
        message = refused(*command, folder, "-o", tmp_path / "out.toml")
        assert "has no height map" in message
        assert "--height FILE" in message
    assert not (tmp_path / "out.toml").exists()


# --- files ----------------------------------------------------------------------------------

KEYS = {
    "format", "version", "basrelief", "material", "texels", "scale", "device", "size", "samples",
    "time", "angles", "visible", "techniques", "results", "advice", "filter", "filtered_format",
}  # fmt: skip
RESULT = {
    "angle", "technique", "pixels", "missed", "passed", "short", "wrong_light", "uv_error",
    "depth_error", "flip", "reads", "seconds",
}  # fmt: skip


def test_the_json_has_all_keys_and_numbers(comparison, tmp_path) -> None:
    """B4: version 2 of compare.json."""
    comparison.save(tmp_path / "out")
    read = json.loads((tmp_path / "out" / "compare.json").read_text("utf-8"))
    assert set(read) == KEYS
    assert (read["format"], read["version"]) == ("basrelief compare", 2)
    assert read["basrelief"] == basrelief.__version__
    assert (read["texels"], read["size"], read["angles"]) == ([32, 32], [48, 27], [0.0, 60.0])
    assert read["time"] == {"size": [48, 27], "by": "clock", "runs": 1}
    assert (read["filter"], read["filtered_format"]) == ("texel", None)
    assert len(read["results"]) == len(comparison.results) == 10
    for entry, result in zip(read["results"], comparison.results, strict=True):
        assert set(entry) == RESULT
        assert set(entry["uv_error"]) == set(entry["depth_error"])
        assert set(entry["uv_error"]) == {"median", "percentile_99", "worst"}
        assert (entry["angle"], entry["technique"]) == (result.angle, result.technique)
        assert entry["missed"] == result.errors.missed
        assert entry["uv_error"]["percentile_99"] == result.errors.uv.percentile_99
        assert (entry["flip"], entry["seconds"]) == (result.flip, result.seconds)
    assert {result["name"] for result in read["techniques"]} == set(comparison.objects)
    assert set(read["techniques"][0]) == {
        "name", "technique", "settings", "reference_height", "projection", "command",
    }  # fmt: skip
    assert read["advice"]["technique"] in comparison.objects


@pytest.mark.gpu
def test_the_filter_of_the_heights_is_reported(waves, tmp_path) -> None:
    """By the page, the summary and the JSON; `exact` and the truth read texels."""
    tiny = {"angles": [60], "size": SIZE, "samples": 1, "device": "gpu", "runs": 1, "scale": 0.2}
    by_texels, by_filter = (
        compare(waves, ["relief"], filter=filter, **tiny) for filter in ("texel", "hardware")
    )
    assert by_filter.filter_text == (
        "Heights are filtered by the graphics card (r32float), except by exact, which reads texels."
    )
    assert by_filter.summary().endswith(f"ms a picture). {by_filter.filter_text}")
    assert "filtered" not in by_texels.summary()
    read = by_filter.to_dict()
    assert (read["filter"], read["filtered_format"]) == ("hardware", "r32float")
    commands = {entry["name"]: entry["command"] for entry in read["techniques"]}
    assert "--filter hardware" in commands["relief"]
    assert "--filter" not in commands["exact"]
    page = " ".join(by_filter.save(tmp_path / "hardware").read_text("utf-8").split())
    assert by_filter.filter_text in page
    assert "with the techniques. Times are those" in page
    page = " ".join(by_texels.save(tmp_path / "texel").read_text("utf-8").split())
    assert "Heights are read as texels and interpolated by the shaders. Times are those" in page
    (texels, filtered), (exact, also_exact) = (
        (*by_texels.of(name), *by_filter.of(name)) for name in ("relief", "exact")
    )
    assert texels.errors.missed == pytest.approx(filtered.errors.missed, abs=0.01)
    assert exact.errors == also_exact.errors
    np.testing.assert_array_equal(exact.picture, also_exact.picture)


def test_the_page_is_self_contained(comparison, tmp_path) -> None:
    """B4: it needs no network, every picture exists, and names are escaped."""
    page = comparison.save(tmp_path / "out")
    text = page.read_text("utf-8")
    assert "http" not in text.replace("http-equiv", "")
    assert "<script" not in text
    assert "waves &amp; &lt;sea&gt;" in text
    pictures = set(re.findall(r'src="([^"]+)"', text))
    pictures |= set(re.findall(r'srcset="([^"]+)"', text))
    # the plots, light and dark, and the pictures of the results
    assert len(pictures) == 2 * len(comparison.results) + 2
    assert all((page.parent / picture).is_file() for picture in pictures)
    for name in comparison.objects:
        headings = re.findall(rf"<h3[^>]*>{name}(?:, the true picture)?</h3>", text)
        assert len(headings) == len(ANGLES)
    again = comparison.save(tmp_path / "out")
    assert again == page
    page.write_text("my own")
    with pytest.raises(InputError, match="exists and is not a comparison's page"):
        comparison.save(tmp_path / "out")


def test_without_flip_the_other_numbers_are_reported(waves, tmp_path, monkeypatch) -> None:
    monkeypatch.setitem(sys.modules, "flip_evaluator", None)
    comparison = compare(
        waves, ["flat"], angles=[60], size=(16, 9), samples=1, device="cpu", runs=1
    )
    assert [result.flip for result in comparison.results] == [None, None]
    assert "FLIP" not in comparison.save(tmp_path / "out").read_text("utf-8").split("<footer>")[0]
    assert advice(comparison).technique == "exact"


def test_without_matplotlib_the_page_names_what_to_install(
    comparison, tmp_path, monkeypatch
) -> None:
    assert "needs matplotlib" not in comparison.save(tmp_path / "with").read_text("utf-8")
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    page = comparison.save(tmp_path / "out")
    text = page.read_text("utf-8")
    line = "The plot of error against time needs matplotlib: pip install &#39;basrelief[plots]&#39;"
    assert text.replace("'", "&#39;").count(line) == 1
    assert "time.svg" not in text
    assert len(list((page.parent / "pictures").iterdir())) == 2 * len(comparison.results)


def test_error_pictures_are_dark_without_errors() -> None:
    low, middle, high, above, none = error_picture(
        np.array([[0.01, 3.0, 100.0, 1e4, np.nan]], np.float16)
    )[0]
    assert low.sum() < middle.sum() < high.sum()
    np.testing.assert_array_equal(low, none)
    np.testing.assert_array_equal(high, above)


def test_the_pareto_front() -> None:
    points = [
        Point("slow and good", 9.0, 0.1), Point("fast", 1.0, 0.9), Point("beaten", 5.0, 0.6),
        Point("middling", 4.0, 0.5), Point("as slow and worse", 9.0, 0.2),
    ]  # fmt: skip
    assert [p.name for p in front(points)] == ["fast", "middling", "slow and good"]


# --- the advice ----------------------------------------------------------------------------------


def test_the_advice_is_the_cheapest_that_passes_everywhere(comparison) -> None:
    """B5: results made by hand: fast techniques fail at 60 degrees, two slower ones pass."""
    errors_of = comparison.results[0].errors
    cost = {"flat": 1.0, "offset": 2.0, "steep": 3.0, "steep steps=40": 4.0, "exact": 5.0}
    passing = {
        "flat": (0.0, 0.9), "offset": (0.02, 0.5), "steep": (0.01, 0.2),
        "steep steps=40": (0.0, 0.03), "exact": (0.0, 0.0),
    }  # fmt: skip

    def with_flip(passing) -> Comparison:
        from dataclasses import replace

        return replace(
            comparison,
            results=tuple(
                replace(
                    result, errors=errors_of, seconds=cost[result.technique],
                    flip=passing[result.technique][ANGLES.index(result.angle)],
                )
                for result in comparison.results
            ),
        )  # fmt: skip

    assert advice(with_flip(passing)) == Advice("steep steps=40", 4.0, None, None, None)
    worse = {**passing, "steep steps=40": (0.0, 0.031)}
    assert advice(with_flip(worse)) == Advice("exact", 5.0, None, None, None)
    summary = with_flip(passing).summary()
    assert summary.startswith("Ship steep steps=40: ")
    assert "up to 60°" in summary


# --- debug pictures ------------------------------------------------------------------------------


def test_debug_pictures_have_the_documented_colours(waves) -> None:
    """B9: missed hits have their colours, more reads are paler, overshoot has a sign."""
    size = (64, 48)
    scene = at_angle(waves, 65.0, size, {"technique": "steep", "scale": 0.3})
    frame, true = render(scene, size=size, samples=1, device="cpu"), truth(scene, size)
    is_missed, behind = missed(frame, true), overshoot(frame, true) > 0.0
    picture = debug_picture("missed", frame, true)
    orange = picture.image.pixels[:, :, 0] > 2.0 * picture.image.pixels[:, :, 2]
    np.testing.assert_array_equal(orange, is_missed & behind)
    assert f"{errors(frame, true).missed:.2%}" in picture.meaning

    reads = debug_picture("reads", frame)
    body = np.s_[:44]
    light = reads.image.pixels[body].sum(-1)
    counts = frame.reads[body]
    means = [light[counts == n].mean() for n in np.unique(counts)]
    assert len(means) > 3
    assert means == sorted(means)
    assert "from 0 (dark) to" in reads.meaning

    signed = debug_picture("overshoot", frame, true).image.pixels[body]
    far = behind[body] & (np.abs(overshoot(frame, true)[body]) > 2.0)
    assert (signed[far][:, 0] > signed[far][:, 2]).all()
    depth = debug_picture("depth-error", frame, true)
    assert "world units" in depth.meaning
    # both ends of the scale along the lower edge
    left, right = depth.image.pixels[-1, 0], depth.image.pixels[-1, -1]
    assert left[2] > left[0]
    assert right[0] > right[2]


def test_debug_pictures_of_an_exact_frame_are_dark(waves) -> None:
    size = (40, 40)
    scene = at_angle(waves, 65.0, size, {"technique": "exact", "scale": 0.3})
    frame, true = render(scene, size=size, samples=1, device="cpu"), truth(scene, size)
    assert "0.00%" in debug_picture("missed", frame, true).meaning
    for wrong in (("colour", true), ("missed", None)):
        with pytest.raises(InputError):
            debug_picture(wrong[0], frame, wrong[1])


# --- examples of the documentation ----------------------------------------------------------------


@pytest.mark.gpu
@pytest.mark.parametrize(
    "page", ["README.md", "docs/compare.md", "docs/command-line.md", "docs/write-a-technique.md"]
)
def test_commands_that_pages_show(page, tmp_path, monkeypatch) -> None:
    """Each comparison and each search runs, but small and with few techniques."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("basrelief.measure.tune.ANGLE_STEP", 90.0)
    write_heights(tmp_path / "FOLDER")
    (tmp_path / "my.py").write_text(
        next(block for block in blocks("docs/write-a-technique.md") if "@technique" in block)
    )
    ran = 0
    for line in commands(page):
        words = shlex.split(line.replace("sample:cobbles", "FOLDER"))[1:]
        if words[0] not in ("compare", "tune"):
            continue
        words += ["--size", "16x9"]
        # what needs a GPU says so
        words += [] if "--device" in words else ["--device", "cpu"]
        if "--technique" not in words:
            words += ["--technique", "exact", "--technique", "flat"]
        if words[0] == "compare":
            words += ["--samples", "1", "--angles", "60"]
        output = done(*words)
        written = re.search(r"^(\S+)  \([cg]pu", output, flags=re.MULTILINE)
        assert written is not None
        assert (tmp_path / written[1]).is_file()
        ran += 1
    assert ran


def test_python_that_the_page_shows(tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("basrelief.measure.tune.ANGLE_STEP", 40.0)
    scope: dict[str, object] = {}
    for block in blocks("docs/compare.md"):
        exec(compile(block, "docs/compare.md", "exec"), scope)
    assert {file.name for file in tmp_path.iterdir()} == {"OUT", "cobbles.toml", "overshoot.png"}


# --- the command line ----------------------------------------------------------------------------


def test_compare_on_the_command_line(tmp_path) -> None:
    folder = write_heights(tmp_path / "hills")
    out = done(
        "compare", folder, "-o", tmp_path / "out", "--technique", "steep", "--technique",
        "relief,max_steps=9", "--set", "steps=7", "--angles", "30,60", "--size", "20x12",
        "--samples", "1", "--scale", "0.2", "--device", "cpu",
    )  # fmt: skip
    assert out.startswith("Ship ")
    assert str(tmp_path / "out" / "index.html") in out
    read = json.loads((tmp_path / "out" / "compare.json").read_text())
    assert [entry["name"] for entry in read["techniques"] if entry["settings"] == {"steps": 7}] == [
        "steep"
    ]
    assert read["angles"] == [30.0, 60.0]
    assert read["scale"] == 0.2
    assert "0 × 9: give 1 to" in refused("compare", folder, "--size", "0x9")
    assert "an angle of 95" in refused("compare", folder, "--angles", "95", "--device", "cpu")


def test_show_on_the_command_line(tmp_path) -> None:
    """B9: every debug picture, and what its colours mean."""
    folder = write_heights(tmp_path / "hills")
    small = ["--size", "32x24", "--samples", "1", "--device", "cpu"]
    for what, words in (
        ("reads", "heights read in a pixel"), ("missed", "missed hits: "),
        ("overshoot", "texels"), ("depth-error", "world units"),
    ):  # fmt: skip
        target = tmp_path / f"{what}.png"
        out = done("render", folder, "--show", what, "-o", target, *small)
        assert words in out
        assert target.is_file()
    assert "color, reads, missed" in refused("render", folder, "--show", "depth", *small)
    assert "one plane" in refused("render", folder, "--show", "missed", "--shape", "box", *small)
    assert "--frames" in refused("render", folder, "--show", "reads", "--frames", "3", *small)
