"""Static conditions: a program contains the branches that its variant takes, and no others."""

from __future__ import annotations

import itertools
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from basrelief.engine.cpu import CpuEngine
from basrelief.engine.gpu import GpuEngine
from basrelief.lang import HeightField, ShaderError, Texture, bound
from basrelief.lang.frontend import analyse
from basrelief.lang.library import library_of
from basrelief.lang.llvm import print_llvm
from basrelief.lang.program import Program
from basrelief.lang.targets.wgsl import print_wgsl
from helpers.comparing import write_module
from helpers.linking import linked
from helpers.refusals import refusal_in

SOURCE = '''
from typing import Literal

@static
class Variant:
    fog: Literal["none", "linear", "squared"]
    deep: bool
    walls: bool
    taps: Literal[1, 2, 4]

    @property
    def walled(self) -> bool:
        """Whether there are deep walls."""
        return self.walls and self.deep

@struct
class Air:
    density: float

@struct
class Result:
    x: float
    n: int
    sure: bool

@shader
def linear(x: float, air: Air) -> float:
    return x * air.density

@shader
def squared(x: float, air: Air) -> float:
    return linear(x, air) * linear(x, air)

@shader
def fogged(x: float, air: Air, variant: Variant) -> float:
    """Successive returns."""
    if variant.fog == "none":
        return x
    if variant.fog == "linear":
        return linear(x, air)
    return squared(x, air)

@shader
def height_of(field: HeightField, x: int) -> float:
    return corners(field, IVec2(x, 0), 0).x

@shader
def sampled(near: HeightField, far: HeightField, x: int, variant: Variant) -> float:
    """A selected resource, and loops that end early."""
    total = height_of(near if variant.deep else far, x)
    for k in range(9):
        if variant.taps == 1:
            break
        if k >= 2:
            if variant.taps != 4 or k >= 4:
                break
        total = total + float(k) * 0.25
    return total

@shader
def tinted(x: float, y: float) -> float:
    return x + y

@shader
def unread_part(x: float) -> float:
    return x * 100.0

@slot
def chosen(x: float, variant: Variant, air: Air) -> float: ...

@shader
def by_air(x: float, variant: Variant, air: Air) -> float:
    return x + air.density if variant.fog in ("linear", "squared") else x

@shader
def by_itself(x: float) -> float:
    return x * 3.0

@shader
def entry(
    pixel: IVec2, air: Air, near: HeightField, far: HeightField, variant: Variant
) -> Result:
    x = float(pixel.x) * 0.5
    # read in one branch only
    unread = unread_part(x)
    steep = x > 1.0
    if variant.walled:
        steep = steep and unread > 3.0
    elif variant.walls:
        shift = tinted(x, 0.5)
        x = x - shift * 0.125
    if variant.deep and x > 0.5:
        # deep enough
        x = x + sampled(near, far, pixel.x, variant)
    else:
        x = x * 2.0
    if variant.walls or x > 3.0:
        shift = tinted(x, 0.25)
        x = x + shift
    if not (variant.fog == "linear" and x < 7.0):
        n = 1 if variant.taps in (1, 2) else 5
    else:
        if variant.taps not in (2, 4):
            return Result(x, 9, variant.deep)
        n = 2
    x = fogged(chosen(x, variant, air), air, variant)
    return Result(x, n, variant.deep and steep or n > 4)
'''


@pytest.fixture(scope="module")
def module(folder: Path) -> Any:
    return write_module(folder, SOURCE)


def variants(module: Any) -> list[Any]:
    """All variants."""
    fields = (("none", "linear", "squared"), (False, True), (False, True), (1, 2, 4))
    return [module.Variant(*values) for values in itertools.product(*fields)]


def program(module: Any, variant: Any, made: str = "by_air") -> Program:
    return Program(module.entry, {module.chosen: getattr(module, made)}, variant=variant)


SIZE = (6, 1)


def values(module: Any) -> dict[str, Any]:
    near, far = (HeightField([np.arange(8).reshape(1, 8) * step]) for step in (0.125, -0.25))
    return {"air": module.Air(0.75), "near": near, "far": far}


def words(planes: dict[str, Any]) -> list[list[Any]]:
    return [planes[name][0].tolist() for name in ("x", "n", "sure")]


