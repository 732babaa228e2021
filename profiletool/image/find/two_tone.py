"""Pictures of two tones: masks, scans of prints and drawings, which show their object outright."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from profiletool.image.find.ground import BoolImage, FloatImage, frame_of
from profiletool.records.units import FloatArray

_TONES_APART = 60.0  # 8 bit levels
_OFF_TONE, _PURE = 14.0, 0.975  # what counts as a tone, and how much of a picture has one
_TRIM_PX = 2
_LOOKED_AT = 100_000  # pixels


def two_tones(rgb: NDArray[np.uint8]) -> FloatImage | None:
    """Share of object in every pixel of a picture (H, W, 3) of two tones; None for any other.

    The ground is the tone that most of the frame has; between the tones lie blurred edges only.
    """
    sparse = max(1, round(float(np.sqrt(rgb[..., 0].size / _LOOKED_AT))))
    tones = _tones(rgb[::sparse, ::sparse])
    if tones is None:
        return None
    far, near = tones
    shade = rgb.astype(np.float32)
    step = (far - near).astype(np.float32)
    share = (shade - near.astype(np.float32)) @ step / float(step @ step)
    return np.asarray(np.clip(share, 0.0, 1.0), np.float32)


def _tones(rgb: NDArray[np.uint8]) -> tuple[FloatArray, FloatArray] | None:
    """Give the colours of object and ground, (3,) each, where there are no others."""
    grey = cv2.cvtColor(np.ascontiguousarray(rgb), cv2.COLOR_RGB2GRAY)
    level, _ = cv2.threshold(grey, 0, 255, cv2.THRESH_BINARY | cv2.THRESH_OTSU)
    bright = grey > level
    if not bright.any() or bright.all():
        return None
    light = bool(bright[frame_of(grey.shape, 0.01)].mean() > 0.5)
    parts = (rgb[~bright], rgb[bright]) if light else (rgb[bright], rgb[~bright])
    far, near = (np.median(part, axis=0) for part in parts)
    if float(np.linalg.norm(far - near)) < _TONES_APART:
        return None
    off = [np.abs(rgb - tone).max(axis=2) for tone in (far, near)]
    pure = float((np.minimum(*off) < _OFF_TONE).mean()) >= _PURE
    return (far, near) if pure else None


def trimmed(mask: BoolImage) -> bool:
    """Whether a picture is cut to its object's own size: to meet the frame means nothing then."""
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    height, width = mask.shape
    margins = rows[0], height - 1 - rows[-1], columns[0], width - 1 - columns[-1]
    return sum(int(margin) <= _TRIM_PX for margin in margins) >= 3
