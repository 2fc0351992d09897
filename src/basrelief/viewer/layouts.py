"""Records as a page writes them: where each field lies, what it means, and its range.

Read off the records themselves, so that a page has no copy of its own to keep.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import MISSING, fields
from typing import Any

import numpy as np

from basrelief.lang.layout import align_and_size, offsets
from basrelief.lang.types import VECTORS, fields_of, is_record, leaf_values


def layouts(names: Mapping[Any, str]) -> dict[str, Any]:
    """Each record by its name: its size in words, and its fields: name, type, offset in words."""
    return {
        name: {
            "words": align_and_size(record)[1] // 4,
            "align": align_and_size(record)[0] // 4,
            "fields": [
                [each, names.get(t, t.__name__), offset // 4] for each, offset, t in offsets(record)
            ],
        }
        for record, name in names.items()
        if is_record(record) and _is_laid_out(record)
    }


def _is_laid_out(record: type) -> bool:
    """Whether a record can lie in memory: one with a bool, as a hit, stays within a program."""
    return all(
        _is_laid_out(t) if is_record(t) else t is not bool for t in fields_of(record).values()
    )


def settings_of(record: type) -> list[dict[str, Any]]:
    """The settings of a record: name, meaning, range, default, and whether it is a whole number."""
    return [
        {
            "name": each.name,
            "doc": each.metadata["doc"],
            "low": each.metadata["low"],
            "high": each.metadata["high"],
            "default": json_value(each.default),
            "whole": fields_of(record)[each.name] is int,
        }
        for each in fields(record)
        if "doc" in each.metadata and each.default is not MISSING
    ]


def json_value(value: Any) -> Any:
    """A value of the subset as JSON has it: a number, a list of them, or a record as a mapping.

    Matrices are lists of nine, column by column.
    """
    t = type(value)
    if is_record(t):
        return {name: json_value(getattr(value, name)) for name in fields_of(t)}
    if t.__name__ == "Mat3" or t in VECTORS:
        return [_short(leaf) for leaf in leaf_values(value, t)]
    return _short(value)


def _short(value: Any) -> float | int:
    """A number with as many digits as its 32 bits have: 0.1, not 0.10000000149."""
    return int(value) if isinstance(value, int | np.integer) else float(str(value))
