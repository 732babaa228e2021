"""The choice between candidates: what the user said of the object, and two that are alike."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np

from profiletool.image.find.candidates import BELIEVED, Candidate
from profiletool.image.find.ground import BoolImage
from profiletool.image.find.masks import overlap
from profiletool.image.find.region import ALIKE, SeveralAlike

_APART = 0.05  # overlap below which two masks are two things
_EXTENT = 0.7  # overlap of a mask's own box with the one that was given
_SAME_SHOWN = 0.9  # overlap of two masks that look the same


def fitting(found: Sequence[Candidate], barred: BoolImage) -> list[Candidate]:
    """Keep what fills a box, all but which is barred (H, W)."""
    box = _extent(~barred)
    return [one for one in found if overlap(_extent(one.mask), box) >= _EXTENT]


def _extent(mask: BoolImage) -> BoolImage:
    x, y, w, h = cv2.boundingRect(np.ascontiguousarray(mask).view(np.uint8))
    extent = np.zeros(mask.shape, bool)
    extent[y : y + h, x : x + w] = True
    return extent


def different(found: Sequence[Candidate]) -> list[Candidate]:
    """Leave out what looks the same as one before it."""
    kept: list[Candidate] = []
    for one in found:
        if all(overlap(one.mask, other.mask) < _SAME_SHOWN for other in kept):
            kept.append(one)
    return kept


def refuse_another(best: Candidate, found: Sequence[Candidate]) -> None:
    """Refuse when another object is believed as much as the best candidate.

    Raises
    ------
    SeveralAlike
    """
    for other in found:
        as_large = ALIKE < other.quality.size / best.quality.size < 1.0 / ALIKE
        apart = overlap(best.mask, other.mask) < _APART
        if as_large and apart and other.confidence >= BELIEVED:
            raise SeveralAlike([best.mask, other.mask])