def in_python(module: Any, each: Program) -> list[list[Any]]:
    with bound(each.bindings):
        found = [
            module.entry((x, 0), **values(module), variant=each.variant) for x in range(SIZE[0])
        ]
    return [[getattr(f, name).item() for f in found] for name in ("x", "n")] + [
        [int(f.sure) for f in found]
    ]


def test_python_and_cpu_agree_on_every_variant(module: Any) -> None:
    engine = CpuEngine()
    seen = set()
    for variant, made in itertools.product(variants(module), ("by_air", "by_itself")):
        each = program(module, variant, made)
        expected = in_python(module, each)
        assert words(engine.run(each, values(module), SIZE)) == expected, variant
        seen.add(str(expected))
    assert len(seen) > 30


@pytest.mark.gpu
def test_python_gpu_and_linked_programs_agree_on_every_variant(module: Any) -> None:
    """Also for a library, with its static text marked, and linked."""
    options = {module.chosen: [module.by_air, module.by_itself]}
    library = library_of([module.entry], options)
    engine = GpuEngine()
    for number, variant in enumerate(variants(module)):
        made = ("by_air", "by_itself")[number % 2]
        each = program(module, variant, made)
        expected = in_python(module, each)
        assert words(engine.run(each, values(module), SIZE)) == expected, variant
        text = linked(library, each)
        with engine.prepare_text(
            text, each, values(module), SIZE, library.bindings["entry"]
        ) as job:
            job.dispatch(0, 1)
            planes = job.read(1)
        assert planes[0].view(np.float32)[0].tolist() == expected[0], variant
        assert planes[1:, 0].tolist() == expected[1:], variant


# --- branches that are not taken -----------------------------------------------------------------


def declared(text: str) -> set[str]:
    """Names of the functions in a text."""
    return set(re.findall(r"(?:\bfn |define [^@]*@)([\w.]+)\(", text))


@pytest.mark.parametrize("target", ["wgsl", "llvm", "linked"])
def test_branches_that_are_not_taken_are_absent(module: Any, target: str) -> None:
    library = library_of([module.entry], {module.chosen: [module.by_itself]})

    def text_of(*values: Any) -> str:
        variant = module.Variant(*values)
        made = program(module, variant, "by_itself")
        if target == "llvm":
            return print_llvm(made.module, 8)
        if target == "linked":
            return linked(library, made)
        return print_wgsl(made.module, "wrap")

    minimal = text_of("none", False, False, 1)
    absent = {"sampled", "height_of", "linear", "squared"}
    # a linker decides conditions; the driver removes variables that nothing reads
    absent |= set() if target == "linked" else {"unread_part"}
    assert not declared(minimal) & absent
    assert "corners" not in minimal
    assert {"fogged", "tinted"} <= declared(minimal)
    full = text_of("squared", True, True, 4)
    names = {"sampled", "height_of", "linear", "squared", "fogged", "tinted", "unread_part"}
    assert names <= declared(full)
    assert not re.search(r"\b[Vv]ariant\b", minimal + full)
    assert "deep enough" in full
    assert "deep enough" not in minimal


def test_a_program_passes_and_binds_only_live_parameters(module: Any) -> None:
    def of(*values: Any) -> tuple[list[str], str]:
        made = program(module, module.Variant(*values), "by_itself").module
        return list(made.entry.parameters), print_wgsl(made, "wrap")

    parameters, text = of("none", False, False, 1)
    assert parameters == ["pixel"]
    assert "fn fogged(x: f32) -> f32 {\n  return x;\n}" in text
    assert "Air" not in text
    assert "unread" not in text
    assert "steep" not in text
    parameters, text = of("linear", False, True, 1)
    assert parameters == ["pixel", "air"]
    assert "fn fogged(x: f32, air: Air) -> f32 {\n  return linear(x, air);\n}" in text
    # a variable of one branch is declared where the branch was
    assert "var shift: f32;" not in text
    parameters, text = of("none", True, True, 4)
    assert parameters == ["pixel", "near"]
    assert "far" not in text
    assert "var steep = " in text
    _, text = of("none", True, False, 4)
    # assigned once where no branch assigns it again
    assert "let steep = " in text


def test_no_statement_follows_a_return(module: Any) -> None:
    """A GPU's compiler would refuse one."""
    library = library_of([module.entry], {module.chosen: [module.by_itself]})
    for variant in variants(module):
        text = linked(library, program(module, variant, "by_itself"))
        assert not re.search(r"^( *)(return|break|continue)\b.*;\n\1\S", text, re.MULTILINE)


