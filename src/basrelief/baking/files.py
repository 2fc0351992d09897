"""Baking a material's maps to files: which bakes there are, and how each is stored.

A bake more is a line in `OPTIONS`; one that techniques declare, in `tables.TABLES`. `docs/bake.md`
says what is in each file.
"""

from __future__ import annotations

import os
import re
import tempfile
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, assert_never

from basrelief.baking.tables import TABLES, table
from basrelief.errors import InputError

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from basrelief.engine import Engine
    from basrelief.lang.resources import Edge
    from basrelief.material import Material
    from basrelief.material.conventions import Green


@dataclass(frozen=True)
class Baking:
    """What bakes are made from: a material, and the choices that hold for all of them."""

    material: Material
    engine: Engine
    edge: Edge
    scale: float
    bits: int
    green: Green
    directions: int

    def heights(self) -> NDArray[np.float32]:
        """The material's heights, (height, width)."""
        if self.material.height is None:
            raise InputError(
                f"{self.material.name}: has no height map to bake from; "
                "make one from its normals with --height, or name one with --height-map FILE"
            )
        return self.material.height.linear()[:, :, 0]

    def codes(self, values: NDArray[np.floating]) -> NDArray[Any]:
        """Fractions of one as whole numbers of the chosen bits."""
        import numpy as np

        kind = np.uint8 if self.bits == 8 else np.uint16
        codes: NDArray[Any] = np.rint(np.clip(values, 0.0, 1.0) * np.iinfo(kind).max)
        return codes.astype(kind)


@dataclass(frozen=True)
class Made:
    """What a bake comes to: arrays by the end of a file's name, and a word about them."""

    files: dict[str, NDArray[Any]]
    note: str = ""


@dataclass(frozen=True)
class Option:
    """A bake that the command line offers."""

    help: str
    make: Callable[[Baking], Made]


def _table(name: str, about: str) -> Option:
    """The table of a bake that techniques declare: four 16-bit channels already."""

    def make(baking: Baking) -> Made:
        from basrelief.techniques import BAKES

        made = table(BAKES[name], baking.heights(), baking.edge, baking.engine)
        return Made({name.removesuffix("_map"): made})

    return Option(about, make)


def _horizon(baking: Baking) -> Made:
    from basrelief.baking import horizon_map
    from basrelief.baking.cache import kept

    if baking.directions % 4:
        raise InputError(f"--directions {baking.directions}: four go into a file; name 4, 8, 12 …")
    made = kept(
        horizon_map, baking.heights(), baking.edge, baking.engine,
        scale=baking.scale, directions=baking.directions,
    )  # fmt: skip
    return Made(
        {f"horizon_{k // 4}": made[:, :, k : k + 4] for k in range(0, baking.directions, 4)}
    )


def _occlusion(baking: Baking) -> Made:
    from basrelief.baking import ambient_occlusion
    from basrelief.baking.cache import kept

    made = kept(ambient_occlusion, baking.heights(), baking.edge, baking.engine, scale=baking.scale)
    return Made({"ao": baking.codes(made[:, :, None])})


def _normal(baking: Baking) -> Made:
    from basrelief.baking import normal_map

    made = normal_map(baking.heights(), baking.edge, baking.scale, baking.engine)
    match baking.green:
        case "gl":
            pass
        case "dx":
            made[:, :, 1] *= -1.0
        case _:
            assert_never(baking.green)
    return Made({f"normal_{baking.green}": baking.codes(made * 0.5 + 0.5)})


def _height(baking: Baking) -> Made:
    from basrelief.baking import height_map

    normal = baking.material.normal
    if normal is None:
        raise InputError(
            f"{baking.material.name}: has no normal map to make heights from; "
            "name one with --normal-map FILE"
        )
    made = height_map(normal.linear() * 2.0 - 1.0, baking.edge, baking.engine)
    note = f"scale {made.scale:.4g}; its normals are {made.residual:.2g}° off those given (rms)"
    return Made({"height": baking.codes(made.heights[:, :, None])}, note)


OPTIONS: dict[str, Option] = {
    "normal": Option("Normals, from heights.", _normal),
    "height": Option("Heights, from normals.", _height),
    "occlusion": Option("Ambient occlusion: the sky that each texel sees.", _occlusion),
    "horizon": Option("The elevation of the horizon in 8 directions.", _horizon),
    **{name.removesuffix("_map"): _table(name, about) for name, (_, about) in TABLES.items()},
}
"""What `basrelief bake` makes, by the name of its option."""


def bake_to(
    folder: Path, names: Sequence[str], baking: Baking, *, overwrite: bool = False
) -> list[tuple[Path, str]]:
    """Make some of `OPTIONS` and write them to a folder, all or none: files, each with a note.

    The folder is made if it is missing. Raises InputError where a file of that name is there and
    is not to be replaced, or something else cannot be made or written.
    """
    start = _start(baking.material)
    made = [(name, OPTIONS[name].make(baking)) for name in names]
    files = {
        folder / f"{start}_{end}.png": (pixels, each.note)
        for _, each in made
        for end, pixels in each.files.items()
    }
    there = sorted(path.name for path in files if os.path.lexists(path))
    if there and not overwrite:
        raise InputError(
            f"{folder}: {', '.join(there)} would be written over; "
            "choose another folder with -o, or say --overwrite"
        )
    _write_together(folder, {path: pixels for path, (pixels, _) in files.items()})
    return [(path, note) for path, (_, note) in files.items()]


def _write_together(folder: Path, files: dict[Path, NDArray[Any]]) -> None:
    """Write all beside their places first, then move them there."""
    from basrelief.images import write_data

    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=folder, prefix=".baking-") as aside:
            done = {path: write_data(Path(aside) / path.name, each) for path, each in files.items()}
            for path, ready in done.items():
                os.replace(ready, path)
    except OSError as error:
        why = error.strerror or error
        raise InputError(f"{folder}: cannot be written ({why}); choose another with -o") from error


def _start(material: Material) -> str:
    """What the names of a material's files begin with: those of its heights or normals do."""
    from basrelief.material.conventions import parse_name, words

    for each in (material.height, material.normal):
        source = re.sub(r"^1 − | \(\w\)$", "", each.source) if each is not None else ""
        if Path(source).suffix and not source.startswith("sample "):
            stem = Path(source).stem
            prefix = parse_name(stem).prefix
            starts: Iterable[str] = (stem[:end] for end in range(len(stem) - 1, 0, -1))
            found = next((s for s in starts if words(s) == prefix and prefix), "")
            if found.strip(" _-."):
                return found.strip(" _-.")
    return material.name
