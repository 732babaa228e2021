"""Array types."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

DType = np.dtype[Any]
DOUBLE: DType = np.dtype(np.float64)
SINGLE: DType = np.dtype(np.float32)  # of tangents; nothing else is ever in it
