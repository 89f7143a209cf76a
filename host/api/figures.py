"""Figures of one style, and self-contained pages of HTML.

>>> from springpot.figures import plain
>>> plain(0.012345)
'0.0123'
"""

from typing import TYPE_CHECKING

from springpot.lazy_names import lazy_names

if TYPE_CHECKING:
    from springpot.host.wings.pages.page import page_text as page_text, plain as plain
    from springpot.host.wings.pages.plot_style import (
        ERROR as ERROR,
        MEASURED as MEASURED,
        MUTED as MUTED,
        PREDICTED as PREDICTED,
        STYLE as STYLE,
        SVG_METADATA as SVG_METADATA,
        log_ticks as log_ticks,
        stride as stride,
        svg_text as svg_text,
    )
else:
    __getattr__, __dir__, __all__ = lazy_names(__name__, __file__)
