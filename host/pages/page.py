"""Self-contained HTML pages, which share one base and its style."""

import re
from collections.abc import Callable

import jinja2
import numpy as np
from markupsafe import Markup, escape

from springpot.codegen.types import JsonMapping


def page_text(template: str, context: JsonMapping, **filters: Callable[..., str]) -> str:
    """Return the text of one page: of a file in `templates`, with further filters that it uses."""
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("springpot.host.pages"),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters |= {"si": plain, "prose": prose, "short": lambda text: text[:16], **filters}
    return environment.get_template(template).render(context)


def plain(value: float, digits: int = 3) -> str:
    """Return a number for people: significant digits, no exponent."""
    return np.format_float_positional(value, digits, fractional=False, trim="-")


def prose(text: str) -> Markup:
    """A message of the command line on a page: what it puts between backticks is code there."""
    return Markup(re.sub("`([^`]*)`", r"<code>\1</code>", str(escape(text))))
