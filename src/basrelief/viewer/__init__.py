"""The viewer: one HTML page with a material's maps, and the same shaders that the engines run.

    write_view(scene, "page.html")

The page needs no network, no server and no Python; it draws by WebGPU. In a notebook it is the
widget `Viewer`, which needs the extra `notebook`.
"""

from typing import TYPE_CHECKING, Any

from basrelief.viewer.page import ViewerPage, write_view

if TYPE_CHECKING:
    from basrelief.viewer.notebook import Viewer

__all__ = ["Viewer", "ViewerPage", "write_view"]


def __getattr__(name: str) -> Any:
    if name != "Viewer":
        from basrelief.errors import new_name

        hint = new_name(name, __all__)
        raise AttributeError(hint or f"module 'basrelief.viewer' has no attribute {name!r}")
    # imported when first used: anywidget comes with an extra
    from basrelief.viewer.notebook import Viewer

    return Viewer
