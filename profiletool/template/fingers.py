"""Fingers around a palm: their number and places, by the clearances between them.

Glossary
--------
r : distance from the axis along a finger, outward, as in `profiletool.template.palm`
mid-plane : the upright plane that parts two neighbouring fingers
"""

from __future__ import annotations

import numpy as np
import shapely

from profiletool.profile.symmetry import Symmetry
from profiletool.records.design import Design
from profiletool.records.frames import Pose, base_axes, direction
from profiletool.records.profile import Profile
from profiletool.records.units import FloatArray
from profiletool.template.labels import short
from profiletool.template.palm import ASIDE_MM, EDGE_MM, HOLE_MM, ClampedTube, Palm

WASHER_MM = 7.0  # of an M3 screw: closer than this two of them cannot be tightened
BETWEEN_MM = 1.0  # from tube to tube
ROUND_OBJECT_MM = 1.0  # around an object that reaches through the palm
FITTING_MM = 20.0  # an air fitting with the start of its hose, behind the open end
_LEVEL = 0.01  # a tube closer to level than this (0.6 deg) never meets the palm
_SAME_MM = 1e-6
_TOUCHES_MM = 0.5  # a tube is so soft
_LEFT_DIAMETERS = 2.0  # of profile that a finger must be left
_SLIDES_SHARE = 0.3  # of the root, by which the base lies back of the start at most
_STEEP = 0.5  # a palm whose normal is farther from upright (60 deg) is not placed by the axis


def clamped(pose: Pose, design: Design, side: float) -> ClampedTube:
    """Return what is held of a design's tube whose object-facing line starts in ``pose``.

    ``side`` is +1 where the finger reaches to the right, else -1.
    """
    length, heading = design.clamp.length_mm, float(np.radians(pose.heading_deg))
    along, outward = base_axes(heading, -side)
    edge = np.array([pose.x_mm, pose.y_mm])
    diameter = design.tube.outer_diameter_mm
    return ClampedTube(edge - length * along, along, outward, length, diameter, side)


def palm_of(clamp: ClampedTube, outline: FloatArray | None, symmetry: Symmetry | None) -> Palm:
    """Lay out the palm: three fingers around a body of revolution, or two, else one.

    Parameters
    ----------
    clamp : ClampedTube
    outline : (N, 2) array, mm, or None
        The object, closed, where there is one.
    symmetry : Symmetry or None
        Of the outline.
    """
    if outline is None or symmetry is None or not symmetry.of_revolution:
        return _single(clamp, None)
    axis = symmetry.axis_x_mm
    for fingers in (3, 2):
        if not obstacle(clamp, axis, fingers, outline):
            return _around(clamp, axis, fingers, outline)
    return _single(clamp, axis)


def clear_radius(fingers: int, half_width: float, between: float) -> float:
    """Return the r from which strips around an axis leave ``between`` each other, mm.

    A point at r and ``half_width`` aside lies r sin(a) - half_width cos(a) before the mid-plane,
    a being half the angle from finger to finger.
    """
    a = np.pi / fingers
    return float((between / 2 + half_width * np.cos(a)) / np.sin(a))


def obstacle(clamp: ClampedTube, axis: float, fingers: int, outline: FloatArray) -> str:
    """Return what keeps so many fingers from sharing a palm; nothing where they can."""
    (inner, outer), clear = _span(clamp, axis), _clear(clamp, fingers)
    if inner < clear - _SAME_MM:
        where = (
            f"{short(inner)} mm from the object's axis"
            if inner >= 0.0
            else f"{short(-inner)} mm beyond the object's axis"
        )
        return f"their tubes would meet: they begin {where}, and need {short(clear)} mm before it"
    if in_object(clamp, outline):
        return "they would be held inside the object"
    palm = _around(clamp, axis, fingers, outline)
    if palm.saddle_mm > outer - WASHER_MM / 2:
        return "their screws would meet"
    if palm.opening_mm + EDGE_MM > np.hypot(palm.saddle_mm, palm.aside_mm) - HOLE_MM / 2:
        return "the object is too wide above them to reach through between their screws"
    return ""


def in_object(clamp: ClampedTube, outline: FloatArray) -> bool:
    """Tell whether the object is where the tube is to be held."""
    held = shapely.Polygon(clamp.ring).buffer(-_TOUCHES_MM)
    return bool(held.intersects(shapely.Polygon(outline).buffer(0.0)))


