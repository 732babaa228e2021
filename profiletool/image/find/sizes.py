"""Boxes, points and masks from one size of a picture to another."""

from __future__ import annotations

import math

import cv2
import numpy as np
from numpy.typing import NDArray

from profiletool.image.find.ground import BoolImage
from profiletool.records.request import Box, Point


def window_round(box: Box, shape: tuple[int, ...], margin: float) -> tuple[slice, slice]:
    """Rows and columns of a box and of a margin round it, a share of its size."""
    x, y, w, h = box
    left, top = max(0, math.floor(x - margin * w)), max(0, math.floor(y - margin * h))
    right, bottom = math.ceil(x + (1 + margin) * w), math.ceil(y + (1 + margin) * h)
    return slice(top, min(bottom, shape[0])), slice(left, min(right, shape[1]))


def pasted(mask: BoolImage, window: tuple[slice, slice], shape: tuple[int, ...]) -> BoolImage:
    """Lay a mask of a window into one of the whole picture."""
    whole = np.zeros(shape, bool)
    whole[window] = mask
    return whole


def outside_of(box: Box, shape: tuple[int, ...], step: float) -> BoolImage:
    """Pixels of a picture reduced by a factor that lie outside a box of the full one."""
    outside = np.ones(shape, bool)
    x, y, w, h = (value / step for value in box)
    outside[round(y) : round(y + h), round(x) : round(x + w)] = False
    return outside


def scaled(point: Point, step: float) -> Point:
    """Give a point of a picture as one of the picture reduced by a factor."""
    return (point[0] + 0.5) / step - 0.5, (point[1] + 0.5) / step - 0.5


def reduced(image: NDArray[np.uint8], step: float) -> NDArray[np.uint8]:
    """Reduce by a factor, averaging; a factor of 1 returns the picture itself."""
    if step <= 1:
        return image
    height, width = image.shape[:2]
    size = max(1, round(width / step)), max(1, round(height / step))
    return np.asarray(cv2.resize(image, size, interpolation=cv2.INTER_AREA), np.uint8)


def resized(mask: BoolImage, shape: tuple[int, ...]) -> BoolImage:
    """Bring a mask to another size."""
    if mask.shape == tuple(shape[:2]):
        return mask
    return np.asarray(cv2.resize(mask.view(np.uint8) * 255, (shape[1], shape[0])) > 127)
