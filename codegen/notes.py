"""Bits of sp_notes.h: what a tick says about itself. A test compares them with the header."""

import numpy as np
from numpy.typing import NDArray

HELD, RESYNC, OUTSIDE, CLAMPED, RAMPED, LATCHED, LIMITED = 1, 2, 4, 8, 16, 32, 64

Notes = NDArray[np.int32]
