"""From a rough region to a soft field whose half level is the edge, at full resolution."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from profiletool.image.find.ground import BoolImage, FloatImage

# Reach of the local colours in pixels: an object changes its colour sooner than the ground does.
_REACH_INSIDE, _REACH_OUTSIDE = 0.7, 2.5
_LEAST_CONTRAST = 12.0  # 8 bit levels: below, the edge is taken from the rough region


def edge_field(rgb: NDArray[np.uint8], region: BoolImage, small: NDArray[np.uint8]) -> FloatImage:
    """Share of object in every pixel near a region's edge; 0 outside, 1 inside.

    Parameters
    ----------
    rgb : (H, W, 3) uint8
        The picture.
    region : (h, w) bool
        The object in the reduced picture, off by two pixels at most.
    small : (h, w, 3) uint8
        The reduced picture.

    Returns
    -------
    (H, W) float32
    """
    for band in (2, 1):  # each time with colours from the edge just found
        region = _matte(small, small, region, band) > 0.5
    return _matte(rgb, small, region, 1)


def _matte(
    fine: NDArray[np.uint8], small: NDArray[np.uint8], region: BoolImage, band: int
) -> FloatImage:
    disc = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (2 * band + 1, 2 * band + 1))
    mask = region.view(np.uint8)
    inner = np.asarray(cv2.erode(mask, disc, borderType=cv2.BORDER_REPLICATE), np.uint8)
    outer = np.asarray(cv2.dilate(mask, disc, borderType=cv2.BORDER_REPLICATE), np.uint8)
    colours = small.astype(np.float32)
    inside = _local_mean(colours, inner, _REACH_INSIDE)
    outside = _local_mean(colours, 1 - outer, _REACH_OUTSIDE)
    prior = np.asarray(cv2.GaussianBlur(mask.astype(np.float32), (0, 0), 1.0), np.float32)
    height, width = fine.shape[:2]
    if fine.shape == small.shape:
        field = inner.astype(np.float32)
        rows, columns = np.nonzero(outer > inner)
        picked = [image[rows, columns] for image in (inside, outside, prior)]
    else:
        field = cv2.resize(inner, (width, height), interpolation=cv2.INTER_NEAREST).astype(
            np.float32
        )
        grown = cv2.resize(outer, (width, height), interpolation=cv2.INTER_NEAREST)
        rows, columns = np.nonzero(grown > field)
        at = (
            ((columns + 0.5) * (small.shape[1] / width) - 0.5).astype(np.float32),
            ((rows + 0.5) * (small.shape[0] / height) - 0.5).astype(np.float32),
        )
        picked = [_sample(image, *at) for image in (inside, outside, prior)]
    field[rows, columns] = _share(fine[rows, columns].astype(np.float32), *picked)
    return field


def _share(
    seen: FloatImage, inside: FloatImage, outside: FloatImage, prior: FloatImage
) -> FloatImage:
    step = inside - outside
    power = (step**2).sum(axis=1)
    share = ((seen - outside) * step).sum(axis=1) / np.maximum(power, 1e-3)
    trust = power**2 / (power**2 + _LEAST_CONTRAST**4)
    return np.asarray(np.clip(trust * share + (1 - trust) * prior, 0, 1), np.float32)


def _local_mean(colours: FloatImage, mask: NDArray[np.uint8], reach: float) -> FloatImage:
    """Mean colour of the masked pixels nearby, carried on to where there are none."""
    weight = mask.astype(np.float32)[..., None]
    weighted = np.concatenate([colours * weight, weight], axis=2)
    total = np.asarray(cv2.GaussianBlur(weighted, (0, 0), reach), np.float32)
    height, width = mask.shape
    for shrink, importance in ((4, 1e-3), (16, 1e-6)):
        size = max(2, width // shrink), max(2, height // shrink)
        coarse = cv2.GaussianBlur(
            cv2.resize(weighted, size, interpolation=cv2.INTER_AREA), (0, 0), 1
        )
        total += np.asarray(importance * cv2.resize(coarse, (width, height)), np.float32)
    return np.asarray(total[..., :3] / np.maximum(total[..., 3:], 1e-12), np.float32)


def _sample(image: FloatImage, x: FloatImage, y: FloatImage) -> FloatImage:
    """Bilinear values of an image at N points."""
    # remap takes at most 32767 rows or columns, so the list is folded.
    fold = 8192
    padding = -len(x) % fold
    grid = [np.pad(values, (0, padding)).reshape(-1, fold) for values in (x, y)]
    values = cv2.remap(image, grid[0], grid[1], cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    flat = values.reshape(-1, *image.shape[2:])
    return np.asarray(flat[: len(x)], np.float32)
