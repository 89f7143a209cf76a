"""Which rows a fit uses: the paper's random fifth where there are many."""

import numpy as np
from numpy.typing import NDArray

PAPER_FRACTION = 0.2  # section IV-B
ALL_BELOW = 20_000
MAX_ROWS = 50_000


def choose_rows(
    rows_total: int, fraction: float | None, rng: np.random.Generator
) -> NDArray[np.intp]:
    """Rows to fit on, (rows,), ascending, without repetition.

    fraction None: the paper's 0.2 from 20 000 rows on, all of them below; never more than 50 000.
    """
    if fraction is None:
        fraction = PAPER_FRACTION if rows_total >= ALL_BELOW else 1.0
    wanted = min(max(1, round(fraction * rows_total)), MAX_ROWS)
    return np.sort(rng.choice(rows_total, size=wanted, replace=False))