# --- caching of analyses --------------------------------------------------------------------------


def test_a_shader_is_analysed_once_for_all_programs(folder: Path) -> None:
    module = write_module(folder, SOURCE)
    for variant in variants(module)[:5]:
        assert program(module, variant).module.entry.name == "entry"
        seen = module.entry.analysis
        assert seen is not None
    assert module.entry.analysis is seen


def test_a_shader_is_analysed_again_if_a_name_in_it_changes(folder: Path) -> None:
    module = write_module(
        folder,
        "STEP = 2.0\n@struct\nclass Out:\n    x: float\n"
        "@shader\ndef half(x: float) -> float:\n    return x * STEP\n"
        "@shader\ndef entry(pixel: IVec2) -> Out:\n    return Out(half(float(pixel.x)))\n",
    )

    def text() -> str:
        return print_wgsl(Program(module.entry).module, "wrap")

    before = text()
    assert "x * 2.0" in before
    module.STEP = 3.0
    assert "x * 3.0" in text()
    module.STEP = 2.0
    assert text() == before
    other = "@shader\ndef half(x: float) -> float:\n    return x + x\n"
    module.half = write_module(folder, other).half
    assert "x + x" in text()


# --- keys -----------------------------------------------------------------------------------------

KEYED = """
from typing import Literal

@static
class Variant:
    a: bool
    b: Literal["x", "y"]
    c: bool
    unread: bool

    @property
    def either(self) -> bool:
        return self.b == "x" or self.c

@struct
class Out:
    x: float

@shader
def inner(x: float, variant: Variant) -> float:
    return x if variant.either else -x

@shader
def entry(pixel: IVec2, variant: Variant) -> Out:
    return Out(inner(1.0, variant) if variant.a else 2.0)
"""


def test_a_key_contains_the_fields_that_shaders_read(folder: Path) -> None:
    module = write_module(folder, KEYED)

    def key(**changed: Any) -> str:
        values = {"a": True, "b": "x", "c": True, "unread": False, **changed}
        return Program(module.entry, variant=module.Variant(**values)).key

    first = key()
    assert key(unread=True) == first
    assert key(a=False) != first
    # for a property, its value counts
    assert key(b="y") == key(c=False) == first
    assert key(b="y", c=False) != first


def test_a_program_needs_a_variant_of_the_type_that_its_entry_takes(folder: Path) -> None:
    module, other = write_module(folder, KEYED), write_module(folder, KEYED)
    for variant in (None, "x", other.Variant(True, "x", True, True)):
        with pytest.raises(ShaderError, match="takes variant: Variant; pass one"):
            Program(module.entry, variant=variant)


# --- refused source ------------------------------------------------------------------------------

