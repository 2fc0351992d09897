"""The viewer: one HTML page with a material's maps and the programs that the engines run.

    write_view(scene, "page.html")

The page needs no network, no server and no Python; it draws by WebGPU.
"""

from basrelief.viewer.page import View, write_view
from basrelief.viewer.state import Sources

__all__ = ["Sources", "View", "write_view"]
