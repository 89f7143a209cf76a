"""The place on the surface that a recording pressed: one each, since a model is of presses."""

import numpy as np

from springpot.codegen.arrays import Samples
from springpot.codegen.errors import DataError

SAME_PLACE_M = 1e-4  # what no printed grid and no stage tells apart


def require_one_place(name: str, path_m: Samples) -> tuple[float, float]:
    """Return x and y of the place where the tool stays, m; a stage that trembles stays.

    path_m: x and y of each sample, (n, 2). Raises DataError if the tool moves along the surface.
    """
    spans_m = np.ptp(path_m, axis=0)
    if spans_m.max() > SAME_PLACE_M:
        ways = ", ".join(
            f"{axis} {1e3 * along.min():.4g} to {1e3 * along.max():.4g} mm"
            for axis, along in zip("xy", path_m.T, strict=True)
        )
        raise DataError(
            f"{name}: the tool moves along the surface ({ways}), and a model is of presses of one "
            "place each: cut it into one file a place"
        )
    x_m, y_m = np.median(path_m, axis=0).tolist()
    return x_m, y_m
