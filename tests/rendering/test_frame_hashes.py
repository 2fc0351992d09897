"""The CPU's frames match the digests in `frame_hashes.json`; see `frame_hashes.py`."""

from __future__ import annotations

import itertools
from dataclasses import fields
from typing import Any, get_args, get_type_hints

import numpy as np
import pytest

from basrelief import Frame, InputError, Map, Material, Object, Scene
from basrelief.engine.gpu import GpuEngine
from basrelief.rendering.programs import depth_program_of, frame_program_of
from basrelief.settings import settings_of
from helpers.frame_cases import ALL_TECHNIQUES, CASES, MENUS, OTHER_OPTIONS, SHAPES, drawn, scene_of
from helpers.frame_hashes import PLANES, STORE, digests, stored, text


@pytest.mark.parametrize("case", CASES, ids=str)
def test_frames_have_the_stored_bytes(case: str) -> None:
    expected = stored().get(case)
    assert expected, f"{case}: no stored digests; store them as helpers/frame_hashes.py says"
    actual = digests(drawn(case))
    changed = [plane for plane in PLANES if actual[plane] != expected[plane]]
    assert not changed, (
        f"{case}: other bytes in {', '.join(changed)}; where that is meant, store them as "
        "helpers/frame_hashes.py says, and say why in the commit"
    )


def test_the_store_has_the_cases_and_no_others_in_order() -> None:
    assert len(set(CASES)) == len(CASES)
    assert sorted(CASES) == list(stored())
    assert STORE.read_text(encoding="utf-8") == text(stored())


@pytest.mark.gpu
def test_the_programs_of_all_cases_compile_on_a_gpu() -> None:
    """Every pair of options then compiles on both engines, as the CPU draws all cases."""
    engine = GpuEngine()
    scenes = [scene_of(case) for case in CASES]
    programs = [frame_program_of(obj.resolved, scene) for scene in scenes for obj in scene.objects]
    casting = [scene for scene in scenes if scene.casts]
    programs += [depth_program_of(obj.resolved) for scene in casting for obj in scene.objects]
    distinct = {program.key: program for program in programs}
    assert len(distinct) > 140
    for program in distinct.values():
        engine.compile(program)


# --- the digests ----------------------------------------------------------------------------------


@pytest.mark.parametrize("plane", PLANES)
def test_a_digest_changes_with_any_bit_of_its_own_plane_alone(plane: str) -> None:
    frame = drawn("relief plane")
    bits = getattr(frame, plane).copy().view(np.uint8)
    bits[-1, -1] ^= 1
    planes = {name: getattr(frame, name) for name in PLANES}
    planes[plane] = bits.view(planes[plane].dtype)
    other = Frame(**planes, device=frame.device)
    one, two = digests(frame), digests(other)
    assert [name for name in PLANES if one[name] != two[name]] == [plane]


def zeros(size: tuple[int, int], sign: float = 1.0) -> Frame:
    height, width = size
    return Frame(
        np.zeros((height, width, 4), np.float32),
        np.full(size, sign * 0.0, np.float32),
        np.zeros((height, width, 2), np.float32),
        np.zeros(size, np.bool_),
        np.zeros(size, np.int32),
        "none",
    )


def test_digests_distinguish_sizes_and_signs_of_zero() -> None:
    assert digests(zeros((2, 3))) != digests(zeros((3, 2)))
    assert digests(zeros((2, 3)))["distance"] != digests(zeros((2, 3), -1.0))["distance"]


def test_nan_is_not_stored() -> None:
    frame = zeros((2, 3))
    frame.uv[1, 2, 0] = np.nan
    with pytest.raises(AssertionError, match="NaN in uv"):
        digests(frame)


# --- the cases ------------------------------------------------------------------------------------


def menus() -> dict[str, tuple[str, ...]]:
    """Options of each menu, with its default as the empty name."""
    options = {name: ("", *menu) for name, menu in MENUS.items()}
    return {"technique": tuple(ALL_TECHNIQUES), "shape": tuple(SHAPES), **options}


def options_of(case: str) -> dict[str, str]:
    """Option of a case from each menu."""
    technique, shape, *options = case.split()
    of_menus = {menu: [name for name in options if name in MENUS[menu]] for menu in MENUS}
    assert all(len(names) <= 1 for names in of_menus.values()), f"{case}: two options of one menu"
    chosen = {menu: names[0] if names else "" for menu, names in of_menus.items()}
    return {"technique": technique, "shape": shape, **chosen}


def is_valid_pair(first: tuple[str, str], second: tuple[str, str]) -> bool:
    """Whether the library accepts two options together."""
    case = {"technique": "relief", "shape": "plane", **dict([first, second])}
    try:
        scene_of(" ".join(case.values()))
    except InputError:
        return False
    return True


def test_every_pair_of_options_is_in_a_case() -> None:
    covered = {
        pair for case in CASES for pair in itertools.combinations(options_of(case).items(), 2)
    }
    missing = [
        (first, second)
        for one, other in itertools.combinations(menus(), 2)
        for first in itertools.product([one], menus()[one])
        for second in itertools.product([other], menus()[other])
        if (first, second) not in covered and is_valid_pair(first, second)
    ]
    assert not missing, f"in no case together: {missing}"


@pytest.mark.parametrize("option", OTHER_OPTIONS)
def test_options_of_no_menu_are_in_a_case(option: str) -> None:
    assert any(option in case.split() for case in CASES)


def objects() -> list[Object]:
    """The objects of all cases."""
    return [obj for case in CASES for obj in scene_of(case).objects]


def menu_values(record: type) -> dict[str, set[Any]]:
    """Allowed values of the choices of a record."""
    return {name: {*s.choices} for name, s in settings_of(record).items() if s.choices}


def test_every_value_of_the_librarys_menus_is_drawn() -> None:
    drawn_records = {Scene: [scene_of(case) for case in CASES], Object: objects()}
    # the cases are drawn by the CPU, which has no filter of its own
    of_gpus = {("filter", "hardware")}
    for record, names in ((Object, {"projection", "edge"}), (Scene, {"fog_mode", "shadows"})):
        allowed = menu_values(record)
        assert names <= set(allowed)
        for name, values in allowed.items():
            missing = values - {getattr(one, name) for one in drawn_records[record]}
            missing = {value for value in missing if (name, value) not in of_gpus}
            assert not missing, f"{name}: {missing} in no case"


def test_every_map_is_present_in_a_case_and_missing_in_another() -> None:
    hints = get_type_hints(Material)
    maps = [field.name for field in fields(Material) if Map in get_args(hints[field.name])]
    # no shader reads it, and the heights of a hole differ by a bit between processors
    maps.remove("dust")
    assert len(maps) == 9
    for name in maps:
        assert {getattr(obj.material, name) is None for obj in objects()} == {True, False}, name
