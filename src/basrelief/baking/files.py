"""Bakes of a material's maps to files.

`FILE_BAKES` lists the bakes; those that techniques declare are in `tables.TABLES`. `docs/bake.md`
describes the files.
"""

from __future__ import annotations

import os
import re
import tempfile
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, assert_never

from basrelief.baking.tables import TABLES, table
from basrelief.errors import InputError, suggestion
from basrelief.settings import check_choices, setting

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from basrelief.engine import Engine
    from basrelief.lang.resources import Edge
    from basrelief.material import Material


GreenKind = Literal["gl", "dx"]
BitsKind = Literal[8, 16]


@dataclass(frozen=True)
class FileOptions:
    """Options of the files that `basrelief bake` writes.

    Attributes
    ----------
    green : {"gl", "dx"}
        Green of normals, up (gl) or down (dx).
    bits : {8, 16}
        Bits of normals, heights and occlusion.
    directions : int
        Directions of the horizon, four per file.
    """

    green: GreenKind = setting(default="gl", group="Bake")
    bits: BitsKind = setting(default=16, group="Bake")
    directions: int = setting(default=8, low=1, group="Bake")

    def __post_init__(self) -> None:
        check_choices(self)


@dataclass(frozen=True)
class BakeInput:
    """Input of a bake: a material, and the options that all bakes share.

    `opening` is that of the hole in the material's heights, None for none.
    """

    material: Material
    engine: Engine
    edge: Edge
    scale: float
    options: FileOptions
    opening: float | None = None

    def heights(self) -> NDArray[np.float32]:
        """Heights of the material, (height, width)."""
        if self.material.height is None:
            raise InputError(
                f"{self.material.name}: has no height map to bake from; "
                "bake `height` from its normals, or name one with --height FILE"
            )
        return self.material.height.linear()[:, :, 0]

    def codes(self, values: NDArray[np.floating]) -> NDArray[Any]:
        """Values from 0 to 1 as integer codes of `bits` bits."""
        import numpy as np

        kind = np.uint8 if self.options.bits == 8 else np.uint16
        codes: NDArray[Any] = np.rint(np.clip(values, 0.0, 1.0) * np.iinfo(kind).max)
        return codes.astype(kind)


@dataclass(frozen=True)
class BakeResult:
    """Result of a bake: arrays by the suffix of their file name, and a note."""

    files: dict[str, NDArray[Any]]
    note: str = ""


@dataclass(frozen=True)
class BakeOption:
    """Bake that the command line offers."""

    help: str
    make: Callable[[BakeInput], BakeResult]


def _table(name: str, help: str) -> BakeOption:
    """Bake of a table that techniques declare, stored unchanged: four 16-bit channels."""

    def make(baking: BakeInput) -> BakeResult:
        from basrelief.techniques import BAKES

        pixels = table(BAKES[name], baking.heights(), baking.edge, baking.engine)
        return BakeResult({name.removesuffix("_map"): pixels})

    return BakeOption(help, make)


def _horizon(baking: BakeInput) -> BakeResult:
    from basrelief.baking import horizon_map
    from basrelief.baking.cache import cached

    if baking.options.directions % 4:
        raise InputError(
            f"--directions {baking.options.directions}: must be a multiple of 4, "
            "as a file stores four"
        )
    pixels = cached(
        horizon_map, baking.heights(), baking.edge, baking.engine,
        scale=baking.scale, directions=baking.options.directions,
    )  # fmt: skip
    return BakeResult(
        {
            f"horizon_{k // 4}": pixels[:, :, k : k + 4]
            for k in range(0, baking.options.directions, 4)
        }
    )


def _occlusion(baking: BakeInput) -> BakeResult:
    from basrelief.baking import ambient_occlusion
    from basrelief.baking.cache import cached

    pixels = cached(
        ambient_occlusion, baking.heights(), baking.edge, baking.engine, scale=baking.scale
    )
    return BakeResult({"ao": baking.codes(pixels[:, :, None])})


def _normal(baking: BakeInput) -> BakeResult:
    from basrelief.baking import normal_map

    pixels = normal_map(baking.heights(), baking.edge, baking.scale, baking.engine)
    match baking.options.green:
        case "gl":
            pass
        case "dx":
            pixels[:, :, 1] *= -1.0
        case _:
            assert_never(baking.options.green)
    return BakeResult({f"normal_{baking.options.green}": baking.codes(pixels * 0.5 + 0.5)})


