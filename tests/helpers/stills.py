"""Pages of the viewer without their still pictures, which tests of other parts do not look at."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator

import pytest


@contextlib.contextmanager
def no_stills() -> Iterator[None]:
    """Pages written meanwhile have no pictures for browsers without WebGPU.

    Each page would compile up to four programs for them.
    """
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("basrelief.viewer.page._stills", lambda *_: [])
        yield
