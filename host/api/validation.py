"""Errors of a force, and what they are held against.

>>> import numpy as np
>>> from springpot.validation import rms
>>> rms(np.array([3.0, 4.0]))
3.5355339059327378
"""

from typing import TYPE_CHECKING

from springpot.lazy_names import lazy_names

if TYPE_CHECKING:
    from springpot.host.metrics import (
        JND_WORDS as JND_WORDS,
    )
    from springpot.host.metrics import (
        SCORED_ABOVE_N as SCORED_ABOVE_N,
    )
    from springpot.host.metrics import (
        WEBER_FRACTION as WEBER_FRACTION,
    )
    from springpot.host.metrics import (
        accuracy as accuracy,
    )
    from springpot.host.metrics import (
        floor_keys as floor_keys,
    )
    from springpot.host.metrics import (
        floor_words as floor_words,
    )
    from springpot.host.metrics import (
        just_noticeable_percent as just_noticeable_percent,
    )
    from springpot.host.metrics import (
        rms as rms,
    )
    from springpot.host.metrics import start_up_ramp as start_up_ramp
    from springpot.host.stiffness import slope_errors as slope_errors
    from springpot.host.stiffness import slope_keys as slope_keys
    from springpot.host.stiffness import slope_words as slope_words
    from springpot.host.validation.by_place import PlaceError as PlaceError
    from springpot.host.validation.by_place import place_line as place_line
    from springpot.host.validation.seen import known_among as known_among
    from springpot.host.validation.seen import seen_line as seen_line
    from springpot.host.validation.store import Series as Series
    from springpot.host.validation.store import Stored as Stored
    from springpot.host.validation.store import read_validation as read_validation
    from springpot.host.validation.store import series_of as series_of
    from springpot.host.validation.store import store_validation as store_validation
    from springpot.host.validation.validation import bits_differ as bits_differ
    from springpot.host.validation.validation import fail_on_mismatch as fail_on_mismatch
    from springpot.trainer.models.folds import geometric_mean as geometric_mean
else:
    __getattr__, __dir__, __all__ = lazy_names(__name__, __file__)
