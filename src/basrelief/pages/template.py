"""Jinja templates of the package, in one environment that escapes every value.

Templates and style sheets are named by their paths within `basrelief`. Pages extend
`pages/templates/base.html.jinja`, whose content policy allows no scripts and no network.
"""

from __future__ import annotations

import functools
from importlib.resources import files
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from jinja2 import Environment
    from markupsafe import Markup


def fill(template: str, **values: Any) -> str:
    """Render a template with escaped values.

    Raises jinja2.UndefinedError for a missing value that the template uses.
    """
    return _environment().get_template(template).render(values)


@functools.cache
def _environment() -> Environment:
    from jinja2 import Environment, FunctionLoader, StrictUndefined

    environment = Environment(
        loader=FunctionLoader(_text),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    environment.globals["style"] = _style
    return environment


def _style(path: str) -> Markup:
    """A style sheet, unescaped: the content of `<style>` is not HTML."""
    from markupsafe import Markup

    return Markup(_text(path))


def _text(path: str) -> str:
    return (files("basrelief") / path).read_text("utf-8")
