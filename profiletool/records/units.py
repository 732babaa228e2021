"""Units and array types: mm, N, MPa and radians inside; bar, degrees and inches at the surface."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

BAR_PER_MPA = 10.0
MM_PER_INCH = 25.4
# Lengths by the names that files give them, in small letters.
MM_PER = {
    **dict.fromkeys(("mm", "millimeter", "millimeters", "millimetre", "millimetres"), 1.0),
    **dict.fromkeys(("cm", "centimeter", "centimeters", "centimetre", "centimetres"), 10.0),
    **dict.fromkeys(("dm", "decimeter", "decimetre"), 100.0),
    **dict.fromkeys(("m", "meter", "meters", "metre", "metres"), 1000.0),
    **dict.fromkeys(("in", "inch", "inches", '"', "″"), MM_PER_INCH),
    **dict.fromkeys(("ft", "foot", "feet"), 12.0 * MM_PER_INCH),
    **dict.fromkeys(("mil", "mils", "thou"), MM_PER_INCH / 1000.0),
    **dict.fromkeys(("um", "µm", "μm", "micron", "microns", "micrometer", "micrometre"), 1e-3),
    **dict.fromkeys(("pt", "point", "points"), MM_PER_INCH / 72.0),
    "pc": MM_PER_INCH / 6.0,
}

FloatArray = NDArray[np.float64]
Float32 = NDArray[np.float32]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]
