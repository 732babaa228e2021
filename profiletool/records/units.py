"""Units and array types: mm, N, MPa and radians inside; bar, degrees and inches at the surface."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

BAR_PER_MPA = 10.0
MM_PER_INCH = 25.4

FloatArray = NDArray[np.float64]
Float32 = NDArray[np.float32]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]
