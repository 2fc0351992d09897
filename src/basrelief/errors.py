"""What goes wrong because of what the user gave: one line that says what, where and what to do."""

from __future__ import annotations

from collections.abc import Collection


class BasreliefError(Exception):
    """Any error of this library that its user can fix; its text is one line.

    The command line prints the text and leaves with exit code 2.
    """


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
    "level": "reference_height",
    "finish": "surface_parameters",
    "finish_of": "all_surface_parameters",
    "Finish": "SurfaceParameters",
    "air": "fog",
    "shadow_map": "shadow_map_size",
    "turned": "rotated",
    "Tuned": "TuneResult",
    "View": "ViewerPage",
}
"""The new name of each renamed option (with its dashes), keyword, setting, preset key and Python
name. The old name is refused with a hint to the new one. CHANGELOG.md has the same table."""


def new_name(name: str, known: Collection[str]) -> str:
    """The hint "OLD is now NEW" for a renamed name; "" unless the new name is a known one."""
    new = RENAMED.get(name)
    return f"{name} is now {new}" if new in known else ""


def suggestion(name: str, known: Collection[str], lead: str = "there are") -> str:
    """What to write in place of an unknown name: its new name, or else the list of known names."""
    return new_name(name, known) or f"{lead} {', '.join(known) or 'none'}"
