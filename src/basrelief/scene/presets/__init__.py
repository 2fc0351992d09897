"""Presets: what an article, or a user, settles on, under one name.

    preset("gamedev").scene(material)
    preset("mine.toml").scene(material, scale=0.1)

Each of the library's own is a file in this folder, in which every number says whether it is the
article's or chosen. Options that are given explicitly win over a preset's, and these over the
defaults.
"""

from __future__ import annotations

import functools
import os
import tomllib
from pathlib import Path

from basrelief.errors import InputError
from basrelief.scene.presets.record import Preset, scene_of

__all__ = ["NOTHING", "PRESETS", "Preset", "preset", "scene_of"]

_FOLDER = Path(__file__).parent
PRESETS = tuple(sorted(path.stem for path in _FOLDER.glob("*.toml")))
"""The names of the library's own presets."""
EMPTY_PRESET = Preset("nothing")
"""The preset that says nothing: the defaults of the library."""


def preset(name: str | os.PathLike[str]) -> Preset:
    """A preset by its name, or from a TOML file of one's own.

    Its tables are `maps` (options of `load`), `object` and `scene` (fields of `Object` and
    `Scene`), each as it is in Python; `object.layer` names its `material`, `scene.lights` is a list
    of tables with a `kind`. Paths are from the file's folder. Raises InputError, in one line with
    the file and the key, for what cannot be used.
    """
    text = os.fspath(name)
    if text in PRESETS:
        return _own(text)
    if not text.endswith(".toml"):
        raise InputError(f"no preset is called {text!r}; use one of {', '.join(PRESETS)}, or a "
                         ".toml file")  # fmt: skip
    return _read(Path(text))


@functools.cache
def _own(name: str) -> Preset:
    return _read(_FOLDER / f"{name}.toml")


def _read(path: Path) -> Preset:
    try:
        said = tomllib.loads(path.read_bytes().decode())
    except FileNotFoundError:
        raise InputError(f"{path}: there is no such file; check the name") from None
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror})") from None
    except UnicodeDecodeError:
        raise InputError(f"{path}: is not TOML: not UTF-8; save it as UTF-8") from None
    except (tomllib.TOMLDecodeError, RecursionError) as error:
        raise InputError(f"{path}: is not TOML: {error}; mend that line") from None
    texts = {key: said.pop(key, "") for key in ("name", "about", "source")}
    try:
        for key, text in texts.items():
            if not isinstance(text, str):
                raise InputError(f"{key} is {text!r}: give a text")
        return Preset(texts["name"] or path.stem, texts["about"], texts["source"], said, path)
    except InputError as error:
        raise InputError(" ".join(f"{path}: {error}".split())) from None
