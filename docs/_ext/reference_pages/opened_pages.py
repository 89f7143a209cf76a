"""Links to the pages that people press: opened in the browser, where other files are downloaded."""

from typing import TYPE_CHECKING

from docutils import nodes
from sphinx import addnodes
from sphinx.util.osutil import relative_uri

if TYPE_CHECKING:
    from sphinx.application import Sphinx


def open_pages(app: "Sphinx", document: nodes.document, page: str) -> None:
    """Sphinx's doctree-resolved. The files lie at the root of the site: html_extra_path."""
    for link in list(document.findall(addnodes.download_reference)):
        name = link["reftarget"].rpartition("/")[2]
        if name in app.config.html_extra_path:
            uri = relative_uri(app.builder.get_target_uri(page), name)
            link.replace_self(nodes.reference("", "", *link.children, refuri=uri, internal=True))
