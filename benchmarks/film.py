"""Films as users write them: frames a second by format and device, and where the time goes.

The films are of 1920 × 1080 with 4 samples a pixel. A thread draws while others encode, so the
steps of a film add up to more than the whole.
"""

from __future__ import annotations

import tempfile
from pathlib import Path

from figures import option_parser, store

import basrelief
from basrelief.engine import Engine, choose_device
from basrelief.rendering.film import frames, write_film
from basrelief.timings import Timings

SIZE = (1920, 1080)
COUNT = {"mp4": 120, "png": 30}
"""Frames by suffix."""


def film_of(
    stones: basrelief.Material, size: tuple[int, int], suffix: str, count: int, engine: Engine
) -> Timings:
    """Where the time of writing a film goes."""
    with tempfile.TemporaryDirectory() as folder, Timings() as timings:
        drawn = frames(stones, count=count, size=size, technique="relief", device=engine)
        write_film(Path(folder) / f"film.{suffix}", drawn, count=count)
    return timings


def main() -> None:
    parser = option_parser(__doc__)
    parser.add_argument("device", nargs="*", default=["cpu"])
    options = parser.parse_args()
    maps, size = (64, (96, 54)) if options.quick else (1024, SIZE)
    stones = basrelief.sample("cobbles", maps)
    figures = {}
    for device in options.device:
        engine = choose_device(device)
        print(f"{device}: {engine.adapter}")
        for suffix, usual in COUNT.items():
            count = 4 if options.quick else usual
            film_of(stones, size, suffix, 2, engine)
            timings = film_of(stones, size, suffix, count, engine)
            rate = count / timings.total
            figures[f"{device}, {suffix}, frames a second"] = rate
            steps = ", ".join(f"{k} {v / count * 1e3:.1f}" for k, v in timings.seconds.items())
            print(f"  {suffix}: {rate:.1f} frames a second  (ms a frame: {steps})")
    store(options.json, figures)


if __name__ == "__main__":
    main()
