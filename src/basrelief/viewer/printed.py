"""The programs as a page holds them: each shader once, and what a choice binds its slots to.

The rules by which choices bind slots (`basrelief.shading.choices`) are Python. Each is turned
into a decision tree by asking it with every answer to whatever it asks, so that a page follows the
very same rules.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, get_args

from basrelief.lang import Shader
from basrelief.lang.library import EDGE, Library, library_of
from basrelief.lang.resources import Edge, buffer_record
from basrelief.rendering.programs import MAPPED
from basrelief.scene import SHAPES, SURFACES
from basrelief.shading import pixel
from basrelief.shading.choices import RULES, Choices, bindings_of
from basrelief.shading.kinds import (
    AlphaKind,
    EdgeKind,
    FogKind,
    HeightsKind,
    MappingKind,
    OcclusionKind,
    Projection,
    ShadingModel,
    ShadowsKind,
    SurfaceKind,
    values_of,
)
from basrelief.shading.missed_hit import missed_hit
from basrelief.shading.surfaces.surface import SurfaceSettings
from basrelief.techniques import TECHNIQUES, Technique, cone_bake
from basrelief.techniques.technique import Settings
from basrelief.viewer.bakes import PROGRAMS, is_asked

MENUS: dict[str, tuple[str, ...]] = {
    "shape": SHAPES,
    "projection": values_of(Projection),
    "heights": values_of(HeightsKind),
    "edge": values_of(EdgeKind),
    "mapping": values_of(MappingKind),
    "alpha": values_of(AlphaKind),
    "surface": values_of(SurfaceKind),
    "shadows": values_of(ShadowsKind),
    "shading_model": values_of(ShadingModel),
    "occlusion_kind": values_of(OcclusionKind),
    "fog": values_of(FogKind),
}
"""What a page chooses by name, as `Object` and `Scene` have it."""
_EITHER = (True, False)
CHOICES: dict[str, tuple[Any, ...]] = {
    **MENUS,
    "displaced": _EITHER,
    "boxed": _EITHER,
    # a relief that is clipped wraps or clamps within
    "edge": get_args(Edge),
    "clipped": _EITHER,
    "fades": _EITHER,
    "apart": _EITHER,
    "layer": _EITHER,
    **dict.fromkeys(MAPPED, _EITHER),
    # one object casts no shadow on others
    "shadows_on": ("relief",),
    "casts": (False,),
}
"""What the programs of a page differ in, beside the technique: the fields of `Choices`."""
ENTRIES: tuple[Shader[..., Any], ...] = (pixel.pixel, missed_hit, *PROGRAMS)
Techniques = Mapping[str, Technique[..., Any]]


@dataclass(frozen=True)
class Printed:
    """The library of all programs, and by slot the tree that says what it is bound to."""

    library: Library
    trees: dict[str, Any]

    def told(self) -> dict[str, Any]:
        """Both as JSON has them."""
        made = self.library
        return {
            "pieces": made.pieces,
            "slots": made.slots,
            "entries": made.entries,
            "conditions": made.conditions,
            "bindings": {
                name: [
                    {
                        "kind": each.kind,
                        "name": each.name,
                        "type": _type_name(each.type, made.names),
                    }
                    for each in found
                ]
                for name, found in made.bindings.items()
            },
            "trees": self.trees,
            "edge": EDGE,
        }

    def bound(self, choices: Choices) -> dict[str, str]:
        """What the slots of a program are bound to, by name, as a page's trees have it."""
        names = self.library.names
        return {
            **{names[slot]: names[made] for slot, made in bindings_of(choices).items()},
            EDGE: choices.edge,
            names[Settings]: names[choices.technique.settings],
            names[SurfaceSettings]: names[SURFACES[choices.surface]],
        }


def printed(techniques: Techniques = TECHNIQUES) -> Printed:
    """Every program that a page can choose, with these techniques by name.

    Raises ShaderError for a technique that is outside the subset.
    """
    asked = answers(techniques)
    trees = {slot: tree_of(rule, asked) for slot, rule in RULES.items()}
    # what a bake's steps choose
    trees[cone_bake.is_asked] = tree_of(is_asked, {"in_sector": {"false": False, "true": True}})
    options = {slot: list(_leaves(tree)) for slot, tree in trees.items()}
    library = library_of(ENTRIES, options)
    names = library.names
    named = {names[slot]: _named(tree, names) for slot, tree in trees.items()}
    named |= {
        EDGE: tree_of(lambda c: c.edge, asked),
        names[Settings]: tree_of(lambda c: names[c.technique.settings], asked),
        names[SurfaceSettings]: tree_of(lambda c: names[SURFACES[c.surface]], asked),
    }
    return Printed(library, {name: _plain(tree) for name, tree in named.items()})


def answers(techniques: Techniques) -> dict[str, Mapping[str, Any]]:
    """What may be chosen: the answers to each question, by the text that a page has for them."""
    listed = {
        name: {str(value).lower(): value for value in values} for name, values in CHOICES.items()
    }
    return {"technique": techniques, **listed}


# --- rules as trees ------------------------------------------------------------------------------


@dataclass(frozen=True)
class Ask:
    """A question, and what follows from each answer."""

    name: str
    then: dict[str, Any]


class _UnansweredError(Exception):
    """A rule asked for something that has no answer yet."""


class _Answers:
    """Choices as far as they are known."""

    def __init__(self, known: Mapping[str, Any], asked: Mapping[str, Any]) -> None:
        self._known, self._asked = known, asked

    def __getattr__(self, name: str) -> Any:
        if name in self._known:
            return self._known[name]
        if name in self._asked:
            raise _UnansweredError(name)
        return getattr(Choices, name).fget(self)


def tree_of(
    rule: Callable[[Any], Any],
    asked: Mapping[str, Mapping[str, Any]],
    known: Mapping[str, Any] | None = None,
) -> Any:
    """A rule as a tree: its result, or an `Ask` where that depends on an answer.

    `asked` are the answers that each question may have, by the text that stands for them.
    """
    known = known or {}
    try:
        return rule(_Answers(known, asked))
    except _UnansweredError as question:
        name = str(question)
    then = {
        text: tree_of(rule, asked, {**known, name: value}) for text, value in asked[name].items()
    }
    first = next(iter(then.values()))
    return first if all(each == first for each in then.values()) else Ask(name, then)


def _leaves(tree: Any) -> dict[Any, None]:
    if not isinstance(tree, Ask):
        return {tree: None}
    return {leaf: None for each in tree.then.values() for leaf in _leaves(each)}


def _named(tree: Any, names: Mapping[Any, str]) -> Any:
    if isinstance(tree, Ask):
        return Ask(tree.name, {text: _named(each, names) for text, each in tree.then.items()})
    return names[tree]


def _plain(tree: Any) -> Any:
    if isinstance(tree, Ask):
        return [tree.name, {text: _plain(each) for text, each in tree.then.items()}]
    return tree


def _type_name(t: Any, names: Mapping[Any, str]) -> str:
    named = buffer_record(t) or t
    return names.get(named) or str(getattr(named, "__name__", ""))
