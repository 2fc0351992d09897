"""The key of a program depends on its contents and on nothing else."""

from __future__ import annotations

import subprocess
import sys

import pytest

from basrelief.lang.program import Program
from helpers.comparing import cpu, write_module

SOURCE = '''
SCALE = 2.0
STEPS = 3

@struct
class Settings:
    gain: float = 1.0
    steps: int = 4

@struct
class Result:
    x: float
    n: int

@shader
def first(x: float) -> float:
    """Some words."""
    # a comment
    return x * SCALE

@shader
def second(x: float) -> float:
    return x + 0.25

@shader
def third(x: float) -> float:
    return x + 0.75

@slot
def choice(x: float) -> float: ...

@shader
def entry(pixel: IVec2, settings: Settings) -> Result:
    x = first(float(pixel.x)) * settings.gain
    for k in range(STEPS):
        x = x - 0.125
    return Result(choice(x) + second(x) + third(x), settings.steps)
'''


def key_of(module, choice="second", **options):
    bindings = {module.choice: getattr(module, choice)}
    return Program(module.entry, bindings, **options).key


@pytest.fixture(scope="module")
def key(folder):
    return key_of(write_module(folder, SOURCE))


def test_the_same_text_elsewhere_has_the_same_key(folder, key, tmp_path):
    assert key_of(write_module(tmp_path, SOURCE)) == key
    assert key_of(write_module(folder, "\n\n# moved down\n" + SOURCE)) == key


def test_comments_and_blank_lines_change_nothing(folder, key):
    changed = SOURCE.replace("    # a comment\n", "\n    # other words\n\n")
    changed = changed.replace("x = x - 0.125", "x = x - 0.125  # down")
    assert changed != SOURCE
    assert key_of(write_module(folder, changed)) == key


def test_reference_counts_change_nothing(folder, key):
    """More references to an object of the program leave its key as it is."""
    module = write_module(folder, SOURCE)
    references = [list(f.function.__code__.co_consts) for f in (module.first, module.entry)]
    references.append(module.entry.function.__code__.co_code)
    assert key_of(module) == key
    assert references


@pytest.mark.parametrize("change", [
    ("x - 0.125", "x - 0.126"),
    ("x * SCALE", "x + SCALE"),
    ("SCALE = 2.0", "SCALE = 2.5"),
    ("SCALE = 2.0", "SCALE = -0.0"),
    ("STEPS = 3", "STEPS = 4"),
    ("return x + 0.25", "return x + 0.5"),
    ("return x * SCALE", "return second(x) * SCALE"),
    ("gain: float = 1.0", "gain: float = 1.5"),
    ("steps: int = 4", "steps: int = 5"),
    ("    gain: float", "    loss: int = 1\n    gain: float"),
    ("class Result:\n    x: float\n    n: int", "class Result:\n    y: float\n    n: int"),
    ("range(STEPS)", "range(1, STEPS)"),
    ("choice(x) + second(x)", "second(x) + choice(x)"),
    ("settings.gain", "float(settings.steps)"),
])  # fmt: skip
def test_a_change_changes_the_key(folder, key, change):
    assert change[0] in SOURCE
    assert key_of(write_module(folder, SOURCE.replace(*change))) != key


def test_minus_zero_is_not_zero(folder):
    zeros = [SOURCE.replace("SCALE = 2.0", f"SCALE = {zero}") for zero in ("0.0", "-0.0", "0")]
    assert len({key_of(write_module(folder, text)) for text in zeros}) == 3


def test_bindings_change_the_key(folder):
    """Also if the entry calls both shaders itself."""
    module = write_module(folder, SOURCE)
    assert len({key_of(module, name) for name in ("first", "second", "third")}) == 3


def test_swapped_bindings_change_the_key(folder):
    module = write_module(
        folder,
        SOURCE
        + """
@slot
def other(x: float) -> float: ...

@shader
def both(pixel: IVec2) -> Result:
    x = float(pixel.x)
    return Result(second(x) + third(x) + choice(x) - other(x), 1)
""",
    )
    pairs = [("second", "third"), ("third", "second"), ("second", "second"), ("third", "third")]
    keys = {
        Program(
            module.both, {module.choice: getattr(module, a), module.other: getattr(module, b)}
        ).key
        for a, b in pairs
    }
    assert len(keys) == 4


