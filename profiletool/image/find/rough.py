"""Cuts of a view by cv2.grabCut, so small that each takes a tenth of a second."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from profiletool.image.find.ground import BoolImage, frame_of
from profiletool.image.find.sizes import resized
from profiletool.image.find.view import View

_PIXELS = 20_000
_FRAME = 0.02  # of the shorter side: ground for certain
_CORE = 0.02  # of the shorter side: object for certain, round a point
_FEWEST = 2e-3  # of the frame: fewer pixels do not tell their colours, on which it takes very long
_ROUNDS = 3
_ALL = slice(None), slice(None)


@dataclass(frozen=True)
class Rough:
    """A view made smaller still, (h, w), and what is certain in it.

    Attributes
    ----------
    rgb : (h, w, 3) uint8
    ground, core : (h, w) bool
        Ground and object for certain.
    shape : (H, W)
        Of the view.
    """

    rgb: NDArray[np.uint8]
    ground: BoolImage
    core: BoolImage
    shape: tuple[int, int]

    def cut(self, guess: BoolImage, elsewhere: bool = True) -> BoolImage:
        """Part object and ground by the colours inside and outside a guess (H, W).

        Parameters
        ----------
        guess : (H, W)
        elsewhere : bool
            Whether there may be object outside the guess.
        """
        outside = cv2.GC_PR_BGD if elsewhere else cv2.GC_BGD
        labels = np.where(resized(guess, self.ground.shape), cv2.GC_PR_FGD, outside)
        labels[self.ground] = cv2.GC_BGD
        labels[self.core] = cv2.GC_FGD
        return resized(grabcut(self.rgb, labels.astype(np.uint8)), self.shape)


def rough_of(
    view: View, window: tuple[slice, slice] = _ALL, ground: BoolImage | None = None
) -> Rough:
    """Make a view, or a window of it, smaller; ``ground`` (H, W) is more of it for certain."""
    barred = (view.barred if ground is None else view.barred | ground)[window]
    step = max(1.0, float(np.sqrt(barred.size / _PIXELS)))
    height, width = barred.shape
    shape = max(8, round(height / step)), max(8, round(width / step))
    small = cv2.resize(view.rgb[window], shape[::-1], interpolation=cv2.INTER_AREA)
    core = np.zeros(shape, bool)
    if view.point is not None:
        x, y = view.point[0] - (window[1].start or 0), view.point[1] - (window[0].start or 0)
        core = disc(shape, (x / step, y / step), _CORE * min(shape))
    certain = frame_of(shape, _FRAME) | resized(barred, shape)
    return Rough(_dithered(np.asarray(small, np.uint8)), certain, core, (height, width))


def _dithered(rgb: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Add a grey level up or down: on drawn, noiseless colours cv2.grabCut takes many seconds."""
    dither = np.random.default_rng(0).integers(-1, 2, rgb.shape)
    return np.asarray(np.clip(rgb + dither, 0, 255), np.uint8)


def disc(shape: tuple[int, int], centre: tuple[float, float], radius: float) -> BoolImage:
    """Mask a disc of an (H, W) picture."""
    v, u = np.ogrid[: shape[0], : shape[1]]
    return np.asarray(np.hypot(u - centre[0], v - centre[1]) <= radius)


def grabcut(rgb: NDArray[np.uint8], labels: NDArray[np.uint8]) -> BoolImage:
    """Part by colour mixtures, from labels (H, W) of cv2.grabCut; speckle is opened away."""
    if not _FEWEST < float((labels & 1).mean()) < 1.0:
        return np.zeros(labels.shape, bool)
    cv2.setRNGSeed(0)  # its colour clusters start from random ones
    parted = labels.copy()
    models = np.zeros((1, 65)), np.zeros((1, 65))
    bgr = np.ascontiguousarray(rgb[..., ::-1])
    cv2.grabCut(bgr, parted, (0, 0, 1, 1), *models, _ROUNDS, cv2.GC_INIT_WITH_MASK)
    found = np.isin(parted, (cv2.GC_FGD, cv2.GC_PR_FGD))
    speck = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (5, 5))
    return np.asarray(cv2.morphologyEx(found.view(np.uint8), cv2.MORPH_OPEN, speck) > 0)
