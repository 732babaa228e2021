"""Confidence in a mask: by its edge, its colours and its shape."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from profiletool.image.find.across import Rim, rim_of, steps
from profiletool.image.find.colours import histogram, likeness
from profiletool.image.find.ground import BoolImage, FloatImage, frame_of
from profiletool.image.find.masks import window_of
from profiletool.image.find.view import View

_FIRM_LAB = 6.0  # a step in colour that is no noise
_REACH_SHARE, _REACH_PX = 0.045, (5, 8)  # of the object's size, and its bounds
_RUN_PX = 15  # along so much of an outline its step keeps its direction
_FRAME_SHARE = 0.08
_KNOWN = 0.1  # a colour is known that is this much as common along the frame
_BAND_SHARE = 0.12  # width of the band outside, of the object's size
# A logistic regression on photographs with true masks, rounded.
_WEIGHTS = {"edge": 2.0, "peak": 5.0, "separation": 3.0, "ground": 3.0, "solidity": 3.5}
_BIAS = -13.3


@dataclass(frozen=True)
class Quality:
    """What speaks for a mask, and for how much it counts together.

    Attributes
    ----------
    edge : float
        Share of the outline with a firm step of colour across it.
    steady : float
        How far that step keeps its direction along the outline: 1 wholly, 0 as chance has it.
    peak : float
        Share of the outline where no line alongside has a firmer step than it has nearby.
    separation : float
        How little the colours inside and those just outside have in common, 0 to 1.
    ground : float
        Share of the pixels just outside whose colours are found along the frame too.
    compactness : float
        4 pi area over the perimeter squared: 1 for a disc.
    solidity : float
        Area over that of the convex hull.
    border : float
        Share of the outline that runs along the frame.
    size : float
        Share of the picture.
    middle : float
        How near the region's centre is to the picture's: 1 there, 0 in a corner.
    regained : float
        Overlap with what its colours alone, against those of all the rest, cut out.
    agreement : float
        Mean overlap with the other candidates.
    """

    edge: float
    steady: float
    peak: float
    separation: float
    ground: float
    compactness: float
    solidity: float
    border: float
    size: float
    middle: float = 1.0
    regained: float = 1.0
    agreement: float = 1.0

    @property
    def confidence(self) -> float:
        """Chance that the mask is the object's to a twentieth of its area, 0 to 1."""
        score = _BIAS + sum(weight * getattr(self, name) for name, weight in _WEIGHTS.items())
        return float(1.0 / (1.0 + np.exp(-score)))


def quality_of(
    view: View, mask: BoolImage, regained: float = 1.0, agreement: float = 1.0
) -> Quality:
    """Judge a mask (H, W), one region with its holes filled, on its picture."""
    area = float(mask.sum())
    rim = rim_of(view.lab, mask, round(float(np.clip(_REACH_SHARE * np.sqrt(area), *_REACH_PX))))
    edge, steady, peak = edge_support(rim)
    separation, ground = _colour_support(view.cell, mask)
    along = np.hypot(*(np.roll(rim.points, -1, axis=0) - rim.points).T).sum()
    hull = cv2.contourArea(cv2.convexHull(rim.points.astype(np.float32)))
    return Quality(
        edge=edge,
        steady=steady,
        peak=peak,
        separation=separation,
        ground=ground,
        compactness=min(1.0, 4.0 * np.pi * area / float(along) ** 2),
        solidity=min(1.0, area / max(hull, 1.0)),
        border=float(rim.on_frame.mean()),
        size=area / mask.size,
        middle=_middle(mask),
        regained=regained,
        agreement=agreement,
    )


def _middle(mask: BoolImage) -> float:
    half = np.array(mask.shape) / 2.0
    rows, columns = np.nonzero(mask)
    off = np.hypot(rows.mean() / half[0] - 1.0, columns.mean() / half[1] - 1.0)
    return float(1.0 - off / np.sqrt(2.0))


def edge_support(rim: Rim) -> tuple[float, float, float]:
    """Share of firm steps, their steadiness, and the share of steps that are the firmest near."""
    free = ~rim.on_frame
    if free.sum() < 8:
        return 0.0, 0.0, 0.0
    step = steps(rim.colours)
    size = np.linalg.norm(step, axis=2)
    middle = size.shape[1] // 2
    at_edge = size[:, middle - 1 : middle + 2].max(axis=1)
    alongside = np.delete(size, np.s_[middle - 2 : middle + 3], axis=1).max(axis=1)
    return (
        float((at_edge > _FIRM_LAB)[free].mean()),
        _steadiness(step[:, middle], free),
        float((at_edge > alongside)[free].mean()),
    )


def _steadiness(step: FloatImage, free: NDArray[np.bool_]) -> float:
    weights = np.ones(_RUN_PX) / _RUN_PX
    round_ = np.pad(step, ((_RUN_PX // 2, _RUN_PX // 2), (0, 0)), mode="wrap")
    mean = np.stack([np.convolve(c, weights, mode="valid") for c in round_.T], axis=1)
    size = np.convolve(np.linalg.norm(round_, axis=1), weights, mode="valid")
    return float((np.linalg.norm(mean, axis=1) / np.maximum(size, 1e-6))[free].mean())


def _colour_support(cell: NDArray[np.int32], mask: BoolImage) -> tuple[float, float]:
    """Give separation and ground, from every other row and column."""
    cell, mask = cell[::2, ::2], mask[::2, ::2]
    if not mask.any() or mask.all():
        return 0.0, 0.0
    wide = max(3, round(_BAND_SHARE * float(np.sqrt(mask.sum()))))
    near = np.zeros(mask.shape, bool)
    window = window_of(mask, wide + 1)
    off = cv2.distanceTransform((~mask[window]).view(np.uint8), cv2.DIST_L2, 3)
    near[window] = (off > 0) & (off <= wide)
    frame = frame_of(mask.shape, _FRAME_SHARE) & ~mask
    inside, outside = histogram(cell, mask), histogram(cell, near)
    known = histogram(cell, frame) > _KNOWN * outside
    return 1.0 - likeness(inside, outside), float(outside[known].sum())
