"""Evidence for a mask: its edge, its colours, its shape, and what it lies on or bears."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from profiletool.image.find.across import Rim, rim_of, steps
from profiletool.image.find.colours import histogram, likeness
from profiletool.image.find.ground import BoolImage, FloatImage, border_of, frame_of
from profiletool.image.find.masks import overlap, window_of
from profiletool.image.find.view import View

_FIRM_LAB = 6.0  # a step in colour that is no noise
_REACH_SHARE, _REACH_PX = 0.045, (5, 8)  # of the object's size, and its bounds
_RUN_PX = 15  # along so much of an outline its step keeps its direction
_FRAME_SHARE = 0.08
_KNOWN = 0.1  # a colour is known that is this much as common along the border
_BAND_SHARE = 0.12  # width of the band outside, of the object's size
_BENDS = (0.02, 0.03, 0.04, 0.06, 0.08, 0.1)  # of a hull's length: what four corners may miss
_SHEET, _NO_SHEET = 0.97, 0.9  # overlap with four corners of a sheet, and of what is none

# Fitted to photographs with true masks: which candidate is the object, and how likely it is.
_MERIT = {
    "edge": 1.4, "steady": 3.4, "peak": 1.3, "separation": 0.1, "ground": 2.7, "border": -17.1,
    "width": -0.9, "middle": 6.1, "regained": 0.9, "agreement": 1.8,
    "on_sheet": 6.0, "sheet": -2.3, "within": -1.4, "clear": 1.1, "plain": 2.5, "pointed": 1.5,
}  # fmt: skip
_ODDS = {"share": 2.7, "clear": 1.3, "drawn_by": 1.4, "small": -3.0}
_EDGELESS = 0.5  # with less of a firm edge, nothing else makes up for it
_SMALL_WIDTH = 0.2  # of the picture: what is smaller shows less of itself
_SECOND_OPINION = 0.85  # overlap with the learned one below which there is doubt
_BIAS = -3.0
_CEILING = 0.97  # of that chance: what can be seen of a mask warrants no more


@dataclass(frozen=True)
class Quality:
    """What speaks for a mask or against it.

    Attributes
    ----------
    edge : float
        Share of the outline with a firm step of colour across it.
    steady : float
        How far that step keeps its direction along the outline, or the inside its colour where
        the ground has many: 1 wholly, 0 as chance has it.
    peak : float
        Share of the outline where no line alongside has a firmer step than it has nearby.
    separation : float
        How little the colours inside and those just outside have in common, 0 to 1.
    ground : float
        Share of the pixels just outside whose colours are found along the border of the ground
        too: the picture's frame, or the rim of what the region lies on.
    border : float
        Share of the outline that runs along the frame.
    size : float
        Share of the picture.
    middle : float
        How near the region's centre is to the picture's: 1 there, 0 in a corner, and 0 too where
        the user has said where the object is.
    four_cornered : float
        Whether four corners tell its shape, 0 to 1.
    regained : float
        Overlap with what its colours alone, against those of all the rest, cut out.
    drawn_by : float
        Share of the methods that draw the same outline.
    agreement : float
        Mean overlap with what all methods find.
    learned : float
        Overlap with the learned opinion; 1 where there is none.
    on_sheet : float
        How clear something of four corners is round it, 0 to 1.
    sheet : float
        How clear what lies on it is, where it has four corners, 0 to 1.
    within : float
        How clear a larger candidate round it is against it, where that is no sheet, 0 to 1.
    plain : float
        How clear its edge is where it is what stands out from a ground of one smooth colour.
    pointed : float
        Whether it was cut out by the colours round the user's point.
    share : float
        Share of the belief in all candidates, by their merits, that goes to this outline.
    """

    edge: float
    steady: float
    peak: float
    separation: float
    ground: float
    border: float
    size: float
    middle: float
    four_cornered: float
    regained: float = 1.0
    drawn_by: float = 1.0
    agreement: float = 1.0
    learned: float = 1.0
    on_sheet: float = 0.0
    sheet: float = 0.0
    within: float = 0.0
    plain: float = 0.0
    pointed: float = 0.0
    share: float = 1.0

    @property
    def width(self) -> float:
        """Root of the share of the picture."""
        return float(np.sqrt(self.size))

    @property
    def small(self) -> float:
        """How far it falls short of a size that shows enough of it, 0 to 1."""
        return max(0.0, 1.0 - self.width / _SMALL_WIDTH)

    @property
    def clear(self) -> float:
        """How clearly it is told from what is round it, by itself."""
        return self.edge * self.regained * self.separation

    @property
    def merit(self) -> float:
        """What tells the object from all other candidates; larger is better."""
        return self._sum(_MERIT)

    @property
    def confidence(self) -> float:
        """Chance that the mask is the object's to a twentieth of its area, 0 to 1."""
        odds = 1.0 / (1.0 + np.exp(-_BIAS - self._sum(_ODDS)))
        doubt = min(1.0, self.edge / _EDGELESS) * min(1.0, self.learned / _SECOND_OPINION)
        return float(_CEILING * odds * doubt)

    def _sum(self, weights: Mapping[str, float]) -> float:
        return sum(weight * float(getattr(self, name)) for name, weight in weights.items())


