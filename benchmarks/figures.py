"""Options of all benchmarks, and the file of their figures."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Mapping
from pathlib import Path


def option_parser(description: str | None) -> argparse.ArgumentParser:
    """Parser with `--quick` and `--json`, for a benchmark to add its own options to."""
    parser = argparse.ArgumentParser(
        description=description, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "--quick", action="store_true", help="run the same code on tiny inputs, in seconds"
    )
    parser.add_argument("--json", type=Path, metavar="FILE", help="store the figures in a file")
    return parser


def store(file: Path | None, figures: Mapping[str, float]) -> None:
    """Write figures by name to a JSON file, under the name of the script.

    Other figures in the file are kept. Does nothing without a file.
    """
    if file is None:
        return
    stored = json.loads(file.read_text("utf-8")) if file.exists() else {}
    stored.setdefault(Path(sys.argv[0]).stem, {}).update(figures)
    file.write_text(json.dumps(stored, indent=2, ensure_ascii=False) + "\n", "utf-8")
