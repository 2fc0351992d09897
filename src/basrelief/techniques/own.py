"""Techniques from Python files of the user's."""

from __future__ import annotations

import sys
import traceback
from pathlib import Path
from types import ModuleType
from typing import Any

from basrelief.errors import BasreliefError, InputError
from basrelief.lang import Shader, Texture
from basrelief.lang.slots import bound_types
from basrelief.lang.types import is_record
from basrelief.techniques.technique import Technique, displace


def technique_from_file(file: str, name: str) -> Technique[..., Any]:
    """Load the technique or shader `name` from a Python file and check it.

    Raises InputError for a missing file or name, for a file that fails to run, and for a function
    that is not a technique; ShaderError for a signature that does not fit.
    """
    path = Path(file)
    if not path.is_file():
        raise InputError(f"{file}: there is no such file; --technique takes FILE.py:NAME")
    value = getattr(_module(path), name, None)
    if not isinstance(value, Shader) or value.is_slot:
        what = "has no" if value is None else "does not mark"
        raise InputError(f"{file}: it {what} {name}; mark a technique with @technique()")
    return checked_technique(value)


def _module(path: Path) -> ModuleType:
    """Run a file as a module, from its text, so that no stale compiled copy is left."""
    module = ModuleType(f"basrelief_own_{path.stem}")
    module.__file__ = str(path)
    # records look up their annotations in their module
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
    """The error of a file that failed to run, with its line."""
    what = f"{type(error).__name__}: {error}"
    lines = [f for f in traceback.extract_tb(error.__traceback__) if f.filename == str(path)]
    line, text = (lines[-1].lineno, lines[-1].line) if lines else (None, None)
    if isinstance(error, SyntaxError) and error.filename == str(path):
        what, line, text = f"{type(error).__name__}: {error.msg}", error.lineno, error.text
    place = f"{path}:{line}: `{(text or '').strip()}`" if line else str(path)
    return f"{place}: the file fails to run: {what}"


def checked_technique(value: Any) -> Technique[..., Any]:
    """Check a technique, or a shader that is used as one.

    Raises InputError for anything else; ShaderError, with file and line, for a signature that does
    not fit.
    """
    if not isinstance(value, Shader) or value.is_slot:
        name = getattr(value, "__name__", repr(value))
        raise InputError(f"{name} is no technique; mark one with @technique()")
    marked = value if isinstance(value, Technique) else Technique(value.function)
    if not is_record(marked.settings):
        raise marked.error(
            f"the settings of {marked.name} are no record; make one with @struct, or take Nothing",
            list(marked.signature[0])[-1],
        )
    bound_types({displace: marked})
    if Texture in marked.signature[0].values() and marked.bake is None:
        raise marked.error(f"{marked.name} takes a table; name it, as in @technique(bake=CONE_MAP)")
    return marked
