"""What a tube can reach of an object, and the curves at a distance from a profile.

Side convention: the tube lies outside the object, which is to the right of the travel direction
for ``side == "left"`` and to its left for ``"right"``.
"""

from __future__ import annotations

import numpy as np
import shapely

from profiletool.errors import NoObject
from profiletool.records import FloatArray, Profile

_QUADRANT_SEGMENTS = 64  # a 10 mm arc drawn to 0.001 mm


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
    if not parts or max(part.area for part in parts) == 0.0:
        raise NoObject(
            "the outline encloses no area; draw a closed contour that does not cross itself"
        )
    largest = max(parts, key=lambda part: part.area)
    points: FloatArray = shapely.get_coordinates(largest.exterior)[:-1]
    return points


def reachable_line(
    points: FloatArray, radius_mm: float, clearance_mm: float, toward: float
) -> FloatArray:
    """Do the same for an open profile (N, 2); ``toward`` is +1 for a tube to its right, else -1.

    Where the disc cannot follow at all (the offset falls apart), the profile is kept as drawn;
    the choice of joints then says what cannot be followed.
    """
    out = _offset(points, -toward * (radius_mm + clearance_mm))
    if out is None:
        return points
    back = _offset(out, toward * radius_mm)
    return points if back is None else back


def offset_points(profile: Profile, distance_mm: float) -> FloatArray:
    """Points at a distance outward of every point of the profile, along its normals: (N, 2)."""
    normal = np.column_stack([np.sin(profile.heading), -np.cos(profile.heading)])
    return profile.points + profile.sign * distance_mm * normal


def offset_curve(profile: Profile, distance_mm: float) -> FloatArray:
    """Curve at a distance outward of the profile, loops removed: (K, 2)."""
    line = _offset(profile.points, -profile.sign * distance_mm)
    return offset_points(profile, distance_mm) if line is None else line


def _offset(points: FloatArray, distance: float) -> FloatArray | None:
    """Offset a polyline, positive to its left, as shapely does; None where it falls apart."""
    line = shapely.offset_curve(
        shapely.LineString(points), distance, quad_segs=_QUADRANT_SEGMENTS, join_style="round"
    )
    if not isinstance(line, shapely.LineString) or line.is_empty:
        return None
    coordinates: FloatArray = shapely.get_coordinates(line)
    return coordinates
