"""A technique of a user's own, from a file."""

from __future__ import annotations

import sys
import traceback
from pathlib import Path
from types import ModuleType
from typing import Any

from basrelief.errors import BasreliefError, InputError
from basrelief.lang import Shader, Texture
from basrelief.lang.frontend import bound_types
from basrelief.lang.types import is_record
from basrelief.techniques.technique import Technique, displace


def technique_from_file(file: str, name: str) -> Technique[..., Any]:
    """The technique or shader `name` of a Python file, checked to fit.

    Raises InputError for a missing file or name, for a file that fails to run, and for a function
    that is no technique; ShaderError, with file and line, for a signature that does not fit.
    """
    path = Path(file)
    if not path.is_file():
        raise InputError(f"{file}: there is no such file; --technique takes FILE.py:NAME")
    found = getattr(_module(path), name, None)
    if not isinstance(found, Shader) or found.is_slot:
        what = "has no" if found is None else "does not mark"
        raise InputError(f"{file}: it {what} {name}; mark a technique with @technique()")
    return checked_technique(found)


def _module(path: Path) -> ModuleType:
    """The module of a file; run from its text, so that no compiled copy is left or out of date."""
    module = ModuleType(f"basrelief_own_{path.stem}")
    module.__file__ = str(path)
    # records look up their annotations in the module that defines them
    sys.modules[module.__name__] = module
    try:
        code = compile(path.read_bytes(), str(path), "exec", dont_inherit=True)
        exec(code, module.__dict__)
    except BasreliefError:
        raise
    except (Exception, SystemExit) as error:
        raise InputError(_failure(path, error)) from None
    return module


def _failure(path: Path, error: BaseException) -> str:
    """What went wrong when a file ran, and at which line of it."""
    what = f"{type(error).__name__}: {error}"
    lines = [f for f in traceback.extract_tb(error.__traceback__) if f.filename == str(path)]
    line, text = (lines[-1].lineno, lines[-1].line) if lines else (None, None)
    if isinstance(error, SyntaxError) and error.filename == str(path):
        what, line, text = f"{type(error).__name__}: {error.msg}", error.lineno, error.text
    place = f"{path}:{line}: `{(text or '').strip()}`" if line else str(path)
    return f"{place}: the file fails to run: {what}"


def checked_technique(given: Any) -> Technique[..., Any]:
    """A technique, or a shader that is used as one, checked to fit.

    Raises InputError for anything else, ShaderError, with file and line, for a signature that does
    not fit.
    """
    if not isinstance(given, Shader) or given.is_slot:
        name = getattr(given, "__name__", repr(given))
        raise InputError(f"{name} is no technique; mark one with @technique()")
    made = given if isinstance(given, Technique) else Technique(given.function)
    if not is_record(made.settings):
        raise InputError(
            f"{made.location}: {made.name}: its settings are no record; make one with @struct, "
            "or take Nothing"
        )
    bound_types({displace: made})
    if Texture in made.signature[0].values() and made.bake is None:
        raise InputError(
            f"{made.location}: {made.name} takes a table; say which, as @technique(bake=CONE_MAP)"
        )
    return made
