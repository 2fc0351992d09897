"""Presets: the settings of an article, or of a user, under one name.

    preset("gamedev").scene(material)
    preset("mine.toml").scene(material, scale=0.1)

Each of the library's presets is a file in this folder. A comment at every number states whether it
is the article's or chosen here. Explicit options override a preset's, and these the defaults.
"""

from __future__ import annotations

import functools
import os
import tomllib
from pathlib import Path

from basrelief.errors import InputError, closest
from basrelief.scene.presets.record import Preset, scene_of

__all__ = ["EMPTY_PRESET", "PRESETS", "Preset", "preset", "scene_of"]

_FOLDER = Path(__file__).parent
PRESETS = tuple(sorted(path.stem for path in _FOLDER.glob("*.toml")))
"""Names of the library's presets."""
EMPTY_PRESET = Preset("nothing")
"""The preset without values: the defaults of the library."""


def preset(name: str | os.PathLike[str]) -> Preset:
    """The preset of a name, or of a TOML file.

    The tables of a file are `maps` (options of `load`), `object` and `scene` (fields of `Object`
    and `Scene`), with the names and values of Python. `object.layer` has the key `material`, and
    `scene.lights` is a list of tables with a `kind`. Paths are relative to the file's folder.

    Parameters
    ----------
    name : str or path
        One of `PRESETS`, or a file that ends in .toml.

    Returns
    -------
    Preset

    Raises
    ------
    InputError
        For an unknown name, a file that cannot be read, unknown keys, and values out of range; the
        message names the file and the key.
    """
    text = os.fspath(name)
    if text in PRESETS:
        return _library_preset(text)
    if not text.endswith(".toml"):
        raise InputError(f"no preset is called {text!r}; use one of {', '.join(PRESETS)}, or a "
                         f".toml file{closest(text, PRESETS)}")  # fmt: skip
    return _read(Path(text))


@functools.cache
def _library_preset(name: str) -> Preset:
    return _read(_FOLDER / f"{name}.toml")


def _read(path: Path) -> Preset:
    try:
        tables = tomllib.loads(path.read_bytes().decode())
    except FileNotFoundError:
        raise InputError(f"{path}: there is no such file; check the name") from None
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror})") from None
    except UnicodeDecodeError:
        raise InputError(f"{path}: is not TOML: not UTF-8; save it as UTF-8") from None
    except (tomllib.TOMLDecodeError, RecursionError) as error:
        raise InputError(f"{path}: is not TOML: {error}; correct that line") from None
    texts = {key: tables.pop(key, "") for key in ("name", "about", "source")}
    try:
        for key, text in texts.items():
            if not isinstance(text, str):
                raise InputError(f"{key} is {text!r}: give a text")
        return Preset(texts["name"] or path.stem, texts["about"], texts["source"], tables, path)
    except InputError as error:
        raise InputError(" ".join(f"{path}: {error}".split())) from None
