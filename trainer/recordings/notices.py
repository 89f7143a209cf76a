"""Lines beside a result: how it was understood; what was recovered, left out, assumed.

The command line prints them on standard error; in Python they are records of the logger NOTICES,
which shows cautions by default, and all after `logging.basicConfig(level=logging.INFO)`.
"""

import logging

NOTICES = "springpot.notices"


def notice(line: str) -> None:
    """Log one line that asks nothing of anybody."""
    logging.getLogger(NOTICES).info(line)


def caution(line: str) -> None:
    """Log one line that somebody should read."""
    logging.getLogger(NOTICES).warning(line)
