"""Build the site of the documentation: `scripts/docs`.

    python docs/site/build.py FOLDER

The pages are the Markdown files that a Git host shows. They are copied to the addresses that they
have on the site, with links rewritten to match, and Zensical renders them; a warning fails the
build. Files that pages link to are copied too; a file of code becomes a page of its own.
"""

from __future__ import annotations

import argparse
import importlib
import json
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path, PurePosixPath
from posixpath import normpath, relpath
from typing import Any
from urllib.parse import quote

import basrelief
from basrelief.viewer import Sources, write_view
from basrelief.viewer.state import state_of

REPOSITORY = Path(__file__).resolve().parents[2]
ADDRESSES = {
    "README.md": "start.md",
    "CONVENTIONS.md": "conventions.md",
    "CHANGELOG.md": "changelog.md",
    "CONTRIBUTING.md": "contributing/index.md",
    "benchmarks/README.md": "contributing/benchmarks.md",
}
"""Where pages are that lie outside docs/."""
LANGUAGES = {".py": "python", ".js": "javascript", ".toml": "toml", ".wgsl": "wgsl"}
"""Files that become pages, and what they are highlighted as."""
LINK = re.compile(r"(?<=\]\()([^()\s]+)(?=\))")
VIEW = "live/bricks.html"
"""The viewer's page, one for all pages of techniques: a browser loads it once."""
NAME = re.compile(r"^::: (\S+)\.(\w+)$", re.M)
"""What mkdocstrings is told to describe."""
LIVE = re.compile(r"^ {4}basrelief render (.*)\n\n(!\[[^]]*\]\(\S*/technique-\w+\.png\))$", re.M)
"""A command, and the picture of a technique that it draws."""


def main() -> int:
    parser = argparse.ArgumentParser(description="Build the site of the documentation.")
    parser.add_argument("folder", type=Path, help="where it goes; replaced if it is there")
    folder: Path = parser.parse_args().folder
    with tempfile.TemporaryDirectory() as temporary:
        made = Path(temporary)
        lay_out(made / "pages")
        write_live(made / "pages" / VIEW)
        shutil.copy(REPOSITORY / "docs" / "site" / "zensical.toml", made)
        (made / "src").symlink_to(REPOSITORY / "src")
        command = [sys.executable, "-m", "zensical", "build", "--strict"]
        code = subprocess.run(command, cwd=made).returncode
        if code == 0:
            shutil.rmtree(folder, ignore_errors=True)
            shutil.copytree(made / "site", folder)
    return code


# --- pages ----------------------------------------------------------------------------------------


def lay_out(folder: Path) -> None:
    """Write all pages, and what they link to, into a folder."""
    docs = REPOSITORY / "docs"
    wanted = [file.relative_to(REPOSITORY).as_posix() for file in docs.rglob("*.md")]
    wanted += [f"docs/site/{name}" for name in ("site.css", "live.js")]
    for file in wanted:  # grows by what pages link to

        def found(target: str) -> None:
            if target not in wanted:
                wanted.append(target)

        written = folder / address(file)
        written.parent.mkdir(parents=True, exist_ok=True)
        if file.endswith(".md"):
            written.write_text(page(file, found))
        elif written.suffix == ".md":
            written.write_text(code_page(file))
        else:
            shutil.copy(REPOSITORY / file, written)


def address(file: str) -> str:
    """Where the site has a file of the repository."""
    if file in ADDRESSES:
        return ADDRESSES[file]
    if PurePosixPath(file).suffix in LANGUAGES and not file.startswith("docs/site/"):
        return f"source/{file}.md"
    return file.removeprefix("docs/") if file.startswith("docs/") else f"files/{file}"


