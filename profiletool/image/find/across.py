"""Colours across an outline, and the outline moved to where its edge is."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from profiletool.image.find.contour import resampled
from profiletool.image.find.ground import BoolImage, FloatImage
from profiletool.records.units import FloatArray

_LAP = 60
_BEND = 0.15  # what a step to the next column must gain
_CALM = 9  # points over which an outline's direction is taken


@dataclass(frozen=True)
class Rim:
    """An outline and the colours on lines across it.

    Attributes
    ----------
    points : (N, 2)
        About a pixel apart, x and y.
    normals : (N, 2)
        Unit vectors out of the object.
    colours : (N, 2 R + 1, C)
        From R pixels inside to R pixels outside, a pixel apart.
    on_frame : (N,) bool
        Where the outline runs along the frame, so that it is nobody's edge.
    """

    points: FloatArray
    normals: FloatArray
    colours: FloatImage
    on_frame: NDArray[np.bool_]


def rim_of(image: FloatImage, mask: BoolImage, reach: int) -> Rim:
    """Sample an (H, W, C) image across the outline of a mask's one region."""
    found, _ = cv2.findContours(
        np.ascontiguousarray(mask).view(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE
    )
    line = max(found, key=len)[:, 0].astype(np.float64)
    if len(line) < 8:
        line = np.repeat(line, 8, axis=0) + np.linspace(0.0, 1e-3, 8 * len(line))[:, None]
    points = _rounded_off(resampled(line, 1.0))
    along = np.roll(points, -2, axis=0) - np.roll(points, 2, axis=0)
    normals = np.stack([-along[:, 1], along[:, 0]], axis=1)
    normals /= np.maximum(np.hypot(*normals.T), 1e-9)[:, None]
    # findContours goes down the left side: the object lies to the left of the way.
    offsets = np.arange(-reach, reach + 1.0)
    places = points[:, None] + offsets[:, None] * normals[:, None]
    x, y = np.moveaxis(places.astype(np.float32), 2, 0)
    colours = _looked_up(image, x, y)
    height, width = mask.shape
    room = np.minimum(points, [width - 1, height - 1] - points).min(axis=1)
    return Rim(points, normals, colours, np.asarray(room < 2.0))


def _looked_up(image: FloatImage, x: FloatImage, y: FloatImage) -> FloatImage:
    """Bilinear values at (N, M) places; remap takes 32767 rows at most."""
    parts = [
        cv2.remap(image, x[k : k + 8192], y[k : k + 8192], cv2.INTER_LINEAR,
                  borderMode=cv2.BORDER_REPLICATE)
        for k in range(0, len(x), 8192)
    ]  # fmt: skip
    # remap drops a lone channel's axis.
    return np.asarray(np.concatenate(parts).reshape(*x.shape, -1), np.float32)


def _rounded_off(points: FloatArray) -> FloatArray:
    """Average along a closed line, so that pixel steps do not turn its direction."""
    weights = np.hanning(_CALM + 2)[1:-1] / np.hanning(_CALM + 2).sum()
    half = _CALM // 2
    around = np.pad(points, ((half, half), (0, 0)), mode="wrap")
    return np.stack([np.convolve(line, weights, mode="valid") for line in around.T], axis=1)


def steps(colours: FloatImage) -> FloatImage:
    """Differences of colour across every place of a rim: the two pixels out less the two in.

    Returns
    -------
    (N, 2 R - 3, C) float32
        The middle one is that at the outline.
    """
    inner = colours[:, :-4] + colours[:, 1:-3]
    outer = colours[:, 3:-1] + colours[:, 4:]
    return np.asarray((outer - inner) / 2.0, np.float32)