HEAD = """
from typing import Literal

@static
class Variant:
    fog: Literal["none", "linear"]
    name: str
    deep: bool
    taps: int

    @property
    def scale(self) -> float:
        return 1.0

@static
class Other:
    deep: bool

@shader
def taking(x: float, variant: Variant) -> float:
    return x if variant.deep else -x

"""
REFUSED = {
    'if variant.fog == "lienar":\n        y = x': (
        "variant.fog == 'lienar'", "there is no fog 'lienar'; use one of none, linear",
    ),
    'if variant.fog in ("none", "thick"):\n        y = x': (
        "variant.fog in ('none', 'thick')", "there is no fog 'thick'",
    ),
    "if variant.fog:\n        y = x": ("variant.fog", "as in `variant.fog == 'none'`"),
    "if variant.taps > 1:\n        y = x": ("variant.taps > 1", "by `==` or `!=`"),
    "if 1 == variant.taps:\n        y = x": ("1 == variant.taps", "static field with a literal"),
    "if variant.taps == n:\n        y = x": ("variant.taps == n", "with a literal"),
    "if variant.taps in (1, n):\n        y = x": ("variant.taps in (1, n)", "with a literal"),
    "if variant.taps in ():\n        y = x": ("variant.taps in ()", "with a literal"),
    "if variant.taps == variant.fog:\n        y = x": ("variant.taps == variant.fog", "literal"),
    "if 0 < variant.taps < 3:\n        y = x": ("0 < variant.taps < 3", "with a literal"),
    'if variant.taps == "1":\n        y = x': ("variant.taps == '1'", "taps is int, not '1'"),
    "if variant.deep == 1:\n        y = x": ("variant.deep == 1", "deep is bool, not 1"),
    "if variant.thick:\n        y = x": ("variant.thick", "no field or property thick that is str"),
    "if variant.scale == 1.0:\n        y = x": ("variant.scale", "no field or property scale"),
    "y = variant": ("variant", "is not a value; branch on its fields"),
    "y = variant.fog": ("variant.fog", "is not a value; compare it"),
    "y = x + float(variant.taps)": ("variant.taps", "is not a value"),
    "y = half(variant)": ("variant", "is not a value"),
    "y = taking(x, variant if n > 1 else variant)": ("variant if n > 1", "the one of this shader"),
    "y = taking(x, other)": ("other", "variant is Variant; pass the one of"),
    "y = taking(x, Variant('none', '', True, 1))": ("Variant('none'", "the one of this shader"),
    "y = taking(x)": ("taking(x)", "taking needs an argument for variant"),
    'y = "none"': ("'none'", "strings are for static conditions only, as in `variant.fog_mode == "),
    'if "none" == "none":\n        y = x': ("'none'", "strings are for static conditions only"),
    "variant = x": ("variant = x", "a parameter cannot be assigned to"),
    # the edge of a map is static, and the filter of heights
    'if f.edge == "clip":\n        y = x': (
        "f.edge == 'clip'", "there is no edge 'clip'; use one of wrap, clamp",
    ),
    'if f.filter == "fine":\n        y = x': ("f.filter", "sharp, smooth, mip, columns"),
    'if t.filter == "mip":\n        y = x': ("t.filter", "Texture has no field or property filter"),
    "y = f.edge": ("f.edge", "as in `f.edge == 'wrap'`"),
    "y = f.levels": ("f.levels", "HeightField has no field or property levels"),
    "y = float(levels(m))": ("m", "is not a value"),
    "y = by_map(x, x)": ("x", "map is Map; pass the one of"),
    # both branches are checked
    "if variant.deep:\n        y = x + n": ("x + n", "does not apply to float and int"),
    "if not variant.deep:\n        y = unheard": ("unheard", "is not defined"),
    "y = x if variant.deep else n": ("n", "the other value is float, not int"),
    "if variant.deep:\n        y = x\n    z = y": ("y", "may be unassigned"),
    "if variant.deep:\n        return x\n    else:\n        return -x\n    y = x": (
        "y = x", "unreachable statement",
    ),
    "levels(f if variant.deep and x > 0.0 else f)": ("levels(", "an expression alone"),
    "y = levels(f if variant.deep and x > 0.0 else f)": (
        "f if variant.deep and x > 0.0 else f", "only by a static condition",
    ),
}  # fmt: skip
HALF = "@shader\ndef half(x: float) -> float:\n    return x * 0.5\n\n"
PARAMETERS = "x: float, n: int, f: HeightField, t: Texture, m: Map, variant: Variant, other: Other"
BY_MAP = "@shader\ndef by_map(x: float, map: Map) -> float:\n    return x\n\n"


@pytest.mark.parametrize("body", REFUSED)
def test_refused_in_a_body(folder: Path, body: str) -> None:
    offending, advice = REFUSED[body]
    before = f"{HEAD}{HALF}{BY_MAP}"
    text = f"{before}@shader\ndef wrong({PARAMETERS}) -> float:\n    {body}\n    return x\n"
    module = write_module(folder, text)
    with pytest.raises(ShaderError) as caught:
        analyse(module.wrong, {}, vars(module.Variant("none", "", True, 1)).get)
    refusal = refusal_in(caught.value)
    assert refusal.file == module.__file__
    assert offending in refusal.marked.replace('"', "'")
    assert advice in refusal.message
    lines = Path(refusal.file).read_text().splitlines()
    first = len(lines) - 1 - body.count("\n") - 1
    assert first < refusal.line <= first + body.count("\n") + 1


HEADS = {
    "def wrong(x: float, variant: Variant) -> float:\n    if variant.deep:\n        return x": (
        "can end without a result"
    ),
    "def wrong(variant: Variant) -> Variant:\n    return variant": "Variant is not a type",
    "def wrong(x: Holding) -> float:\n    return 1.0": "Variant is not a type",
    "def wrong(x: Buffer[Variant]) -> float:\n    return 1.0": "is not a type",
    "def wrong(x: Map) -> Map:\n    return x": "Map is not a type",
}


