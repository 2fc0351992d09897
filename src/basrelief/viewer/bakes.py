"""Data for baking in a page: the programs, and the parameters of their steps.

The steps are those of `baking.exact` and `baking.cone`; `web/bakes.js` runs them.
"""

from __future__ import annotations

from typing import Any

from basrelief.baking.cone import SECTORS, sector_bounds, sector_of
from basrelief.baking.exact import FAR_WINDOWS
from basrelief.lang import Shader
from basrelief.techniques import BAKES, cone_bake, normal_bake
from basrelief.techniques.exact_bake import FAR_REACH, REACH
from basrelief.techniques.exact_records import BLOCK, FAR_BLOCK
from basrelief.viewer.layouts import json_value

PROGRAMS: tuple[Shader[..., Any], ...] = (
    normal_bake.normals,
    *dict.fromkeys(program for bake in BAKES.values() for program in bake.programs),
)
"""The programs that bake; a page finds them by name."""


def bake_numbers() -> dict[str, Any]:
    """Parameters of the steps: widths and margins in cells and blocks, sectors as directions."""
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
                {
                    "record": json_value(sector_of(k)),
                    "ends": [json_value(end) for end in sector_bounds(k)],
                }
                for k in range(SECTORS)
            ],
        },
    }
