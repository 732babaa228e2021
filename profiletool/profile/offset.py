"""Reach of a tube around an object, and the curves at a distance from a profile.

Side convention: the tube lies outside the object, which is to the right of the travel direction
for ``side == "left"`` and to its left for ``"right"``.
"""

from __future__ import annotations

import numpy as np
import shapely

from profiletool.errors import NoObject
from profiletool.profile.curve import ring_stretch
from profiletool.records.frames import outward
from profiletool.records.profile import Profile
from profiletool.records.units import FloatArray

_QUADRANT_SEGMENTS = 64  # a 10 mm arc drawn to 0.001 mm
_HAIR_MM = 1e-3
_SAME_MM = 0.01


def reachable_outline(outline: FloatArray, radius_mm: float, clearance_mm: float) -> FloatArray:
    """Close an object by a disc: grooves that the disc cannot enter are bridged.

    Parameters
    ----------
    outline : (M, 2) array, mm
        Closed outline of the object.
    radius_mm : float
        Of the tube.
    clearance_mm : float
        The object is grown by this much first.

    Returns
    -------
    (N, 2) array, mm, the outline of what the disc touches from outside

    Raises
    ------
    NoObject
        When the outline encloses nothing.
    """
    body = shapely.Polygon(outline).buffer(0.0)
    grown = body.buffer(clearance_mm + radius_mm, quad_segs=_QUADRANT_SEGMENTS)
    closed = grown.buffer(-radius_mm, quad_segs=_QUADRANT_SEGMENTS)
    parts = [part for part in shapely.get_parts(closed) if isinstance(part, shapely.Polygon)]
    if not parts or max(_area(part) for part in parts) == 0.0:
        raise NoObject(
            "the outline encloses no area; draw a closed contour that does not cross itself"
        )
    largest = max(parts, key=_area)
    points: FloatArray = shapely.get_coordinates(largest.exterior)[:-1]
    return points


def reachable_line(
    points: FloatArray, radius_mm: float, clearance_mm: float, toward: float
) -> FloatArray:
    """Do the same for an open profile (N, 2); ``toward`` is +1 for a tube to its right, else -1."""
    line = shapely.LineString(points)
    grown = line.buffer(clearance_mm + radius_mm, quad_segs=_QUADRANT_SEGMENTS)
    # A hair less than all the way back, so that a straight line keeps an area.
    closed = grown.buffer(_HAIR_MM - radius_mm, quad_segs=_QUADRANT_SEGMENTS)
    ring = shapely.get_coordinates(max(shapely.get_parts(closed), key=_area).exterior)[:-1]
    length = shapely.LinearRing(ring).length
    # Where the ends come to lie: straight across from them, on the tube's side.
    ends = np.array([points[0], points[-1]])
    along = np.array([points[1] - points[0], points[-1] - points[-2]])
    across = np.column_stack([along[:, 1], -along[:, 0]]) / np.hypot(*along.T)[:, None]
    start, end = shapely.line_locate_point(
        shapely.LinearRing(ring), shapely.points(ends + toward * clearance_mm * across)
    )
    ways = (
        ring_stretch(ring, start, end if end > start else end + length),
        ring_stretch(ring, end, start if start > end else start + length)[::-1],
    )
    way = max(ways, key=lambda way: toward * _rightness(line, way))
    bridged = shapely.distance(shapely.points(way), line).max() > clearance_mm + _SAME_MM
    return way if bridged or clearance_mm > 0.0 else points


def _rightness(line: shapely.LineString, way: FloatArray) -> float:
    """How far a way runs to the right of a line, on the mean."""
    way = way[:: max(1, len(way) // 200)]
    at = shapely.line_locate_point(line, shapely.points(way))
    step = 1e-3 * line.length
    behind, ahead = (
        shapely.get_coordinates(shapely.line_interpolate_point(line, np.clip(v, 0.0, line.length)))
        for v in (at - step, at + step)
    )
    along, off = ahead - behind, way - 0.5 * (ahead + behind)
    return float(np.mean(along[:, 1] * off[:, 0] - along[:, 0] * off[:, 1]))


def _area(part: shapely.Polygon) -> float:
    return float(part.area)


def offset_points(profile: Profile, distance_mm: float) -> FloatArray:
    """Points at a distance outward of every point of the profile, along its normals: (N, 2)."""
    return profile.points + distance_mm * outward(profile.heading, profile.sign)


def offset_curve(profile: Profile, distance_mm: float) -> FloatArray:
    """Curve at a distance outward of the profile, loops removed: (K, 2).

    Where the offset falls apart, the points along the normals are returned, loops and all.
    """
    # shapely's distance is positive to the left of the travel direction.
    line = shapely.offset_curve(
        shapely.LineString(profile.points),
        -profile.sign * distance_mm,
        quad_segs=_QUADRANT_SEGMENTS,
        join_style="round",
    )
    if not isinstance(line, shapely.LineString) or line.is_empty:
        return offset_points(profile, distance_mm)
    coordinates: FloatArray = shapely.get_coordinates(line)
    return coordinates
