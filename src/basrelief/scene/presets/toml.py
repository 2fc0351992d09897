"""Values as the text of a TOML file (TOML 1.0); Python's own library only reads them."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping
from typing import Any

_BARE = re.compile(r"[A-Za-z0-9_-]+")


def written(values: Mapping[str, Any]) -> str:
    """Tables, lists, texts, numbers and booleans as TOML; what is read back is the same."""
    return "\n".join(_table(values, ())) + "\n"


def _table(values: Mapping[str, Any], path: tuple[str, ...]) -> Iterator[str]:
    """Plain values first, as they belong to the heading above them; then tables."""
    tables = {key: each for key, each in values.items() if _is_table(each) or _are_tables(each)}
    for key, each in values.items():
        if key not in tables:
            yield f"{_key(key)} = {_value(each)}"
    for key, each in tables.items():
        inner = (*path, key)
        heading = ".".join(map(_key, inner))
        for one in [each] if _is_table(each) else each:
            yield ""
            yield f"[{heading}]" if _is_table(each) else f"[[{heading}]]"
            yield from _table(one, inner)


def _is_table(value: Any) -> bool:
    return isinstance(value, Mapping)


def _are_tables(value: Any) -> bool:
    return isinstance(value, list | tuple) and bool(value) and all(map(_is_table, value))


def _key(key: str) -> str:
    return key if _BARE.fullmatch(key) else _text(key)


def _value(value: Any) -> str:
    if isinstance(value, str):
        return _text(value)
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, list | tuple):
        return f"[{', '.join(map(_value, value))}]"
    # the shortest text that is read back as the same number
    return repr(value)


def _text(text: str) -> str:
    # JSON's strings are TOML's, but for the one control character that JSON leaves as it is
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")
