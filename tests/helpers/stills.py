"""Viewer pages without still pictures, for tests that do not need them."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator

import pytest


@contextlib.contextmanager
def no_stills() -> Iterator[None]:
    """Write pages without the pictures for browsers without WebGPU.

    These would compile up to four programs per page.
    """
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("basrelief.viewer.page._stills", lambda *_: [])
        yield
