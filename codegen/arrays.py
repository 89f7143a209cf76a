"""Names for arrays that every floor uses."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

Samples = NDArray[np.float64]
Indices = NDArray[np.intp]  # indices of samples
Real = np.float32 | np.float64
Reals = NDArray[Any]  # of a scene's number type
