"""Self-contained HTML pages, which share one base and its style."""

import re
from collections.abc import Callable, Mapping
from importlib.resources import files

import jinja2
import numpy as np
from markupsafe import Markup, escape

from springpot.codegen.types import JsonMapping

_SHARED = "springpot.host.pages"  # base.html, and parts of several pages


def page_text(
    template: str,
    context: JsonMapping,
    package: str = _SHARED,
    **filters: Callable[..., str],
) -> str:
    """Return the text of one page.

    template: a file in the folder `templates` of `package`, which may extend and include those of
    springpot.host.pages. filters: further ones that the template uses.
    """
    return _environment(package, filters).get_template(template).render(context)


def plain(value: float, digits: int = 3) -> str:
    """A number for people: significant digits, no exponent."""
    return np.format_float_positional(value, digits, fractional=False, trim="-")


def prose(text: str) -> Markup:
    """A message of the command line on a page: what it puts between backticks is code there."""
    return Markup(re.sub("`([^`]*)`", r"<code>\1</code>", str(escape(text))))


def _environment(package: str, filters: Mapping[str, Callable[..., str]]) -> jinja2.Environment:
    folders = [files(name) / "templates" for name in dict.fromkeys((package, _SHARED))]

    def text(name: str) -> str | None:
        found = (folder / name for folder in folders)
        return next((file.read_text(encoding="utf-8") for file in found if file.is_file()), None)

    environment = jinja2.Environment(
        loader=jinja2.FunctionLoader(text),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters |= {"si": plain, "prose": prose, "short": lambda text: text[:16], **filters}
    return environment
