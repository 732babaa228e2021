"""A body photographed, measured as the program does it, and compared with what it is."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import ndimage

from profiletool.image.find.silhouette import find_silhouette
from profiletool.image.sheet.board import BOARDS, Board
from profiletool.image.sheet.measure import Measured, measure
from profiletool.image.sheet.rectify import Rectified, rectify
from tests.image.views import Body, Shot, photograph


@dataclass(frozen=True)
class Trial:
    """Relative errors of width and length, and what was said of them."""

    errors: tuple[float, float]
    made: Rectified
    measured: Measured

    @property
    def worst(self) -> float:
        return max(self.errors, key=abs)

    @property
    def inside(self) -> bool:
        """Whether the whole error bar holds the truth."""
        bar = self.measured.scale.error_share
        return bar is not None and abs(self.worst) <= bar

    @property
    def inside_measured(self) -> bool:
        """Whether the part that knows the body to be one of revolution does so alone."""
        return abs(self.worst) <= self.measured.measured_share


def trial(
    body: Body,
    shot: Shot,
    rng: np.random.Generator,
    board: Board = BOARDS[0],
    focal_error: float | None = 0.02,
    camera_distance_mm: float | None = None,
) -> Trial:
    at = (float(rng.uniform(-8, 8)), float(rng.uniform(-15, 15)))
    turn = float(rng.uniform(-4, 4)) if np.ptp(body.place) > 0 else 0.0
    picture = photograph(board, body, shot, rng, at, turn, focal_error=focal_error)
    made = rectify(picture)
    assert made is not None
    found = measure(made, find_silhouette(made.plain), camera_distance_mm)
    size = np.array(extents(found, turn)) / (body.width, body.length) - 1
    return Trial((float(size[0]), float(size[1])), made, found)


def extents(found: Measured, turn: float) -> tuple[float, float]:
    """Width and length, mm, of an outline whose axis is ``turn`` degrees off the picture's.

    Of the outline's running mean over 3 mm: the extremes of a long side are those of its scatter.
    """
    angle = np.radians(turn)
    points = found.silhouette.contour_px * found.scale.mm_per_px
    closed = np.vstack([points, points[:1]])
    s = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(closed, axis=0).T))])
    places = np.arange(0.0, s[-1], 0.25)
    even = np.stack([np.interp(places, s, side) for side in closed.T], axis=1)
    mean = ndimage.uniform_filter1d(even, 12, axis=0, mode="wrap")
    across = mean @ [np.cos(angle), np.sin(angle)]
    along = mean @ [-np.sin(angle), np.cos(angle)]
    return float(np.ptp(across)), float(np.ptp(along))