@pytest.mark.parametrize("head", HEADS)
def test_refused_by_the_signature(folder: Path, head: str) -> None:
    holding = "@struct\nclass Holding:\n    variant: Variant\n\n"
    module = write_module(folder, f"{HEAD}{holding}@shader\n{head}\n")
    with pytest.raises(ShaderError) as caught:
        analyse(module.wrong, {}, vars(module.Variant("none", "", True, 1)).get)
    assert re.match(r".*\.py:\d+: ", str(caught.value))
    assert HEADS[head] in str(caught.value)


def test_the_functions_that_an_untaken_branch_calls_are_checked(folder: Path) -> None:
    module = write_module(
        folder,
        HEAD + "@shader\ndef odd(x: float, variant: Variant) -> float:\n"
        "    return even(x, variant) if variant.deep else x\n"
        "@shader\ndef even(x: float, variant: Variant) -> float:\n"
        "    return odd(x, variant) if variant.deep else x\n"
        "@shader\ndef broken(x: float) -> float:\n    return x + 1\n"
        "@shader\ndef calling(x: float, variant: Variant) -> float:\n"
        "    return broken(x) if variant.deep else x\n",
    )
    shallow = module.Variant("none", "", False, 1)
    with pytest.raises(ShaderError, match="calls itself; write a bounded loop"):
        analyse(module.odd, {}, vars(shallow).get)
    with pytest.raises(ShaderError, match=r"does not apply to float and int") as caught:
        analyse(module.calling, {}, vars(shallow).get)
    assert refusal_in(caught.value).marked == "x + 1"


@pytest.mark.parametrize("t", ["float", "list", "Vec3", "'Literal[1, True]'", "'Unheard'"])
def test_a_static_record_holds_text_flags_and_ints(folder: Path, t: str) -> None:
    with pytest.raises((ShaderError, NameError), match=r"static record is a str|Unheard"):
        write_module(
            folder, f"from typing import Literal\n@static\nclass Wrong:\n    ok: bool\n    x: {t}\n"
        )


def test_the_record_is_frozen_and_lists_its_fields(module: Any) -> None:
    variant = module.Variant("none", True, False, 2)
    with pytest.raises(AttributeError):
        variant.deep = False
    fields = module.static_fields(module.Variant)
    assert list(fields) == ["fog", "deep", "walls", "taps", "walled"]
    assert fields["fog"] == ("fog", str, ("none", "linear", "squared"))
    assert fields["taps"] == ("taps", int, (1, 2, 4))
    assert fields["walled"] == ("walled", bool, ())
    assert not variant.walled


# --- conditions on maps ---------------------------------------------------------------------------

MAPS = """
@struct
class Out:
    x: float

@shader
def beyond(map: Map, x: float) -> float:
    return x if map.edge == "wrap" else -x

@shader
def entry(pixel: IVec2, near: HeightField, far: Texture, map: Map) -> Out:
    found = beyond(near, 1.0) + beyond(far, 10.0) + beyond(map, 100.0)
    return Out(found if near.filter in ("sharp", "mip") else found * 2.0)
"""


@pytest.mark.parametrize("edge", ["wrap", "clamp"])
@pytest.mark.parametrize("filter", ["sharp", "smooth"])
def test_conditions_on_maps_use_the_values_of_the_program(
    folder: Path, edge: Any, filter: Any
) -> None:
    module = write_module(folder, MAPS)
    made = Program(module.entry, edge=edge, filter=filter)
    expected = 111.0 * (1.0 if edge == "wrap" else -1.0) * (1.0 if filter == "sharp" else 2.0)
    near = HeightField([np.zeros((1, 1), np.float32)], edge, filter)
    far = Texture([np.zeros((1, 1, 4), np.uint16)], edge)
    assert module.entry((0, 0), near, far, near).x == expected
    # no map is read, so none is bound
    assert list(made.module.entry.parameters) == ["pixel"]
    assert list(made.parameters) == ["near", "far"]
    assert CpuEngine().run(made, {}, (1, 1))["x"] == expected
    others = {Program(module.entry, edge=e, filter=f).key for e in ("wrap", "clamp")
              for f in ("sharp", "smooth", "mip", "columns")}  # fmt: skip
    assert len(others) == 8
    assert made.key in others
