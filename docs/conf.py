"""How `make docs` builds the site: Sphinx over the Markdown of this folder, warnings as errors."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent / "_ext"))

project = "springpot"
smartquotes = False  # text is copied into shells
extensions = ["myst_parser", "sphinx.ext.autodoc", "reference_pages"]
myst_heading_anchors = 4
myst_enable_extensions = ["attrs_inline", "colon_fence", "dollarmath"]

autodoc_typehints = "none"  # signatures are those of the source: reference_pages/signatures.py
nitpick_ignore_regex = [
    ("py:class", r"(?!springpot\.).*"),  # types of numpy and of Python itself
    ("c:identifier", "uint32_t"),
]

html_theme = "furo"
html_math_renderer = "mathml"
html_title = "springpot"
html_copy_source = False
html_show_copyright = False
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_show_sphinx = False
highlight_language = "bash"  # blocks without a language are commands
