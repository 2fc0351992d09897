"""What a page of the gallery is: pictures side by side, and what to look at."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass

from basrelief.material import Material
from basrelief.material import sample as drawn_sample
from basrelief.scene import Scene

SOURCES = {
    "catlike": "Catlike Coding, Rendering 20: Parallax",
    "wikibooks": "Cg Programming in Unity (Wikibooks): Projection of Bumpy Surfaces",
    "gamedev": "GameDev.net: A Closer Look at Parallax Occlusion Mapping",
    "halliwell": "S. Halliwell: Parallax Offset",
    "habrador": "Habrador, Advanced shaders in Unity: 3. Parallax mapping",
    "beyond": "What the five articles do not have, after the literature",
}
"""The articles by the short names that pages use, in the order of the index; then what goes beyond
them."""


def heading(source: str) -> str:
    """What stands above the pages of a source."""
    return "Beyond the articles" if source == "beyond" else f"After {source}"


@dataclass(frozen=True, eq=False)
class Panel:
    """One picture of a page: a short caption, what is drawn, and what else its settings say.

    Most settings are told by the scene itself; `settings` is for those that it does not show.
    `shown` is its "color", or a debug picture by name, as of `basrelief render --show`.
    """

    caption: str
    scene: Scene
    settings: str = ""
    shown: str = "color"


@dataclass(frozen=True)
class Headline:
    """A figure that an article gives, and the picture size at which its page is timed beside it."""

    size: tuple[int, int]
    figure: str


@dataclass(frozen=True, eq=False)
class Page:
    """One comparison of an article.

    `rows` are the rows of docs/contributing/features.md that the page shows, each with how; the
    first says where the page stands among its source's. `look` is one sentence on what to look at.
    `article` is what the article says is to be seen, `ours` what these pictures show, and why they
    differ where they do. `panels` makes the pictures, with samples of so many texels a side.
    """

    name: str
    title: str
    source: str
    rows: Mapping[str, str]
    look: str
    article: str
    ours: str
    panels: Callable[[int], Iterable[Panel]]
    headline: Headline | None = None


@functools.cache
def sample(name: str, texels: int) -> Material:
    """`basrelief.sample`, drawn once for all the pages that show it."""
    return drawn_sample(name, texels)
