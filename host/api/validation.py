"""Errors of a force, and what they are held against.

>>> import numpy as np
>>> from springpot.validation import rms
>>> rms(np.array([3.0, 4.0]))
3.5355339059327378
"""

from typing import TYPE_CHECKING

from springpot.lazy_names import lazy_names

if TYPE_CHECKING:
    from springpot.codegen.arrays import rms as rms
    from springpot.host.metrics import (
        JND_WORDS as JND_WORDS,
        SCORED_ABOVE_N as SCORED_ABOVE_N,
        WEBER_FRACTION as WEBER_FRACTION,
        accuracy as accuracy,
        floor_keys as floor_keys,
        floor_words as floor_words,
        just_noticeable_percent as just_noticeable_percent,
    )
    from springpot.host.stiffness import (
        slope_errors as slope_errors,
        slope_keys as slope_keys,
        slope_words as slope_words,
    )
    from springpot.host.validation.compared import bits_differ as bits_differ
    from springpot.host.validation.drawing import (
        draw_forces as draw_forces,
        median_error as median_error,
    )
    from springpot.host.validation.seen import known_among as known_among, seen_line as seen_line
    from springpot.host.validation.store import (
        Series as Series,
        Stored as Stored,
        read_validation as read_validation,
        store_validation as store_validation,
    )
    from springpot.host.validation.validation import fail_on_mismatch as fail_on_mismatch
else:
    __getattr__, __dir__, __all__ = lazy_names(__name__, __file__)
