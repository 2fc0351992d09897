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
from dataclasses import replace
from functools import cache
from pathlib import Path, PurePosixPath
from posixpath import normpath, relpath
from typing import Any
from urllib.parse import quote

import basrelief
from basrelief.viewer import write_view
from basrelief.viewer.state import state_of

REPOSITORY = Path(__file__).resolve().parents[2]
ADDRESSES = {
    "README.md": "start.md",
    "CONVENTIONS.md": "conventions.md",
    "CHANGELOG.md": "changelog.md",
    "CONTRIBUTING.md": "contributing/index.md",
    "benchmarks/README.md": "contributing/benchmarks.md",
}
"""The paths on the site of pages outside docs/."""
LANGUAGES = {".py": "python", ".js": "javascript", ".toml": "toml", ".wgsl": "wgsl"}
"""The languages of files that become pages, by suffix."""
LINK = re.compile(r"(?<=\]\()([^()\s]+)(?=\))")
VIEW = "live/bricks.html"
"""The viewer's page, one for all pages of techniques: a browser loads it once."""
NAME = re.compile(r"^::: (\S+)\.(\w+)$", re.M)
"""An object that mkdocstrings describes."""
START = "sample:bricks --scale 0.1 --camera azimuth=25,elevation=18,distance=0.75,field_of_view=38"
"""What that page shows first; an address says what differs."""
LIVE = re.compile(r"^ {4}basrelief render (.*)\n\n(!\[[^]]*\]\(\S*/technique-\w+\.png\))$", re.M)
"""A command, and the picture of a technique that it draws."""


def main() -> int:
    parser = argparse.ArgumentParser(description="Build the site of the documentation.")
    parser.add_argument("folder", type=Path, help="where it goes; replaced if it is there")
    folder: Path = parser.parse_args().folder
    with tempfile.TemporaryDirectory() as temporary:
        project = Path(temporary)
        write_pages(project / "pages")
        write_view_page(project / "pages" / VIEW)
        shutil.copy(REPOSITORY / "docs" / "site" / "zensical.toml", project)
        (project / "src").symlink_to(REPOSITORY / "src")
        command = [sys.executable, "-m", "zensical", "build", "--strict"]
        code = subprocess.run(command, cwd=project).returncode
        if code == 0:
            shutil.rmtree(folder, ignore_errors=True)
            shutil.copytree(project / "site", folder)
    return code


# --- pages ----------------------------------------------------------------------------------------


def write_pages(folder: Path) -> None:
    """Write all pages, and the files that they link to, into a folder."""
    docs = REPOSITORY / "docs"
    files = [file.relative_to(REPOSITORY).as_posix() for file in docs.rglob("*.md")]
    files += [f"docs/site/{name}" for name in ("site.css", "live.js")]
    for file in files:  # grows by the targets of links
        target = folder / address(file)
        target.parent.mkdir(parents=True, exist_ok=True)
        if file.endswith(".md"):
            text, linked = page(file)
            target.write_text(text)
            files += [name for name in linked if name not in files]
        elif target.suffix == ".md":
            target.write_text(code_page(file))
        else:
            shutil.copy(REPOSITORY / file, target)


def address(file: str) -> str:
    """The path on the site of a file of the repository."""
    if file in ADDRESSES:
        return ADDRESSES[file]
    if PurePosixPath(file).suffix in LANGUAGES and not file.startswith("docs/site/"):
        return f"source/{file}.md"
    return file.removeprefix("docs/") if file.startswith("docs/") else f"files/{file}"


