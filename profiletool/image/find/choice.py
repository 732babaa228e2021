"""The choice between candidates: what the user said of the object, and two that are alike."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import cv2
import numpy as np

from profiletool.image.find.ground import BoolImage
from profiletool.image.find.judge import Candidate, ahead
from profiletool.image.find.masks import overlap
from profiletool.image.find.proposals import AT_POINT
from profiletool.image.find.region import ALIKE, SeveralAlike

_APART = 0.05  # overlap below which two masks are two things
_EXTENT, _LOOSE = 0.7, 0.6  # overlap of a mask's own box with the one given, close or loose
_BY_WIDTH = 3.0  # merit that a point takes from what is as large as the picture
_NEAR, _LITTLE = 0.7, 0.06  # merit behind the best; share of its area that is worth a word
_ONE_THING = 0.8  # overlap from which on two masks are of one thing
_SAME_SHOWN = 0.9  # overlap of two masks that look the same
_RIVAL, _ALONE = 2.0, 0.5  # merit behind the best; confidence that each would have alone


def fitting(found: Sequence[Candidate], barred: BoolImage) -> list[Candidate]:
    """Keep what fills a box, all but which is barred (H, W), or else what nearly does."""
    box = _extent(~barred)
    fits = [overlap(_extent(one.mask), box) for one in found]
    least = _EXTENT if max(fits) >= _EXTENT else _LOOSE
    return _told([one for one, fit in zip(found, fits, strict=True) if fit >= least])


def round_point(found: Sequence[Candidate]) -> list[Candidate]:
    """Put what its colours cut out most closely round a point first; all candidates hold it."""
    cut_out = [
        replace(one, quality=replace(one.quality, pointed=float(one.method.startswith(AT_POINT))))
        for one in found
    ]
    return _told(cut_out, _BY_WIDTH)


def _told(found: Sequence[Candidate], by_width: float = 0.0) -> list[Candidate]:
    """Order candidates anew by what the user has said."""
    merits = np.array([one.quality.merit - by_width * one.quality.width for one in found])
    made = []
    for number in np.argsort(-merits, kind="stable"):
        one = found[number]
        alike = np.array([overlap(one.mask, other.mask) for other in found])
        quality = ahead(one.quality, merits[number] - merits, alike)
        made.append(replace(one, quality=quality))
    return made


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


def of_one_thing(one: Candidate, other: Candidate) -> bool:
    """Whether two candidates are outlines of one thing."""
    return overlap(one.mask, other.mask) > _ONE_THING


def doubt_of(found: Sequence[Candidate]) -> str:
    """Say which part of the best candidate may not belong to it, or what may be missing.

    A shadow, a reflection and a neighbour that touches the object all look so.
    """
    best = found[0]
    area = float(best.mask.sum())
    for other in found[1:]:
        more, less = other.mask & ~best.mask, best.mask & ~other.mask
        part, verb = (more, "left out") if more.sum() > less.sum() else (less, "taken in")
        share = float(part.sum()) / area
        near = best.quality.merit - other.quality.merit < _NEAR
        if near and _EXTENT > share > _LITTLE and min(more.sum(), less.sum()) < _LITTLE * area:
            return (
                f"{100 * share:.0f} % of the object's area {_side(part, best.mask)} may be a "
                f"shadow, a reflection or a neighbour and was {verb}: look at overlay.png"
            )
    return ""


def _side(part: BoolImage, mask: BoolImage) -> str:
    """Name where a part lies as seen from the middle of a mask."""
    down, right = (np.argwhere(part).mean(axis=0) - np.argwhere(mask).mean(axis=0)).tolist()
    if abs(down) > abs(right):
        return "at the bottom" if down > 0 else "at the top"
    return "on the right" if right > 0 else "on the left"


def refuse_another(best: Candidate, found: Sequence[Candidate]) -> None:
    """Refuse when the best candidate and another, each alone, would both be believed.

    Raises
    ------
    SeveralAlike
    """
    for other in found if _alone(best) > _ALONE else ():
        as_large = ALIKE < other.quality.size / best.quality.size < 1.0 / ALIKE
        apart = overlap(best.mask, other.mask) < _APART
        near = best.quality.merit - other.quality.merit < _RIVAL
        if as_large and apart and near and _alone(other) > _ALONE:
            raise SeveralAlike([best.mask, other.mask])


def _alone(one: Candidate) -> float:
    return replace(one.quality, share=1.0).confidence