def page(file: str, found: Callable[[str], None]) -> str:
    """The text of a page, with its links turned and the viewer in; what it links to is `found`."""
    text = indented((REPOSITORY / file).read_text())
    here = PurePosixPath(address(file)).parent.as_posix()

    def turned(match: re.Match[str]) -> str:
        target, _, anchor = match[1].partition("#")
        if not target or re.match(r"[a-z]+:", target):
            return match[1]
        target = normpath(PurePosixPath(file).parent / target)
        found(target)
        return relpath(address(target), here) + (f"#{anchor}" if anchor else "")

    def live(match: re.Match[str]) -> str:
        source = relpath(VIEW, here) + settings(match[1])
        return (
            f"    basrelief render {match[1]}\n\n"
            f'<figure class="live" markdown>\n{match[2]}\n'
            f'<iframe title="The viewer" loading="lazy" data-src="{source}" hidden></iframe>\n'
            "</figure>"
        )

    return NAME.sub(defined, LIVE.sub(live, LINK.sub(turned, text)))


def defined(match: re.Match[str]) -> str:
    """A name of the reference by the module that defines it: a package may have one of its name."""
    package, name = match[1], match[2]
    value = getattr(importlib.import_module(package), name)
    home = getattr(value, "__module__", None)
    if home in sys.modules and vars(sys.modules[home]).get(name) is value:
        package = home
    return f"::: {package}.{name}"


def indented(text: str) -> str:
    """The text with what belongs to an item of a list indented by 4, as Python-Markdown wants it;
    Git hosts are content with 2."""
    lines, within = [], False
    for line in text.splitlines():
        within = line.startswith("- ") or (within and line[:1] in ("", " "))
        lines.append(f"  {line}" if within and line.startswith("  ") else line)
    return "\n".join(lines) + "\n"


def code_page(file: str) -> str:
    """A file of code as a page, which the search leaves out."""
    text = (REPOSITORY / file).read_text()
    name, language = PurePosixPath(file).name, LANGUAGES[PurePosixPath(file).suffix]
    head = f"---\nsearch:\n  exclude: true\nhide:\n  - toc\n---\n\n# {name}\n\n`{file}`\n\n"
    return f"{head}````{language}\n{text}````\n"


# --- the viewer -----------------------------------------------------------------------------------


@cache
def sample(name: str) -> basrelief.Material:
    """A small sample without normals: the page makes those of heights itself."""
    return replace(basrelief.sample(name, 256), normal=None)


def scene_of(options: str) -> basrelief.Scene:
    """The scene that the options of `render` describe, of those that pages of techniques use."""
    parser = argparse.ArgumentParser()
    parser.add_argument("sample")
    parser.add_argument("--technique", default="relief")
    parser.add_argument("--scale", type=float)
    parser.add_argument("--set", action="append", default=[], type=lambda text: text.split("="))
    parser.add_argument("--camera", default="")
    parser.add_argument("-o")
    given = parser.parse_args(shlex.split(options))
    material = sample(given.sample.removeprefix("sample:"))
    settings = {name: json.loads(value) for name, value in given.set}
    shown = basrelief.Object(
        material, technique=given.technique, scale=given.scale, settings=settings
    )
    camera = dict(each.split("=") for each in given.camera.split(","))
    return basrelief.Scene(
        (shown,), camera=basrelief.Orbit(**{name: float(x) for name, x in camera.items()})
    )


USUAL = "sample:bricks --scale 0.1 --camera azimuth=25,elevation=18,distance=0.75,field_of_view=38"


def settings(options: str) -> str:
    """What the address of the viewer's page says so that it shows what a command draws."""
    usual, scene = scene_of(USUAL), scene_of(options)
    changed = difference(state_of(scene, scene.objects[0]), state_of(usual, usual.objects[0]))
    return f"#{quote(json.dumps(changed))}" if changed else ""


def difference(now: Any, then: Any) -> Any:
    """What differs, as nested as it is; None where nothing does."""
    if not isinstance(now, dict) or not isinstance(then, dict):
        return None if now == then else now
    found = {name: difference(value, then.get(name)) for name, value in now.items()}
    return {name: value for name, value in found.items() if value is not None} or None


def write_live(file: Path) -> None:
    """Write the viewer's page, without its still pictures: the page around has one."""
    file.parent.mkdir(parents=True)
    write_view(scene_of(USUAL), file, sources=Sources(material="sample:bricks"), engine="cpu")
    file.write_text(re.sub(r"<figure>.*?</figure>\n?", "", file.read_text(), flags=re.S))


if __name__ == "__main__":
    sys.exit(main())