def start_for(
    fingers: int, design: Design, profile: Profile, axis: float, stretch_pct: tuple[float, float]
) -> int | None:
    """Return where on the side so many fingers could start to share a palm.

    Parameters
    ----------
    fingers : int
    design : Design
        Its tube and clamp.
    profile : Profile
        With an outline.
    axis : float
        x of the object's axis, mm.
    stretch_pct : (float, float)
        Where on the side the profile starts and ends, %.

    Returns
    -------
    int or None
        The least start below that of the profile, %; None where there is none.
    """
    assert profile.outline is not None
    low, high = stretch_pct
    longest = profile.length_mm - _LEFT_DIAMETERS * design.tube.outer_diameter_mm
    for pct in range(int(np.floor(low)) + 1, int(np.ceil(high))):
        # Half a percent to both sides fits too: a start is found anew for every stretch.
        places = (pct + np.array([-0.5, 0.0, 0.5]) - low) / (high - low) * profile.length_mm
        if places[-1] > longest:
            return None
        # Where joint 1 is wanted before the root allows it, the base lies back of the start.
        poses = (
            _pose_at(profile, s, back)
            for s in places.tolist()
            for back in (0.0, _SLIDES_SHARE * design.tube.root_mm)
        )
        tubes = (clamped(pose, design, -profile.sign) for pose in poses)
        if not any(obstacle(tube, axis, fingers, profile.outline) for tube in tubes):
            return pct
    return None


def _pose_at(profile: Profile, s: float, back: float) -> Pose:
    k = min(int(np.searchsorted(profile.s, s)), len(profile.s) - 1)
    heading = float(profile.heading[k])
    x, y = (profile.points[k] - back * direction(heading)).tolist()
    return Pose(x, y, float(np.degrees(heading)))


def _clear(clamp: ClampedTube, fingers: int) -> float:
    """Return the least r of tubes that leave each other room."""
    return clear_radius(fingers, clamp.diameter_mm / 2, BETWEEN_MM)


def _least_saddle(clamp: ClampedTube, fingers: int) -> float:
    """Return the least r of screws that do not meet those of the next finger."""
    return clear_radius(fingers, clamp.diameter_mm / 2 + ASIDE_MM, WASHER_MM)


def _span(clamp: ClampedTube, axis: float) -> tuple[float, float]:
    """Return the least and the largest r of a clamp as seen from above."""
    r = clamp.side * (clamp.ring[:, 0] - axis)
    return float(r.min()), float(r.max())


def _around(clamp: ClampedTube, axis: float, fingers: int, outline: FloatArray) -> Palm:
    inner, outer = _span(clamp, axis)
    level = float(clamp.ring[:, 1].max())
    first = 180.0 if clamp.side < 0 else 0.0
    fitting, meet = _fittings(clamp, axis, level)
    return Palm(
        origin=np.array([axis, level]),
        along=np.array([clamp.side, 0.0]),
        normal=np.array([0.0, 1.0]),
        on_axis=True,
        turns_deg=tuple((first + k * 360.0 / fingers) % 360.0 for k in range(fingers)),
        span_mm=(inner, outer),
        diameter_mm=clamp.diameter_mm,
        saddle_mm=max((inner + outer) / 2, _least_saddle(clamp, fingers)),
        base_mm=float(clamp.side * (clamp.edge[0] - axis)),
        fitting_mm=fitting,
        fittings_meet=meet,
        opening_mm=_opening(outline, axis, level),
    )


def _single(clamp: ClampedTube, axis: float | None) -> Palm:
    end = clamp.at(0.0, clamp.diameter_mm)
    on_axis = axis is not None and bool(abs(clamp.along[0]) > _STEEP)
    r = float((end[0] - axis) / clamp.along[0]) if on_axis and axis is not None else 0.0
    return Palm(
        origin=end - r * clamp.along,
        along=clamp.along,
        normal=clamp.outward,
        on_axis=on_axis,
        turns_deg=(180.0 if clamp.side < 0 else 0.0,),
        span_mm=(r, r + clamp.length_mm),
        diameter_mm=clamp.diameter_mm,
        saddle_mm=r + clamp.length_mm / 2,
        base_mm=r + clamp.length_mm,
    )


def _fittings(clamp: ClampedTube, axis: float, level: float) -> tuple[float | None, bool]:
    """Return the r at which air fittings meet the palm, if they do, or that they meet each other.

    They stick out straight behind the open ends. Nearer to the axis than half a tube there is
    no room for those of all fingers.
    """
    x, y = clamp.at(0.0, clamp.diameter_mm / 2).tolist()
    down, out = -float(clamp.along[1]), float(clamp.side * clamp.along[0])
    rise = (level - y) / down if down > _LEVEL else np.inf
    r = clamp.side * (x - axis) - min(rise, FITTING_MM) * out
    if r < clamp.diameter_mm / 2:
        return None, True
    return (float(r), False) if rise <= FITTING_MM else (None, False)


def _opening(outline: FloatArray, axis: float, level: float) -> float:
    """Return the radius that lets through what of the object stands higher than ``level``."""
    body = shapely.Polygon(outline).buffer(0.0)
    x0, _, x1, y1 = body.bounds
    above = body.intersection(shapely.box(x0, level, x1, max(level, y1)))
    if above.area == 0.0:
        return 0.0
    low, _, high, _ = above.bounds
    return float(max(axis - low, high - axis)) + ROUND_OBJECT_MM
