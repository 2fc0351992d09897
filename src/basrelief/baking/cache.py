"""Cache of bakes, in the folder that compiled programs use too.

The key of a bake is a digest of the heights, the edge, the name and parameters of the bake, the
engine's rounding, and all source that can affect the result. A changed method thus never reads
results of an older one, nor one device those of another. Damaged entries are computed again;
without a writable folder nothing is cached.
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

MIN_TEXELS = 128 * 128
"""Texels of a height map below which its bakes are not cached: computing them is fast."""


def cached(
    make: Callable[..., NDArray[Any]],
    heights: NDArray[np.float32],
    edge: Edge,
    engine: Engine,
    **parameters: Any,
) -> NDArray[Any]:
    """Result of `make(heights, edge, device=engine, **parameters)`, from disk if it is cached.

    `make` is a function of this package; `parameters` are numbers and strings.
    """
    if heights.size < MIN_TEXELS:
        return make(heights, edge, device=engine, **parameters)
    key = _key(make, heights, edge, {**parameters, "rounding": engine.rounding})
    result = _read(key)
    if result is None:
        result = make(heights, edge, device=engine, **parameters)
        _write(key, result)
    return result


def _key(
    make: Callable[..., Any],
    heights: NDArray[np.float32],
    edge: Edge,
    parameters: dict[str, Any],
) -> str:
    identity = (make.__module__, make.__qualname__, edge, sorted(parameters.items()), heights.shape)
    values = np.ascontiguousarray(heights).data
    return cache.key_of("bake", repr((*identity, str(heights.dtype), _source())), values)


def _source() -> str:
    """Digest of all source that a bake depends on."""
    return cache.source_digest(
        basrelief.lang, basrelief.techniques, basrelief.engine, basrelief.baking
    )


def _read(key: str) -> NDArray[Any] | None:
    entry = cache.read(key)
    if entry is None:
        return None
    header, content = entry
    try:
        return np.frombuffer(content, header["dtype"]).reshape(header["shape"])
    except (KeyError, TypeError, ValueError):
        return None


def _write(key: str, result: NDArray[Any]) -> None:
    header = {"dtype": result.dtype.str, "shape": result.shape}
    cache.write(key, header, np.ascontiguousarray(result).data)
