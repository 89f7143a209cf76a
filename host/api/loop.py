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
    )
    from springpot.host.native.loop_library import (
        IDLE as IDLE,
    )
    from springpot.host.native.loop_library import (
        NONE as NONE,
    )
    from springpot.host.native.loop_library import (
        RESET as RESET,
    )
    from springpot.host.native.loop_library import (
        LoopRows as LoopRows,
    )
    from springpot.host.native.loop_library import (
        empty_rows as empty_rows,
    )
    from springpot.host.native.loop_library import (
        loop_library as loop_library,
    )
    from springpot.host.session.c_loop import StepFunctions as StepFunctions
    from springpot.host.session.log import SessionLog as SessionLog
    from springpot.host.session.loop import LoopSettings as LoopSettings
    from springpot.host.session.note_words import NOTE_WORDS as NOTE_WORDS
    from springpot.host.session.note_words import notes_in_words as notes_in_words
    from springpot.host.session.runner import (
        Progress as Progress,
    )
    from springpot.host.session.runner import (
        RowTaker as RowTaker,
    )
    from springpot.host.session.runner import (
        SessionRunner as SessionRunner,
    )
else:
    __getattr__, __dir__, __all__ = lazy_names(__name__, __file__)
