"""From an object's outline, or an open drawn profile, to the target profile of the tube."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import shapely
from numpy.typing import NDArray

from profiletool.errors import NoObject
from profiletool.profile.curve import Curve, arc_length, make_curve, smoothing_width
from profiletool.profile.offset import reachable_line, reachable_outline
from profiletool.profile.side import Stretch, side_of
from profiletool.records.profile import Profile
from profiletool.records.side import Side, side_sign
from profiletool.records.units import FloatArray

STEP_MM = 0.1  # spacing of a profile's points
LEAST_WINDOW = 0.2  # of the tube's radius: what is shorter is nothing to a tube
_UNDERCUT = np.sin(np.radians(20.0))  # normals steeper down than this face the base
_STRAIGHT_DOWN = np.cos(np.radians(45.0))
_MOST_LOST = 0.8  # of a drawn line: what is left when more is bridged is another curve
_LONGEST_MM = 1000.0  # four times the longest tube: the scale must be wrong
_BRIDGED_MM = 0.1  # a gap that counts as bridged, where noise does not ask for more


@dataclass(frozen=True)
class Reach:
    """Which stretch of an object the tube shall follow, and how.

    ``start_pct`` and ``end_pct`` count along the side's arc length; ``noise_mm`` and
    ``spacing_mm`` describe the outline (see `smoothing_width`).
    """

    side: Side
    radius_mm: float
    clearance_mm: float = 0.0
    start_pct: float = 0.0
    end_pct: float = 100.0
    noise_mm: float = 0.0
    spacing_mm: float = 0.0


def profile_of_object(outline: FloatArray, reach: Reach) -> Profile:
    """Target profile along one side of an object.

    Parameters
    ----------
    outline : (M, 2) array, mm, y up
    reach : Reach

    Raises
    ------
    NoObject
        When that side has no usable length.
    """
    closed = reachable_outline(outline, reach.radius_mm, reach.clearance_mm)
    profile = _profile(side_of(closed, reach.side, 2.0 * _window(reach)), reach, outline)
    ring = shapely.LinearRing(outline)
    shapely.prepare(ring)
    gap = shapely.distance(shapely.points(profile.points), ring)
    # A smoothed corner stands off its outline too; only where the tube passes outside is a bridge.
    body = shapely.Polygon(outline).buffer(0.0)
    shapely.prepare(body)
    outside = ~shapely.contains_xy(body, profile.points)
    bridged = outside & (gap > reach.clearance_mm + max(_BRIDGED_MM, 2.0 * reach.noise_mm))
    return replace(profile, bridged=bridged)


def profile_of_line(points: FloatArray, reach: Reach) -> Profile:
    """Target profile along an open drawn curve (N, 2).

    It is travelled from its upper end to its lower one; where both ends are level (to 1 % of the
    curve's length), as it was drawn.
    """
    drop = points[0, 1] - points[-1, 1]
    if drop < -0.01 * arc_length(points)[-1]:
        points = points[::-1]
    toward = side_sign(reach.side)
    _check_length(float(arc_length(points)[-1]), reach)
    line = reachable_line(points, reach.radius_mm, reach.clearance_mm, toward)
    length, drawn = float(arc_length(line)[-1]), float(arc_length(points)[-1])
    if length < _MOST_LOST * drawn:
        raise NoObject(
            f"on its {reach.side} a tube can follow only {length:.0f} of the {drawn:.0f} mm drawn; "
            "take the other `side` or a thinner tube"
        )
    profile = _profile(Stretch(line, 0.0, length), reach, None)
    gap = shapely.distance(shapely.points(profile.points), shapely.LineString(points))
    return replace(profile, bridged=gap > reach.clearance_mm + _BRIDGED_MM)


def _window(reach: Reach) -> float:
    """Half-width over which headings are taken, mm."""
    width = smoothing_width(reach.noise_mm, reach.spacing_mm)
    return min(max(width, LEAST_WINDOW * reach.radius_mm), reach.radius_mm)


def _profile(stretch: Stretch, reach: Reach, outline: FloatArray | None) -> Profile:
    _check_length(stretch.end - stretch.start, reach)
    whole = make_curve(stretch.points, STEP_MM, _window(reach))
    sign = side_sign(reach.side)
    curvature = sign * whole.curvature
    first, last = np.searchsorted(whole.s, [stretch.start, stretch.end - 0.5 * STEP_MM])
    last = min(last, len(whole.s) - 1)  # smoothing takes a little off a corner's length
    if outline is not None:
        side = slice(int(first), int(last) + 1)
        last = first + _above_base(whole, side, curvature, reach)
    _check_length(whole.s[last] - whole.s[first], reach)
    shares = np.array([reach.start_pct, reach.end_pct]) / 100.0
    low, high = first + np.rint(shares * (last - first)).astype(int)
    if whole.s[high] - whole.s[low] < 2.0 * reach.radius_mm:
        raise NoObject(
            f"only {whole.s[high] - whole.s[low]:.1f} mm lie between `start_pct` and `end_pct`, "
            "less than one diameter of the tube; take a longer stretch"
        )
    kept = slice(int(low), int(high) + 1)
    # Level at the top is pi on the left side and 0 on the right: count from the far side of that.
    least = 0.0 if reach.side == "left" else -np.pi
    turns = np.floor((whole.heading[low] - least) / (2.0 * np.pi))
    return Profile(
        points=whole.points[kept],
        s=whole.s[kept] - whole.s[low],
        heading=whole.heading[kept] - 2.0 * np.pi * turns,
        curvature=curvature[kept],
        bridged=np.zeros(high + 1 - low, dtype=bool),
        side=reach.side,
        outline=outline,
    )


def _check_length(length: float, reach: Reach) -> None:
    if length < 4.0 * reach.radius_mm:
        raise NoObject(
            f"the profile is {length:.1f} mm long, shorter than two diameters of the tube; "
            "check the scale, or take a thinner tube"
        )
    if length > _LONGEST_MM:
        raise NoObject(
            f"the profile is {length:.3g} mm long, more than {_LONGEST_MM:g} mm; check the scale"
        )


def _above_base(whole: Curve, side: slice, curvature: FloatArray, reach: Reach) -> int:
    """Index, counted from the side's first point, of its last point above the object's base.

    The base begins at the corner, tighter than the tube, that leads under the object (the foot of
    a bottle, the rim of a lamp cap); the side ends before it, and before the headings that the
    corner bends. An object that is round below (an egg) has no such corner: there the base is
    what faces straight down to within 45 deg.
    """
    sign = side_sign(reach.side)
    points = whole.points[side]
    # Looking ahead by the tube's radius steps over grooves of the underside.
    ahead = np.minimum(np.arange(len(points)) + round(reach.radius_mm / STEP_MM), len(points) - 1)
    across, drop = (points[ahead] - points).T
    undercut = _last_run(sign * across >= _UNDERCUT * np.hypot(across, drop))
    tight = curvature[side] > 1.0 / reach.radius_mm
    corners = np.flatnonzero(tight[undercut:])
    if corners.size == 0:
        return _last_run(sign * np.cos(whole.heading[side]) > _STRAIGHT_DOWN)
    gentle = np.flatnonzero(~tight[: undercut + int(corners[0])])
    before = int(gentle[-1]) if gentle.size else 0
    return max(before - round(_window(reach) / STEP_MM), 0)


def _last_run(where: NDArray[np.bool_]) -> int:
    """Index at which the run of True at the end begins (the last index where there is none)."""
    return min(len(where) - int(np.argmin(where[::-1])), len(where) - 1) if not where.all() else 0