def quality_of(view: View, mask: BoolImage, home: BoolImage | None = None) -> Quality:
    """Judge a mask (H, W), one region with its holes filled, on its picture.

    ``home`` is the region that it lies on, where that is not all of the picture.
    """
    area = float(mask.sum())
    rim = rim_of(view.lab, mask, round(float(np.clip(_REACH_SHARE * np.sqrt(area), *_REACH_PX))))
    edge, steady, peak = edge_support(rim)
    separation, ground = _colour_support(view.cell, mask, home)
    return Quality(
        edge=edge,
        steady=steady,
        peak=peak,
        separation=separation,
        ground=ground,
        border=float(rim.on_frame.mean()),
        size=area / mask.size,
        middle=0.0 if view.told else _middle(mask),
        four_cornered=_four_cornered(mask),
    )


def _middle(mask: BoolImage) -> float:
    half = np.array(mask.shape) / 2.0
    rows, columns = np.nonzero(mask)
    off = np.hypot(rows.mean() / half[0] - 1.0, columns.mean() / half[1] - 1.0)
    return float(1.0 - off / np.sqrt(2.0))


def _four_cornered(mask: BoolImage) -> float:
    outlines, _ = cv2.findContours(mask.view(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    hull = cv2.convexHull(max(outlines, key=len))
    for bend in _BENDS:
        corners = cv2.approxPolyDP(hull, bend * cv2.arcLength(hull, True), True)
        if len(corners) <= 4:
            break
    if len(corners) != 4:
        return 0.0
    drawn = np.zeros(mask.shape, np.uint8)
    cv2.fillPoly(drawn, [corners], 1)
    share = (overlap(drawn > 0, mask) - _NO_SHEET) / (_SHEET - _NO_SHEET)
    return float(np.clip(share, 0.0, 1.0))


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
        max(_steadiness(step[:, middle], free), _constancy(rim.colours, step[:, middle], free)),
        float((at_edge > alongside)[free].mean()),
    )


def _steadiness(step: FloatImage, free: NDArray[np.bool_]) -> float:
    size = _running(np.linalg.norm(step, axis=1, keepdims=True))[:, 0]
    return float((np.linalg.norm(_running(step), axis=1) / np.maximum(size, 1e-6))[free].mean())


def _constancy(colours: FloatImage, step: FloatImage, free: NDArray[np.bool_]) -> float:
    """Say how little the colour just inside changes along an outline, against the step there."""
    middle = colours.shape[1] // 2
    inside = colours[:, middle - 4 : middle - 1].mean(axis=1)
    variance = np.maximum(_running(inside**2) - _running(inside) ** 2, 0.0)
    spread = np.sqrt(variance.sum(axis=1))
    size = _running(np.linalg.norm(step, axis=1, keepdims=True))[:, 0]
    return float(np.clip(1.0 - spread / np.maximum(size, 1e-6), 0.0, 1.0)[free].mean())


def _running(along: FloatImage) -> FloatImage:
    """Average (N, C) values along a closed line."""
    weights = np.ones(_RUN_PX) / _RUN_PX
    round_ = np.pad(along, ((_RUN_PX // 2, _RUN_PX // 2), (0, 0)), mode="wrap")
    means = [np.convolve(c, weights, mode="valid") for c in round_.T]
    return np.asarray(np.stack(means, axis=1), np.float32)


def _colour_support(
    cell: NDArray[np.int32], mask: BoolImage, home: BoolImage | None
) -> tuple[float, float]:
    """Give separation and ground, from every other row and column."""
    around = frame_of(mask.shape, _FRAME_SHARE) if home is None else border_of(home)
    cell, mask, around = cell[::2, ::2], mask[::2, ::2], (around & ~mask)[::2, ::2]
    if not mask.any() or mask.all():
        return 0.0, 0.0
    wide = max(3, round(_BAND_SHARE * float(np.sqrt(mask.sum()))))
    near = np.zeros(mask.shape, bool)
    window = window_of(mask, wide + 1)
    off = cv2.distanceTransform((~mask[window]).view(np.uint8), cv2.DIST_L2, 3)
    near[window] = (off > 0) & (off <= wide)
    inside, outside = histogram(cell, mask), histogram(cell, near)
    known = histogram(cell, around) > _KNOWN * outside
    return 1.0 - likeness(inside, outside), float(outside[known].sum())
