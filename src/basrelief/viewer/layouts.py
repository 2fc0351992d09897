"""Layouts of records for a page, and values of the shader subset as JSON.

Layouts are derived from the records, so that a page has no copies.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from basrelief.lang import Mat3
from basrelief.lang.layout import align_and_size, offsets, words
from basrelief.lang.types import VECTORS, fields_of, is_record, leaf_values


def layouts(names: Mapping[Any, str]) -> dict[str, Any]:
    """Layouts by the record's name: size and alignment in words; names, types, offsets.

    The numbers of a matrix have offsets of their own, `scalars`.
    """
    matrix = {"words": 12, "align": 4, "fields": [], "scalars": [*words(Mat3)]}
    return {Mat3.__name__: matrix} | {
        name: {
            "words": align_and_size(record)[1] // 4,
            "align": align_and_size(record)[0] // 4,
            "fields": [
                [field, names.get(t, t.__name__), offset // 4]
                for field, offset, t in offsets(record)
            ],
        }
        for record, name in names.items()
        if is_record(record) and _is_laid_out(record)
    }


def _is_laid_out(record: type) -> bool:
    """Whether a record has a layout in memory; records with a bool, such as hits, have none."""
    return all(
        _is_laid_out(t) if is_record(t) else t is not bool for t in fields_of(record).values()
    )


def json_value(value: Any) -> Any:
    """A value of the shader subset for JSON: a number, a list of numbers, or a mapping of a record.

    Matrices are lists of nine numbers, column by column.
    """
    t = type(value)
    if is_record(t):
        return {name: json_value(getattr(value, name)) for name in fields_of(t)}
    if t is Mat3 or t in VECTORS:
        return [_short(leaf) for leaf in leaf_values(value, t)]
    return _short(value)


def _short(value: Any) -> float | int:
    """The shortest number with the same 32 bits: 0.1, not 0.10000000149."""
    return int(value) if isinstance(value, int | np.integer) else float(str(value))
