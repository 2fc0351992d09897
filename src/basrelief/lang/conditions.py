"""Conditions of the typed tree that are static, wholly or in part.

One that is static in part becomes a choice, by its static part, between two that are not static, so
that a program has nothing of the other. So do the `if` and the conditional expression on it.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

from basrelief.lang import tree

Leaves = bool | tree.Condition
"""Whether every path through statements leaves them, or under which static condition."""
_TRUE, _FALSE = tree.Literal(bool, True), tree.Literal(bool, False)
_T = TypeVar("_T")


def both(a: Leaves, b: Leaves) -> Leaves:
    """`a and b`."""
    if isinstance(a, bool):
        return a and b
    if isinstance(b, bool):
        return b and a
    return ("and", a, b)


def either(a: Leaves, b: Leaves) -> Leaves:
    """`a or b`."""
    if isinstance(a, bool):
        return a or b
    if isinstance(b, bool):
        return b or a
    return ("or", a, b)


def negated(a: tree.Expression) -> tree.Expression:
    """`not a`."""
    match a:
        case tree.Static(_, condition):
            return tree.Static(bool, ("not", condition))
        case tree.Select(_, tree.Static() as test, then, otherwise):
            return tree.Select(bool, test, negated(then), negated(otherwise))
        case tree.Literal(_, value):
            return tree.Literal(bool, not value)
    return tree.Unary(bool, "not", a)


def logic(word: str, a: tree.Expression, b: tree.Expression) -> tree.Expression:
    """`a and b` or `a or b`."""
    if isinstance(a, tree.Static) and isinstance(b, tree.Static):
        return tree.Static(bool, (word, a.condition, b.condition))
    for one, other in ((a, b), (b, a)):
        match one:
            case tree.Literal(_, value):
                return other if value == (word == "and") else one
            case tree.Static():
                one = tree.Select(bool, one, _TRUE, _FALSE)
        match one:
            case tree.Select(_, tree.Static() as test, then, otherwise):
                then, otherwise = logic(word, then, other), logic(word, otherwise, other)
                return tree.Select(bool, test, then, otherwise)
    return tree.Logic(bool, word, a, b)


def split(
    test: tree.Expression, yes: _T, no: _T, joined: Callable[[tree.Expression, _T, _T], _T]
) -> _T:
    """`yes` and `no` joined by a test; by its static part first, where it has one."""

    def side(test: tree.Expression) -> _T:
        if isinstance(test, tree.Literal):
            return yes if test.value else no
        return split(test, yes, no, joined)

    match test:
        case tree.Select(_, tree.Static() as static, then, otherwise):
            return joined(static, side(then), side(otherwise))
    return joined(test, yes, no)


def choice(test: tree.Expression, a: tree.Expression, b: tree.Expression) -> tree.Expression:
    """`a if test else b`."""
    return tree.Select(a.type, test, a, b)


def branch(test: tree.Expression, a: tree.Block, b: tree.Block) -> tree.Block:
    """`if test: a`, `else: b`."""
    return tree.Block([tree.If(test, a, b)])


def left(test: tree.Expression, a: Leaves, b: Leaves) -> Leaves:
    """Whether every path through an `if` leaves it, when its branches do so."""
    if a is True and b is True:
        return True
    if isinstance(test, tree.Static):
        return either(both(test.condition, a), both(("not", test.condition), b))
    return both(a, b)
