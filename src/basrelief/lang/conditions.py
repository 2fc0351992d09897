"""Boolean expressions of the typed tree, with their static parts moved outwards.

A condition that is static in part becomes a selection, by the static part, between two conditions
that are not static. A program then contains only one of them. An `if` and a conditional expression
on such a condition are split in the same way.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from basrelief.lang import tree

Terminates = bool | tree.Condition
"""Whether every path through a block leaves it, or the static condition under which it does."""
_TRUE, _FALSE = tree.Literal(bool, True), tree.Literal(bool, False)
_T = TypeVar("_T")


def decided(condition: tree.Condition, value_of: Callable[[str], Any]) -> bool | tree.Condition:
    """The value of a static condition, or what is left of it to decide; `value_of` gives the value
    of a static field by its name, None for one that remains undecided."""
    match condition:
        case ("not", a):
            rest = decided(a, value_of)
            return not rest if isinstance(rest, bool) else ("not", rest)
        case ("and", a, b):
            return conjunction(decided(a, value_of), decided(b, value_of))
        case ("or", a, b):
            return disjunction(decided(a, value_of), decided(b, value_of))
    name, values = condition
    value = value_of(name)
    return condition if value is None else value in values


def conjunction(a: Terminates, b: Terminates) -> Terminates:
    """`a and b`."""
    if isinstance(a, bool):
        return a and b
    if isinstance(b, bool):
        return b and a
    return ("and", a, b)


def disjunction(a: Terminates, b: Terminates) -> Terminates:
    """`a or b`."""
    if isinstance(a, bool):
        return a or b
    if isinstance(b, bool):
        return b or a
    return ("or", a, b)


def negation(a: tree.Expression) -> tree.Expression:
    """`not a`."""
    match a:
        case tree.Static(_, condition):
            return tree.Static(bool, ("not", condition))
        case tree.Select(_, tree.Static() as test, then, otherwise):
            return tree.Select(bool, test, negation(then), negation(otherwise))
        case tree.Literal(_, value):
            return tree.Literal(bool, not value)
    return tree.Unary(bool, "not", a)


def logic(word: str, a: tree.Expression, b: tree.Expression) -> tree.Expression:
    """`a and b` or `a or b`."""
    if isinstance(a, tree.Static) and isinstance(b, tree.Static):
        return tree.Static(bool, (word, a.condition, b.condition))
    for known, other in ((a, b), (b, a)):
        match known:
            case tree.Literal(_, value):
                return other if value == (word == "and") else known
            case tree.Static():
                known = tree.Select(bool, known, _TRUE, _FALSE)
        match known:
            case tree.Select(_, tree.Static() as test, then, otherwise):
                then, otherwise = logic(word, then, other), logic(word, otherwise, other)
                return tree.Select(bool, test, then, otherwise)
    return tree.Logic(bool, word, a, b)


def hoist_static(
    test: tree.Expression, a: _T, b: _T, join: Callable[[tree.Expression, _T, _T], _T]
) -> _T:
    """`join(test, a, b)`, with the static part of the test, if it has one, outermost."""

    def joined(test: tree.Expression) -> _T:
        if isinstance(test, tree.Literal):
            return a if test.value else b
        return hoist_static(test, a, b, join)

    match test:
        case tree.Select(_, tree.Static() as static, then, otherwise):
            return join(static, joined(then), joined(otherwise))
    return join(test, a, b)


def select(test: tree.Expression, a: tree.Expression, b: tree.Expression) -> tree.Expression:
    """`a if test else b`."""
    return tree.Select(a.type, test, a, b)


def branch(test: tree.Expression, a: tree.Block, b: tree.Block) -> tree.Block:
    """`if test: a`, `else: b`."""
    return tree.Block([tree.If(test, a, b)])


def if_terminates(test: tree.Expression, a: Terminates, b: Terminates) -> Terminates:
    """Whether every path through an `if` leaves it, given the same of its branches."""
    if a is True and b is True:
        return True
    if isinstance(test, tree.Static):
        return disjunction(conjunction(test.condition, a), conjunction(("not", test.condition), b))
    return conjunction(a, b)
