"""Pictures and lines that are given as arrays, in place of a file."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from profiletool.errors import UsageError
from profiletool.profile.drawing.load import drawing_of
from profiletool.records.picture import Picture
from profiletool.records.profile import DrawnLine


def given_of(array: NDArray[Any]) -> Picture | DrawnLine:
    """Take an array for a picture or for the points of a line.

    Parameters
    ----------
    array : (H, W, 3), (H, W, 4) or (H, W) uint8, or (N, 2) mm

    Raises
    ------
    UsageError
        It is neither.
    """
    if array.ndim == 2 and array.shape[1] == 2:
        return drawing_of(array)
    if array.dtype == np.uint8 and array.ndim == 2:
        return Picture(np.repeat(array[:, :, None], 3, axis=2), None, None, "array")
    if array.dtype == np.uint8 and array.ndim == 3 and array.shape[2] in (3, 4):
        alpha = array[:, :, 3].copy() if array.shape[2] == 4 else None
        opaque = alpha is None or bool((alpha == 255).all())
        return Picture(array[:, :, :3].copy(), None if opaque else alpha, None, "array")
    raise UsageError(
        "an array is a picture, (H, W, 3), (H, W, 4) or (H, W) uint8, or points, (N, 2) in mm; "
        f"not {array.shape} {array.dtype}"
    )
