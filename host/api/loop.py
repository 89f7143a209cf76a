"""The real-time loop: its rows, its settings, who starts and watches it, its log.

>>> from springpot.loop import COLUMN, empty_rows
>>> rows = empty_rows()
>>> rows.shape, COLUMN["time_s"]
((0, 12), 0)
"""

from typing import TYPE_CHECKING

from springpot.lazy_names import lazy_names

if TYPE_CHECKING:
    from springpot.host.devices.device import requirements_of as requirements_of
    from springpot.host.native.loop_library import (
        COLUMN as COLUMN,
        IDLE as IDLE,
        NONE as NONE,
        LoopRows as LoopRows,
        Stop as Stop,
        empty_rows as empty_rows,
        loop_library as loop_library,
    )
    from springpot.host.session.c_loop import StepFunctions as StepFunctions
    from springpot.host.session.loop import (
        LoopSettings as LoopSettings,
        LoopState as LoopState,
    )
    from springpot.host.session.outcome import (
        NOTE_WORDS as NOTE_WORDS,
        notes_in_words as notes_in_words,
    )
    from springpot.host.session.runner import (
        Progress as Progress,
        SessionRunner as SessionRunner,
    )
else:
    __getattr__, __dir__, __all__ = lazy_names(__name__, __file__)