def test_one_name_for_two_shaders(folder):
    """Modules may import different shaders under one name; the key tells them apart."""
    write_module(folder, SOURCE, "key_shaders")
    texts = [
        f"""
from key_shaders import second, third, Result
from key_shaders import {name} as alias

@shader
def inner(x: float) -> float:
    return alias(x)

@shader
def entry(pixel: IVec2) -> Result:
    x = second(float(pixel.x)) + third(1.0)
    return Result(x + inner(x), 1)
"""
        for name in ("second", "third")
    ]
    keys = {Program(write_module(folder, text).entry).key for text in texts}
    assert len(keys) == 2


def test_the_edge_changes_the_key(folder, key):
    assert key_of(write_module(folder, SOURCE), edge="clamp") != key


def test_other_processes_find_the_same_key_and_text(folder, key):
    """For any order of sets, with and without cached bytecode."""
    write_module(folder, SOURCE, "key_source")
    script = """
import hashlib, sys
import key_source as m
from basrelief.lang.llvm import print_llvm
from basrelief.lang.program import Program
from basrelief.lang.targets.wgsl import print_wgsl
program = Program(m.entry, {m.choice: m.second})
print(program.key)
text = print_llvm(program.module, 8) + print_wgsl(program.module, program.edge)
print(hashlib.sha256(text.encode()).hexdigest())
"""
    outputs = set()
    for seed in ("1", "2", "2"):
        done = subprocess.run(
            [sys.executable, "-c", script],
            env={"PYTHONHASHSEED": seed, "PYTHONPATH": str(folder)},
            capture_output=True,
            text=True,
            check=True,
        )
        outputs.add(done.stdout)
    assert len(outputs) == 1
    assert outputs.pop().splitlines()[0] == key


# --- values of names ------------------------------------------------------------------------------


def test_a_global_with_the_name_of_a_field_is_not_part_of_a_program(folder):
    """In the program `x` is a component; the module may use the name for something else."""
    module = write_module(folder, SOURCE)
    before = key_of(module)
    for value in (1.0, 2.0):
        module.x = value
        assert key_of(module) == before


def test_a_changed_number_changes_the_key_and_every_result(folder):
    text = (
        SOURCE.replace("SCALE = 2.0", "")
        + """
def enclosed():
    SCALE = 3.0

    @shader
    def first(x: float) -> float:
        return x * SCALE

    @shader
    def entry(pixel: IVec2) -> Result:
        return Result(first(5.0), 0)

    def set_to(value):
        nonlocal SCALE
        SCALE = value

    return entry, set_to
"""
    )
    entry, set_to = write_module(folder, text).enclosed()
    keys = set()
    for value in (3.0, 7.0, 3.0):
        set_to(value)
        program = Program(entry)
        keys.add(program.key)
        assert entry((0, 0)).x == 5.0 * value
        assert cpu().run(program, {}, (1, 1))["x"] == 5.0 * value
    assert len(keys) == 2


def test_an_enclosed_variable_may_be_set_later(folder):
    text = (
        SOURCE
        + """
def enclosed():
    @shader
    def entry(pixel: IVec2) -> Result:
        return Result(later, 0)

    early = Program(entry).key
    later = 4.0
    return entry, early
"""
    )
    text = "from basrelief.lang.program import Program\n" + text
    entry, early = write_module(folder, text).enclosed()
    assert Program(entry).key != early
    assert entry((0, 0)).x == 4.0


def test_three_hundred_programs_have_as_many_keys(folder):
    module = write_module(folder, SOURCE)
    keys = {}
    for number in range(300):
        module.SCALE = float(number)
        keys[number] = key_of(module)
    assert len(set(keys.values())) == 300
    module.SCALE = 7.0
    assert key_of(module) == keys[7]
