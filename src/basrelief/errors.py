"""Errors that users can fix: one line with what is wrong, where, and what to do.

An error in a shader also has the source line, with a caret under the expression in question.
"""

from __future__ import annotations

from collections.abc import Collection
from difflib import get_close_matches


class BasreliefError(Exception):
    """Base of the errors that users can fix; the message is one line.

    The command line prints the message and exits with code 2.

    Attributes
    ----------
    excerpt : str
        For an error in a shader, its source line, and carets below the expression in question;
        empty for other errors.
    """

    excerpt: str = ""

    def __str__(self) -> str:
        message = super().__str__()
        return f"{message}\n{self.excerpt}" if self.excerpt else message


class InputError(BasreliefError):
    """A file, folder, map or value that cannot be used."""


class DeviceError(BasreliefError):
    """A device that cannot be used, such as a GPU where there is none."""


# --- unknown names -------------------------------------------------------------------------------

RENAMED = {
    "--engine": "--device",
    "engine": "device",
    "choose_engine": "choose_device",
    "EngineError": "DeviceError",
    "--fog": "--fog-mode",
    "--level": "--reference-height",
    "--height-map": "--height",
    "--normal-map": "--normal",
    "level": "reference_height",
    "finish": "surface_parameters",
    "finish_of": "all_surface_parameters",
    "Finish": "SurfaceParameters",
    "air": "fog",
    "shadow_map": "shadow_map_size",
    "shadow_steps": "max_shadow_steps",
    "shadow_softness": "light_angle",
    "turned": "rotated",
    "Tuned": "TuneResult",
    "View": "ViewerPage",
}
"""The new name of each renamed option (with its dashes), keyword, setting, preset key and Python
name. The old name is refused with a hint to the new one. CHANGELOG.md has the same table."""


def new_name(name: str, known: Collection[str]) -> str:
    """The hint "OLD is now NEW" for a renamed name; "" unless the new name is known."""
    new = RENAMED.get(name)
    return f"{name} is now {new}" if new in known else ""


def suggestion(name: str, known: Collection[str], lead: str = "there are") -> str:
    """Hint for an unknown name: its new name, or the list of known names and the nearest one."""
    listed = f"{lead} {', '.join(known) or 'none'}"
    return new_name(name, known) or f"{listed}{closest(name, known)}"


def closest(name: str, known: Collection[str]) -> str:
    """The end of a message that suggests the known name spelled most like another; "" for none."""
    close = get_close_matches(str(name), known, 1, 0.75)
    return f"; did you mean {close[0]}?" if close else ""