def _height(baking: BakeInput) -> BakeResult:
    from basrelief.baking import height_map

    if baking.opening is not None:
        note = f"scale {baking.scale:.4g}; a hole opened by {baking.opening:g}"
        return BakeResult({"height": baking.codes(baking.heights()[:, :, None])}, note)
    normal = baking.material.normal
    if normal is None:
        raise InputError(
            f"{baking.material.name}: has no normal map to make heights from; "
            "name one with --normal FILE"
        )
    integrated = height_map(normal.linear() * 2.0 - 1.0, baking.edge, baking.engine)
    residual = f"its normals are {integrated.residual:.2g}° off the input (rms)"
    note = f"scale {integrated.scale:.4g}; {residual}"
    return BakeResult({"height": baking.codes(integrated.heights[:, :, None])}, note)


FILE_BAKES: dict[str, BakeOption] = {
    "normal": BakeOption("Normals, from heights.", _normal),
    "height": BakeOption("Heights, from normals, or of a hole (--opening).", _height),
    "occlusion": BakeOption("Ambient occlusion, from heights.", _occlusion),
    "horizon": BakeOption("Horizon map: the elevation of the horizon in 8 directions.", _horizon),
    **{name.removesuffix("_map"): _table(name, help) for name, (_, help) in TABLES.items()},
}
"""Bakes of `basrelief bake`, by their names."""


def checked_bakes(names: Sequence[str]) -> list[str]:
    """Names of bakes without duplicates; hyphens are read as underscores.

    Raises InputError for an unknown name, and if there are no names.
    """
    checked = [name.lower().replace("-", "_").removesuffix("_map") for name in names]
    for name in checked:
        if name not in FILE_BAKES:
            raise InputError(f"there is no bake {name!r}; {suggestion(name, FILE_BAKES)}")
    if not checked:
        raise InputError(
            f"nothing to bake: name {', '.join(FILE_BAKES)}, "
            "for example basrelief bake FOLDER normal"
        )
    return list(dict.fromkeys(checked))


def bake_to(
    folder: Path, names: Sequence[str], baking: BakeInput, *, overwrite: bool = False
) -> list[tuple[Path, str]]:
    """Bake some of `FILE_BAKES` and write the files to a folder, all or none.

    Creates the folder if it is missing, and returns each file with its note. Raises InputError if a
    file exists and `overwrite` is False, and if something cannot be baked or written.
    """
    prefix = _file_prefix(baking.material)
    results = [FILE_BAKES[name].make(baking) for name in names]
    files = {
        folder / f"{prefix}_{suffix}.png": (pixels, result.note)
        for result in results
        for suffix, pixels in result.files.items()
    }
    existing = sorted(path.name for path in files if os.path.lexists(path))
    if existing and not overwrite:
        raise InputError(
            f"{folder}: {', '.join(existing)} would be overwritten; "
            "choose another folder with -o, or add --overwrite"
        )
    _write_together(folder, {path: pixels for path, (pixels, _) in files.items()})
    return [(path, note) for path, (_, note) in files.items()]


def _write_together(folder: Path, files: dict[Path, NDArray[Any]]) -> None:
    """Write all files to a temporary folder first, then move them."""
    from basrelief.images import write_data

    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=folder, prefix=".baking-") as temporary:
            written = {path: write_data(Path(temporary) / path.name, files[path]) for path in files}
            for path, file in written.items():
                os.replace(file, path)
    except OSError as error:
        why = error.strerror or error
        raise InputError(f"{folder}: cannot be written ({why}); choose another with -o") from error


def _file_prefix(material: Material) -> str:
    """Prefix of the files of a material: that of its height or normal map, else its name."""
    from basrelief.material.conventions import parse_name, words

    for map in (material.height, material.normal):
        source = re.sub(r"^1 − | \(\w\)$", "", map.source) if map is not None else ""
        if Path(source).suffix and not source.startswith("sample "):
            stem = Path(source).stem
            prefix = parse_name(stem).prefix
            starts: Iterable[str] = (stem[:end] for end in range(len(stem) - 1, 0, -1))
            start = next((s for s in starts if words(s) == prefix and prefix), "")
            if start.strip(" _-."):
                return start.strip(" _-.")
    return material.name
