"""Files on a disk that is full: every writer says so, and the old file stays.

The disk is a small tmpfs, which Linux lets root mount for one process.
"""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from helpers.command_line import environment

SUFFIXES = (".png", ".jpg", ".webp", ".exr", ".hdr", ".tif")
FILMS = (".mp4", ".gif", ".webp", ".png")
SCRIPT = """
import sys
from pathlib import Path

import numpy as np

from basrelief import InputError
from basrelief.images import write_data, write_picture
from basrelief.pages import write_page
from basrelief.rendering.film import write_film
from basrelief.rendering.frame import Frame

kind, disk = sys.argv[1], Path(sys.argv[2])
noise = np.random.default_rng(1).random((256, 256, 4), np.float32)
file = disk / f"old.{kind.rpartition('.')[2]}"
file.write_text("old")


def frame(number):
    flat = np.zeros((256, 256), np.float32)
    return Frame(np.roll(noise, number), flat, noise[:, :, :2], flat > 0, flat.astype(int), "cpu")


try:
    match kind.partition(".")[0]:
        case "picture":
            write_picture(file, noise)
        case "codes":
            frame(0).save(file)
        case "map":
            write_data(file, (noise * 65535).astype(np.uint16))
        case "page":
            write_page(file, str(noise.tolist()))
        case "film":
            write_film(file, map(frame, range(8)), count=8)
    print("written")
except InputError as error:
    print(error)
print(*sorted(path.name for path in disk.iterdir()), file.read_text() == "old")
"""


@pytest.fixture
def on_small_disk(tmp_path: Path):
    """Runs a script with a folder of 64 KiB, which is its folder for temporary files too."""
    may_mount = ["unshare", "-m", "mount", "-t", "tmpfs", "none", str(tmp_path)]
    if not shutil.which("unshare") or subprocess.run(may_mount, capture_output=True).returncode:
        pytest.skip("only root may mount a small disk, on Linux")
    mount = f'mount -t tmpfs -o size=64k none "{tmp_path}" && exec "$0" "$@"'

    def run(kind: str) -> list[str]:
        done = subprocess.run(
            ["unshare", "-m", "sh", "-c", mount, sys.executable, "-c", SCRIPT, kind, str(tmp_path)],
            capture_output=True,
            text=True,
            env={**os.environ, **environment(), "TMPDIR": str(tmp_path)},
            timeout=60,
        )
        assert done.returncode == 0, done.stderr
        return done.stdout.splitlines()

    return run


@pytest.mark.parametrize(
    "kind",
    [
        *(f"picture{suffix}" for suffix in SUFFIXES),
        "codes.png", "codes.jpg", "map.png", "map.tif", "page.html",
        *(f"film{suffix}" for suffix in FILMS if suffix != ".png"),
    ],
)  # fmt: skip
def test_the_old_file_stays(on_small_disk, kind: str) -> None:
    message, left = on_small_disk(kind)
    assert "cannot be written (" in message
    assert "space" in message
    assert left == f"old{Path(kind).suffix} True"


def test_numbered_pictures_are_whole_or_missing(on_small_disk) -> None:
    message, left = on_small_disk("film.png")
    assert "cannot be written (No space left on device)" in message
    assert left == "old.png True"
