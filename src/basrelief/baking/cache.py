"""Keys and array headers of bakes in the cache, which they share with compiled programs.

A bake is found again by the heights' own numbers, the edge, its name and parameters, how the engine
rounds, and the source of all that may have a say in it, so that a changed method never finds what
an older one made, nor one device what another made. What is damaged is made anew; where nothing can
be kept, nothing is.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

import basrelief.baking
import basrelief.engine
import basrelief.lang
import basrelief.techniques
from basrelief.engine import Engine, cache
from basrelief.lang.resources import Edge

WORTH = 128 * 128
"""Texels of a height map from which on it pays to keep what is baked from it."""


def kept(
    make: Callable[..., NDArray[Any]],
    heights: NDArray[np.float32],
    edge: Edge,
    engine: Engine,
    **parameters: Any,
) -> NDArray[Any]:
    """make(heights, edge, device=engine, **parameters), from disk where it was made before.

    `make` is a function of this package; `parameters` are numbers and text.
    """
    if heights.size < WORTH:
        return make(heights, edge, device=engine, **parameters)
    key = _key(make, heights, edge, {**parameters, "rounding": engine.rounding})
    found = _read(key)
    if found is None:
        found = make(heights, edge, device=engine, **parameters)
        _write(key, found)
    return found


def _key(
    make: Callable[..., Any],
    heights: NDArray[np.float32],
    edge: Edge,
    parameters: dict[str, Any],
) -> str:
    said = (make.__module__, make.__qualname__, edge, sorted(parameters.items()), heights.shape)
    values = np.ascontiguousarray(heights).data
    return cache.key_of("bake", repr((*said, str(heights.dtype), _source())), values)


def _source() -> str:
    """A digest of all source that decides what a bake is."""
    return cache.source_digest(
        basrelief.lang, basrelief.techniques, basrelief.engine, basrelief.baking
    )


def _read(key: str) -> NDArray[Any] | None:
    stored = cache.read(key)
    if stored is None:
        return None
    header, content = stored
    try:
        return np.frombuffer(content, header["dtype"]).reshape(header["shape"])
    except (KeyError, TypeError, ValueError):
        return None


def _write(key: str, made: NDArray[Any]) -> None:
    header = {"dtype": made.dtype.str, "shape": made.shape}
    cache.write(key, header, np.ascontiguousarray(made).data)
