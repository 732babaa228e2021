"""Sets of colours: how alike two are, and which of them a pixel belongs to."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from profiletool.image.find.ground import BoolImage, FloatImage

_BINS = 16
_LOW = np.array([0.0, -80.0, -80.0], np.float32)
_WIDTH = np.array([100.0, 160.0, 160.0], np.float32) / _BINS


def cells(lab: FloatImage) -> NDArray[np.int32]:
    """Find the number of the cell of a (..., 3) Lab colour in a cube of 16 x 16 x 16."""
    number = np.zeros(lab.shape[:-1], np.int32)
    for plane, low, width in zip(np.moveaxis(lab, -1, 0), _LOW, _WIDTH, strict=True):
        number = number * _BINS + np.clip((plane - low) / width, 0, _BINS - 1).astype(np.int32)
    return number


def histogram(cell: NDArray[np.int32], mask: BoolImage) -> FloatImage:
    """Share of every cell among the masked pixels, (4096,), spread over its neighbours."""
    counts = np.bincount(cell[mask], minlength=_BINS**3).astype(np.float32)
    cube = counts.reshape(_BINS, _BINS, _BINS)
    for axis in range(3):
        padded = np.pad(cube, [(1, 1) if k == axis else (0, 0) for k in range(3)], mode="edge")
        left, middle, right = (np.take(padded, np.arange(_BINS) + k, axis=axis) for k in range(3))
        cube = 0.25 * left + 0.5 * middle + 0.25 * right
    return np.asarray(cube.ravel() / max(float(cube.sum()), 1.0), np.float32)


def likeness(one: FloatImage, other: FloatImage) -> float:
    """Bhattacharyya coefficient of two histograms: 0 nothing in common, 1 the same."""
    return float(np.sqrt(one * other).sum())
