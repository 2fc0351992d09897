"""Bakes kept on disk, found by content, beside the compiled programs.

A bake is found again by the heights' own numbers, the edge, its name and parameters, how the engine
rounds, and the source of all that may have a say in it, so that a changed method never finds what
an older one made, nor one device what another made. What is damaged is made anew; where nothing can
be kept, nothing is.
"""

from __future__ import annotations

import contextlib
import functools
import hashlib
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from basrelief import engine
from basrelief._version import __version__
from basrelief.engine import Engine, cache
from basrelief.lang.resources import Edge

LIMIT = 2 * 1024**3
"""Bytes that kept bakes may take together; those not used for longest go first."""
WORTH = 128 * 128
"""Texels of a height map from which on it pays to keep what is baked from it."""
_PREFIX = "bake-"
_SAYING = ("lang", "techniques", "engine", "baking")
"""The parts of the package whose source says what comes out of a bake."""


def kept(
    make: Callable[..., NDArray[Any]],
    heights: NDArray[np.float32],
    edge: Edge,
    engine: Engine,
    **parameters: Any,
) -> NDArray[Any]:
    """make(heights, edge, engine=engine, **parameters), from disk where it was made before.

    `make` is a function of this package; `parameters` are numbers and text.
    """
    if heights.size < WORTH:
        return make(heights, edge, engine=engine, **parameters)
    key = _key(make, heights, edge, {**parameters, "rounding": engine.rounding})
    found = _read(key)
    if found is None:
        found = make(heights, edge, engine=engine, **parameters)
        _write(key, found)
    return found


def _key(
    make: Callable[..., Any],
    heights: NDArray[np.float32],
    edge: Edge,
    parameters: dict[str, Any],
) -> str:
    said = (make.__module__, make.__qualname__, edge, sorted(parameters.items()), heights.shape)
    digest = hashlib.sha256(repr((*said, str(heights.dtype), _source())).encode())
    digest.update(np.ascontiguousarray(heights).data)
    return _PREFIX + digest.hexdigest()


@functools.cache
def _source() -> str:
    """A digest of the source that bakes are made by."""
    home = Path(engine.__file__).parent.parent
    digest = hashlib.sha256(__version__.encode())
    for part in _SAYING:
        for file in sorted((home / part).rglob("*.py")):
            digest.update(file.read_bytes())
    return digest.hexdigest()


def _read(key: str) -> NDArray[Any] | None:
    stored = cache.read(key)
    if stored is None:
        return None
    header, content = stored
    try:
        found = np.frombuffer(content, header["dtype"]).reshape(header["shape"])
    except (KeyError, TypeError, ValueError):
        return None
    with contextlib.suppress(OSError):
        os.utime(cache.cache_folder() / key)
    return found


def _write(key: str, made: NDArray[Any]) -> None:
    if made.nbytes > LIMIT:
        return
    header = {"dtype": made.dtype.str, "shape": made.shape}
    cache.write(key, header, made.tobytes())
    with contextlib.suppress(OSError):
        _drop_oldest()


def _drop_oldest() -> None:
    """Remove what was not used for longest, until the rest is within the limit."""
    files = []
    for path in cache.cache_folder().glob(_PREFIX + "*"):
        with contextlib.suppress(OSError):
            known = path.stat()
            files.append((known.st_mtime_ns, known.st_size, path))
    room = LIMIT
    for _, size, path in sorted(files, reverse=True):
        room -= size
        if room < 0:
            with contextlib.suppress(OSError):
                path.unlink()
