"""A technique of a user's own, from a file."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path
from typing import Any

from basrelief.errors import InputError
from basrelief.lang import Shader, ShaderError
from basrelief.lang.frontend import bound_types
from basrelief.shaders.techniques.technique import Technique, displace


def technique_from_file(file: str, name: str) -> Technique[..., Any]:
    """The technique or shader `name` of a Python file, checked to fit.

    Raises InputError for a missing file or name, for a file that fails to run, and for a function
    that is no technique; ShaderError, with file and line, for a signature that does not fit.
    """
    path = Path(file)
    if not path.is_file():
        raise InputError(f"{file}: there is no such file; --technique takes FILE.py:NAME")
    module_name = f"basrelief_own_{path.stem}"
    spec = importlib.util.spec_from_file_location(module_name, path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    # records look up their annotations in the module that defines them
    sys.modules[module_name] = module
    try:
        spec.loader.exec_module(module)
    except ShaderError:
        raise
    except Exception as error:
        raise InputError(f"{file}: it fails to run: {type(error).__name__}: {error}") from None
    return _checked(getattr(module, name, None), file, name)


def _checked(found: Any, file: str, name: str) -> Technique[..., Any]:
    if not isinstance(found, Shader):
        what = "has no" if found is None else "does not mark"
        raise InputError(f"{file}: it {what} {name}; mark a technique with @technique()")
    made = found if isinstance(found, Technique) else Technique(found.function)
    bound_types({displace: made})
    return made
