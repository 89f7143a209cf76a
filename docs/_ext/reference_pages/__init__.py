"""Sphinx extension: pages of the reference are completed from the code while they are read.

What stands between `<!-- generated: NAME -->` and `<!-- end -->` in a page is for those who read
it in a clone (in_clone.py); the site has what the generator of that name makes in its place.
"""

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from reference_pages.c_header import c_functions, c_notes
from reference_pages.commands import command_pages
from reference_pages.docstrings import as_rst
from reference_pages.exit_statuses import exit_status_table
from reference_pages.in_clone import MARK
from reference_pages.mathml import visit_block, visit_inline
from reference_pages.opened_pages import open_pages
from reference_pages.python_names import python_name_list
from reference_pages.scene_keys import scene_key_tables
from reference_pages.signatures import as_written
from reference_pages.wire import wire_messages

if TYPE_CHECKING:
    from sphinx.application import Sphinx

GENERATORS: dict[str, Callable[[], str]] = {
    "commands": command_pages,
    "exit statuses": exit_status_table,
    "scene keys": scene_key_tables,
    "c functions": c_functions,
    "c notes": c_notes,
    "python names": python_name_list,
    "wire": wire_messages,
}


def completed(text: str) -> str:
    """A page with what its marks stand for. Raises KeyError for a mark without a generator."""
    return MARK.sub(lambda mark: GENERATORS[mark[1]](), text)


def setup(app: "Sphinx") -> dict[str, Any]:
    """Called by Sphinx."""

    def complete(_app: "Sphinx", _page: str, source: list[str]) -> None:
        source[0] = completed(source[0])

    app.connect("source-read", complete)
    app.connect("autodoc-process-docstring", as_rst)
    app.connect("autodoc-process-signature", as_written)
    app.connect("doctree-resolved", open_pages)
    app.add_html_math_renderer("mathml", (visit_inline, None), (visit_block, None))
    return {"parallel_read_safe": True}
