"""Reports on a material: a dictionary for `info --json`, lines of text for `info`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from basrelief.material.material import Map, Material
from basrelief.material.options import MAPS


def describe(material: Material) -> dict[str, Any]:
    """The material as a dictionary for JSON.

    `maps` has an entry for each map of `MAPS`, None where it is missing: `source`, `width`,
    `height`, `channels`, `bits` (32: floats), `srgb`, and `range`, the smallest and the largest
    stored value. `depth` and `tile` are metres, `scale` is their ratio. `decisions` are the notes.
    """
    maps = dict(material.maps())
    return {
        "name": material.name,
        "maps": {kind: _describe_map(maps[kind]) if kind in maps else None for kind in MAPS},
        "depth": material.depth,
        "tile": material.tile,
        "scale": material.scale,
        "decisions": [{"what": note.what, "why": note.why} for note in material.notes],
    }


def _describe_map(item: Map) -> dict[str, Any]:
    return {
        "source": item.source,
        "width": item.width,
        "height": item.height,
        "channels": item.channels,
        "bits": item.bits,
        "srgb": item.srgb,
        "range": list(item.range()),
    }


def report(material: Material) -> str:
    """The material as text: a table of its maps, its lengths, and each decision with its reason."""
    rows = [
        (
            kind.replace("_", " "),
            item.source,
            f"{item.width}×{item.height}",
            "float" if item.bits == 32 else f"{item.bits} bit",
            "sRGB" if item.srgb else "linear",
            "{:.3g} to {:.3g}".format(*item.range()),
        )
        for kind, item in material.maps()
    ]
    missing = [kind.replace("_", " ") for kind in MAPS if kind not in dict(material.maps())]
    lines = [material.name, "", *_aligned(rows)]
    if missing:
        lines.append(f"  without {', '.join(missing)}")
    if material.scale is not None:
        lengths = f"depth {material.depth:g} m, tile {material.tile:g} m"
        lines += ["", f"  {lengths}: scale {material.scale:.4g}"]
    lines += ["", *(f"  {note}" for note in material.notes)]
    return "\n".join(lines)


def _aligned(rows: Sequence[tuple[str, ...]]) -> list[str]:
    widths = [max(len(cell) for cell in column) for column in zip(*rows, strict=True)]
    return [
        "  "
        + "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip()
        for row in rows
    ]
