"""Figures of one style, and pages of HTML: self-contained files, and a local server.

>>> from springpot.figures import plain
>>> plain(0.012345)
'0.0123'
"""

from typing import TYPE_CHECKING

from springpot.lazy_names import lazy_names

if TYPE_CHECKING:
    from springpot.host.pages.page import page_text as page_text
    from springpot.host.pages.page import plain as plain
    from springpot.host.pages.server import (
        Answer as Answer,
    )
    from springpot.host.pages.server import (
        PageEvent as PageEvent,
    )
    from springpot.host.pages.server import (
        PageServer as PageServer,
    )
    from springpot.host.pages.server import (
        PageWatcher as PageWatcher,
    )
    from springpot.host.plot_style import (
        ERROR as ERROR,
    )
    from springpot.host.plot_style import (
        MEASURED as MEASURED,
    )
    from springpot.host.plot_style import (
        MUTED as MUTED,
    )
    from springpot.host.plot_style import (
        PREDICTED as PREDICTED,
    )
    from springpot.host.plot_style import (
        STYLE as STYLE,
    )
    from springpot.host.plot_style import (
        SVG_METADATA as SVG_METADATA,
    )
    from springpot.host.plot_style import (
        stride as stride,
    )
    from springpot.host.plot_style import (
        svg_text as svg_text,
    )
else:
    __getattr__, __dir__, __all__ = lazy_names(__name__, __file__)