def page(file: str) -> tuple[str, list[str]]:
    """A page with rewritten links and the viewer, and the files that it links to."""
    text = indent_lists((REPOSITORY / file).read_text())
    folder = PurePosixPath(address(file)).parent.as_posix()
    linked: list[str] = []

    def rewrite_link(match: re.Match[str]) -> str:
        target, _, anchor = match[1].partition("#")
        if not target or re.match(r"[a-z]+:", target):
            return match[1]
        linked.append(normpath(PurePosixPath(file).parent / target))
        return relpath(address(linked[-1]), folder) + (f"#{anchor}" if anchor else "")

    def embed_viewer(match: re.Match[str]) -> str:
        source = relpath(VIEW, folder) + fragment(match[1])
        return (
            f"    basrelief render {match[1]}\n\n"
            f'<figure class="live" markdown>\n{match[2]}\n'
            f'<iframe title="The viewer" loading="lazy" data-src="{source}" hidden></iframe>\n'
            "</figure>"
        )

    text = LIVE.sub(embed_viewer, LINK.sub(rewrite_link, text))
    return NAME.sub(qualify, text), linked


def qualify(match: re.Match[str]) -> str:
    """Name an object by the module that defines it.

    `basrelief.techniques.cone` would be taken for the module of that name.
    """
    package, name = match[1], match[2]
    value = getattr(importlib.import_module(package), name)
    module = getattr(value, "__module__", None)
    if module in sys.modules and vars(sys.modules[module]).get(name) is value:
        package = module
    return f"::: {package}.{name}"


def indent_lists(text: str) -> str:
    """Indent the paragraphs of list items by 4, as Python-Markdown requires, in place of 2."""
    lines, in_list = [], False
    for line in text.splitlines():
        in_list = line.startswith("- ") or (in_list and line[:1] in ("", " "))
        lines.append(f"  {line}" if in_list and line.startswith("  ") else line)
    return "\n".join(lines) + "\n"


def code_page(file: str) -> str:
    """A page that shows a file of code; the search omits it."""
    text = (REPOSITORY / file).read_text()
    name, language = PurePosixPath(file).name, LANGUAGES[PurePosixPath(file).suffix]
    head = f"---\nsearch:\n  exclude: true\nhide:\n  - toc\n---\n\n# {name}\n\n`{file}`\n\n"
    return f"{head}````{language}\n{text}````\n"


# --- the viewer -----------------------------------------------------------------------------------


@cache
def sample(name: str) -> basrelief.Material:
    """A small sample without a normal map: the page makes normals from heights itself."""
    return replace(basrelief.sample(name, 256), normal=None)


def scene_of(options: str) -> basrelief.Scene:
    """The scene that `render` draws, for the options that pages of techniques use."""
    parser = argparse.ArgumentParser()
    parser.add_argument("sample")
    parser.add_argument("--technique", default="relief")
    parser.add_argument("--scale", type=float)
    parser.add_argument("--set", action="append", default=[], type=lambda text: text.split("="))
    parser.add_argument("--camera", default="")
    parser.add_argument("-o")
    arguments = parser.parse_args(shlex.split(options))
    shown = basrelief.Object(
        sample(arguments.sample.removeprefix("sample:")),
        technique=arguments.technique,
        scale=arguments.scale,
        settings={name: json.loads(value) for name, value in arguments.set},
    )
    angles: dict[str, Any] = {
        name: float(value) for name, value in re.findall(r"(\w+)=([^,]+)", arguments.camera)
    }
    return basrelief.Scene((shown,), camera=basrelief.Orbit(**angles))


def fragment(options: str) -> str:
    """The fragment of the address by which the viewer's page shows what a command draws."""
    start, scene = scene_of(START), scene_of(options)
    changed = difference(state_of(scene, scene.objects[0]), state_of(start, start.objects[0]))
    return f"#{quote(json.dumps(changed))}" if changed else ""


def difference(state: Any, start: Any) -> Any:
    """The entries of nested dictionaries that differ from others; None where all are equal."""
    if not isinstance(state, dict) or not isinstance(start, dict):
        return None if state == start else state
    entries = {name: difference(value, start.get(name)) for name, value in state.items()}
    return {name: value for name, value in entries.items() if value is not None} or None


def write_view_page(file: Path) -> None:
    """Write the viewer's page without its still pictures, since the page around has one."""
    file.parent.mkdir(parents=True)
    write_view(scene_of(START), file, device="cpu")
    file.write_text(re.sub(r"<figure>.*?</figure>\n?", "", file.read_text(), flags=re.S))


if __name__ == "__main__":
    sys.exit(main())
