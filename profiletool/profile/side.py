"""One side of a closed outline, from the object's top middle to its bottom middle."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely

from profiletool.profile.curve import ring_stretch
from profiletool.records.side import Side, side_sign
from profiletool.records.units import FloatArray

_TOP_SHARE = 0.02  # of the height: what counts as the top of the object


def top_middle(outline: FloatArray) -> FloatArray:
    """Return the top middle of a closed outline (M, 2): the middle of its highest run, (2,)."""
    top = _rotated_to_top(outline)
    height = np.ptp(outline[:, 1])
    low = top[:, 1] < top[0, 1] - _TOP_SHARE * height
    ahead = int(np.argmax(low))
    behind = len(top) - int(np.argmax(low[::-1]))
    run = np.concatenate([top[behind:], top[:ahead]])
    x = 0.5 * (run[:, 0].min() + run[:, 0].max())
    cut = shapely.LineString([(x, outline[:, 1].min() - 1.0), (x, outline[:, 1].max() + 1.0)])
    crossing = shapely.intersection(shapely.LinearRing(outline), cut)
    points = shapely.get_coordinates(crossing)
    return np.asarray(points[np.argmax(points[:, 1])], dtype=float)


@dataclass(frozen=True)
class Stretch:
    """A stretch of a longer line, so that what lies beyond its ends can steady its headings.

    ``points`` (N, 2) is the longer line, ``start`` and ``end`` the arc lengths on it.
    """

    points: FloatArray
    start: float
    end: float


def side_of(outline: FloatArray, side: Side, margin: float) -> Stretch:
    """Cut one side out of a closed outline.

    Parameters
    ----------
    outline : (M, 2) array, mm, y up, either direction
    side : "left" or "right"
    margin : float, mm
        How much of the outline to keep beyond either end.

    Returns
    -------
    Stretch
        From the top middle to the bottom middle.
    """
    mirror = np.array([side_sign(side), 1.0])
    ring = shapely.LinearRing(outline * mirror)
    if not ring.is_ccw:
        ring = ring.reverse()
    points = shapely.get_coordinates(ring)[:-1]
    start = ring.project(shapely.Point(top_middle(points)))
    bottom = ring.project(shapely.Point(top_middle(-points) * -1.0))
    end = start + (bottom - start) % ring.length
    margin = min(margin, 0.2 * ring.length)
    longer = ring_stretch(points, start - margin, end + margin)
    return Stretch(longer * mirror, margin, margin + end - start)


def _rotated_to_top(outline: FloatArray) -> FloatArray:
    return np.roll(outline, -int(np.argmax(outline[:, 1])), axis=0)
