"""Stored digests of the planes of the CPU engine's frames, which reveal any changed bit.

`frame_hashes.json` has a line for each of `frame_cases.CASES`, with a digest for each plane.
Refactoring keeps them all; they change only in commits that explain why. To update them, and see
which cases and planes differ:

    PYTHONPATH=tests .venv-test/bin/python -m helpers.frame_hashes
    git diff --word-diff tests/rendering/frame_hashes.json
"""

from __future__ import annotations

import hashlib
import json

import numpy as np

from basrelief import Frame
from helpers import frame_cases
from helpers.repository import TESTS

STORE = TESTS / "rendering" / "frame_hashes.json"
PLANES = ("color", "distance", "uv", "hit", "reads")
DIGITS = 12
"""Hexadecimal digits of a digest: two different planes share one with a probability of 2⁻⁴⁸."""
Digests = dict[str, str]
"""A digest for each plane."""


def digests(frame: Frame) -> Digests:
    """Digests of a frame's planes: type, shape and bytes.

    Fails for planes with NaN, whose bits depend on the processor.
    """
    return {name: _digest(name, getattr(frame, name)) for name in PLANES}


def _digest(name: str, plane: np.ndarray) -> str:
    assert not np.isnan(plane).any(), f"NaN in {name}: its bits depend on the processor"
    little_endian = plane.astype(plane.dtype.newbyteorder("<"))
    header = f"{little_endian.dtype.str} {plane.shape} ".encode()
    return hashlib.sha256(header + little_endian.tobytes()).hexdigest()[:DIGITS]


def stored() -> dict[str, Digests]:
    """The stored digests by case."""
    return json.loads(STORE.read_text(encoding="utf-8"))


def text(digests_of_cases: dict[str, Digests]) -> str:
    """The stored form: sorted JSON with one case per line."""
    lines = [
        f"  {json.dumps(name)}: {json.dumps(digests_of_cases[name])}"
        for name in sorted(digests_of_cases)
    ]
    return "{\n" + ",\n".join(lines) + "\n}\n"


def store_all() -> None:
    """Draw every case and store its digests."""
    digests_of_cases = {name: digests(frame_cases.drawn(name)) for name in frame_cases.CASES}
    STORE.write_text(text(digests_of_cases), encoding="utf-8")
    print(f"{STORE}: {len(digests_of_cases)} cases")


if __name__ == "__main__":
    store_all()
