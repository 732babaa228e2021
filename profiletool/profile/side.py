"""One side of a closed outline: from the object's top middle down to its base."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely

from profiletool.errors import NoObject
from profiletool.profile.curve import arc_length
from profiletool.records import FloatArray, Side

_TOP_SHARE = 0.02  # of the height: what counts as the top of the object
_UNDERSIDE = np.cos(np.radians(45.0))  # a normal this near to straight down belongs to the base
_STEP_SHARE = 0.005  # of the height: stride at which the underside is felt out


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
        From the top middle to where the underside begins: the last stretch, up to the bottom
        middle, on which the outward normal points within 45 deg of straight down.

    Raises
    ------
    NoObject
        When nothing is left between top and underside.
    """
    mirror = np.array([1.0 if side == "left" else -1.0, 1.0])
    ring = shapely.LinearRing(outline * mirror)
    if not ring.is_ccw:
        ring = ring.reverse()
    points = shapely.get_coordinates(ring)[:-1]
    start = ring.project(shapely.Point(top_middle(points)))
    bottom = ring.project(shapely.Point(top_middle(-points) * -1.0))
    length = (bottom - start) % ring.length
    end = start + _underside(_unrolled(ring, start, start + length))
    if end <= start:
        raise NoObject(f"the {side} side of the object has no length between its top and its base")
    margin = min(margin, 0.2 * ring.length)
    longer = _unrolled(ring, start - margin, end + margin)
    return Stretch(longer * mirror, margin, margin + end - start)


def _rotated_to_top(outline: FloatArray) -> FloatArray:
    return np.roll(outline, -int(np.argmax(outline[:, 1])), axis=0)


def _unrolled(ring: shapely.LinearRing, start: float, end: float) -> FloatArray:
    """Cut a ring from one arc length forward to another; both may lie beyond its seam."""
    coordinates = shapely.get_coordinates(ring)
    at = arc_length(coordinates)
    turns = at[-1] * np.array([[-1.0], [0.0], [1.0]])
    at_thrice = (at[:-1] + turns).ravel()
    thrice = np.tile(coordinates[:-1], (3, 1))
    inner = thrice[(at_thrice > start) & (at_thrice < end)]
    ends = [shapely.get_coordinates(ring.interpolate(v % at[-1])) for v in (start, end)]
    return np.concatenate([ends[0], inner, ends[1]])


def _underside(points: FloatArray) -> float:
    """Arc length at which the underside begins, felt out from the bottom middle upward."""
    line = shapely.LineString(points)
    stride = _STEP_SHARE * np.ptp(points[:, 1])
    at = np.arange(line.length, 0.0, -stride)
    felt = shapely.get_coordinates(shapely.line_interpolate_point(line, at))
    travel = felt[:-1] - felt[1:]
    # Travelling down the left side the outward normal (dy, -dx) points down where dx > 0.
    down = travel[:, 0] > _UNDERSIDE * np.hypot(travel[:, 0], travel[:, 1])
    return 0.0 if down.all() else float(at[np.argmin(down)])
