"""Encoding of pixels as the bytes of a picture file, by OpenImageIO.

OpenImageIO writes only to paths. Its writers of PNG and JPEG do not report a full disk, and that of
JPEG ends the process. So on Linux they get a file in memory, and elsewhere a temporary one on a
disk that has room for it.
"""

from __future__ import annotations

import contextlib
import errno
import os
import shutil
import tempfile
from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np

from basrelief.images.read import Pixels, first_line, take_error

_RESERVE = 1 << 20
"""Bytes that a file may have beyond its pixels: headers, tables, and blocks that did not shrink."""


def encoded(suffix: str, pixels: Pixels, stored: str, attributes: Mapping[str, int | str]) -> bytes:
    """The bytes of a picture file.

    Parameters
    ----------
    suffix
        Suffix of the format, as ".png".
    pixels
        (height, width, 1 to 4), of a type that converts to `stored` without loss.
    stored
        OpenImageIO's type of a channel in the file: "uint8", "uint16", "half" or "float".
    attributes
        OpenImageIO's attributes of the file.

    Raises
    ------
    OSError
        If the picture cannot be encoded, or the temporary folder is full.
    """
    import OpenImageIO

    height, width, channels = pixels.shape
    spec = OpenImageIO.ImageSpec(width, height, channels, stored)
    spec.attribute("oiio:UnassociatedAlpha", 1)
    spec.attribute("DateTime", "1970:01:01 00:00:00")  # so that equal pixels give equal files
    for name, value in attributes.items():
        spec.attribute(name, value)
    output = OpenImageIO.ImageOutput.create(f"picture{suffix}")
    if output is None:
        raise OSError(first_line(take_error(OpenImageIO)))
    with _scratch_file(suffix, pixels.nbytes + _RESERVE) as path:
        try:
            done = output.open(str(path), spec) and output.write_image(np.ascontiguousarray(pixels))
        finally:
            closed = output.close()
        problem = take_error(output) or take_error(OpenImageIO)
        if not (done and closed):
            raise OSError(first_line(problem))
        return path.read_bytes()


@contextlib.contextmanager
def _scratch_file(suffix: str, size: int) -> Iterator[Path]:
    """A file of up to `size` bytes."""
    if hasattr(os, "memfd_create") and os.path.isdir("/proc/self/fd"):
        descriptor = os.memfd_create("picture")
        try:
            yield Path(f"/proc/self/fd/{descriptor}")
        finally:
            os.close(descriptor)
        return
    with tempfile.TemporaryDirectory() as folder:
        if shutil.disk_usage(folder).free < size:
            raise OSError(errno.ENOSPC, f"no space left in {tempfile.gettempdir()}")
        yield Path(folder) / f"picture{suffix}"
