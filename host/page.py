"""Self-contained HTML pages out of host/templates, which share one base and its style."""

import re
from collections.abc import Callable, Mapping
from importlib.resources import files
from typing import Any

import jinja2
import numpy as np
from markupsafe import Markup, escape


def page_text(template: str, context: Mapping[str, Any], **filters: Callable[..., str]) -> str:
    """One page: a template with its context; filters: further ones of the page."""
    return _environment(filters).get_template(template).render(context)


def plain(value: float, digits: int = 3) -> str:
    """A number for people: significant digits, no exponent."""
    return np.format_float_positional(value, digits, fractional=False, trim="-")


def prose(text: str) -> Markup:
    """A message of the command line on a page: what it puts between backticks is code there."""
    return Markup(re.sub("`([^`]*)`", r"<code>\1</code>", str(escape(text))))


def _environment(filters: Mapping[str, Callable[..., str]]) -> jinja2.Environment:
    folder = files("springpot.host") / "templates"
    environment = jinja2.Environment(
        loader=jinja2.FunctionLoader(lambda name: (folder / name).read_text(encoding="utf-8")),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters |= {"si": plain, "prose": prose, "short": lambda text: text[:16], **filters}
    return environment
