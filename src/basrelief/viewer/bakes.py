"""What a page needs to bake as the library does: the programs, and the numbers of their steps.

The steps themselves are those of `bake.bounds` and `bake.cones`; `web/bakes.js` goes through them.
"""

from __future__ import annotations

from typing import Any

from basrelief.bake.bounds import FAR_WINDOWS
from basrelief.bake.cones import SECTORS, ends_of, sector_of
from basrelief.lang import Shader
from basrelief.shaders.bakes import bounds, cones, texels, windows
from basrelief.shaders.bakes.bounds import FAR_REACH, REACH
from basrelief.shaders.techniques.exact import BLOCK, FAR_BLOCK
from basrelief.viewer.layouts import plain

BAKES: tuple[Shader[..., Any], ...] = (
    texels.normals,
    bounds.block_top,
    bounds.window_top,
    bounds.near_record,
    bounds.far_record,
    cones.far_side,
    cones.steepest,
    cones.cone_of,
    cones.relaxed_cone_of,
    windows.first_windows,
    windows.next_windows,
)
"""The programs that bake something; a page finds them by their names."""


def is_asked(choices: Any) -> Shader[..., Any]:
    """Which windows `steepest` goes through: those of one sector, or all."""
    return cones.in_sector if choices.in_sector else cones.everywhere


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
