"""What goes wrong because of what the user gave: one line that says what, where and what to do."""

from __future__ import annotations


class BasreliefError(Exception):
    """Any error of this library that its user can fix; its text is one line.

    The command line prints the text and leaves with exit code 2.
    """


class InputError(BasreliefError):
    """A file, folder, map or value that cannot be used."""


class DeviceError(BasreliefError):
    """A device that cannot be used, such as a GPU where there is none."""
