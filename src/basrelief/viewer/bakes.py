"""What a page needs to bake as the library does: the programs, and the numbers of their steps.

The steps themselves are those of `bake.bounds` and `bake.cones`; `web/bakes.js` goes through them.
"""

from __future__ import annotations

from typing import Any

from basrelief.baking.cone import SECTORS, ends_of, sector_of
from basrelief.baking.exact import FAR_WINDOWS
from basrelief.lang import Shader
from basrelief.techniques import cone_bake, cone_bake_windows, exact_bake, normal_bake
from basrelief.techniques.exact import BLOCK, FAR_BLOCK
from basrelief.techniques.exact_bake import FAR_REACH, REACH
from basrelief.viewer.layouts import plain

BAKES: tuple[Shader[..., Any], ...] = (
    normal_bake.normals,
    exact_bake.block_top,
    exact_bake.window_top,
    exact_bake.near_record,
    exact_bake.far_record,
    cone_bake.far_side,
    cone_bake.steepest,
    cone_bake.cone_of,
    cone_bake.relaxed_cone_of,
    cone_bake_windows.first_windows,
    cone_bake_windows.next_windows,
)
"""The programs that bake something; a page finds them by their names."""


def is_asked(choices: Any) -> Shader[..., Any]:
    """Which windows `steepest` goes through: those of one sector, or all."""
    return cone_bake.in_sector if choices.in_sector else cone_bake.everywhere


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
            "blocks": cone_bake.BLOCKS,
            "sectors": [
                {"asked": plain(sector_of(k)), "ends": [plain(end) for end in ends_of(k)]}
                for k in range(SECTORS)
            ],
        },
    }
