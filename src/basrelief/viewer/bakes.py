"""What a page needs to bake as the library does: the programs, and the numbers of their steps.

The steps themselves are those of `bake.bounds` and `bake.cones`; `web/bakes.js` goes through them.
A page's maps repeat, and only their finest level is baked.
"""

from __future__ import annotations

from typing import Any

from basrelief.bake.bounds import FAR_WINDOWS
from basrelief.bake.cones import SECTORS, ends_of, sector_of
from basrelief.lang import Shader
from basrelief.lang.program import Program
from basrelief.shaders.bakes import bounds, cones, texels, windows
from basrelief.shaders.bakes.bounds import FAR_REACH, REACH
from basrelief.shaders.edge import edges_of
from basrelief.shaders.techniques.exact import BLOCK, FAR_BLOCK
from basrelief.viewer.layouts import plain

BAKED_NORMALS = "normals"
"""The key of the program that makes normals of heights."""
_ENTRIES: dict[str, Shader[..., Any]] = {
    BAKED_NORMALS: texels.normals,
    "block_top": bounds.block_top,
    "window_top": bounds.window_top,
    "near_record": bounds.near_record,
    "far_record": bounds.far_record,
    "far_side": cones.far_side,
    "first_windows": windows.first_windows,
    "next_windows": windows.next_windows,
    "steepest_everywhere": cones.steepest,
    "steepest_in_sector": cones.steepest,
    "cone_of": cones.cone_of,
    "relaxed_cone_of": cones.relaxed_cone_of,
}


def bake_programs() -> dict[str, Program]:
    """Every program that bakes something, by the key that a page has it by."""
    made = {}
    for key, entry in _ENTRIES.items():
        asked = cones.in_sector if key == "steepest_in_sector" else cones.everywhere
        made[key] = Program(entry, {**edges_of("wrap"), cones.is_asked: asked}, "wrap")
    return made


def bake_numbers() -> dict[str, Any]:
    """The numbers of the steps: widths and margins in cells and blocks, sectors as directions."""
    return {
        "bounds": {
            "block": BLOCK,
            "reach": REACH,
            "farBlock": FAR_BLOCK,
            "farReach": FAR_REACH,
            "farWindows": list(FAR_WINDOWS.items()),
        },
        "cones": {
            "blocks": cones.BLOCKS,
            "sectors": [
                {"asked": plain(sector_of(k)), "ends": [plain(end) for end in ends_of(k)]}
                for k in range(SECTORS)
            ],
        },
    }
