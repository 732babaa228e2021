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
from profiletool.records.frames import Shape
from profiletool.records.profile import Profile
from profiletool.records.units import FloatArray
from profiletool.template.labels import short
from profiletool.template.palm import ASIDE_MM, EDGE_MM, HOLE_MM, Clamp, Palm

WASHER_MM = 7.0  # of an M3 screw: closer than this two of them cannot be tightened
BETWEEN_MM = 1.0  # from tube to tube
# Fingers that are held shorter slip: a saddle needs this for an M3 hole with a rim on both sides.
LEAST_CLAMP_MM = 4.0
ROUND_OBJECT_MM = 1.0  # around an object that reaches through the palm
FITTING_MM = 20.0  # an air fitting with the start of its hose, behind the clamped end
_NO_GAIN = 0.01  # a tube closer to upright (0.6 deg) comes no farther from the axis
_STEEP = 0.5  # a palm whose normal is farther from upright (60 deg) is not placed by the axis


def clamp_of(design: Design, profile: Profile, straight: Shape) -> Clamp:
    """Return what is held of a tube at rest: up to the first joint's cut.

    Raises
    ------
    ValueError
        The first joint's cut leaves nothing to hold.
    """
    first = design.joints[0].openF_mm if design.joints else 0.0
    length = design.tube.root_mm - first / 2
    if not length > 0.0:
        raise ValueError("the first joint's cut leaves no root to clamp")
    along = straight.facing[-1] - straight.facing[0]
    outward = straight.far[0] - straight.facing[0]
    diameter = float(np.hypot(*outward))
    return Clamp(
        straight.facing[0],
        along / np.hypot(*along),
        outward / diameter,
        length,
        diameter,
        -profile.sign,
    )


def palm_of(clamp: Clamp, outline: FloatArray | None, symmetry: Symmetry | None) -> Palm:
    """Lay out the palm: three fingers around a body of revolution, or two, else one.

    Parameters
    ----------
    clamp : Clamp
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


def shortening(clamp: Clamp, axis: float, fingers: int) -> float:
    """Return what each tube must lose at its clamped end to clear its neighbours, mm.

    Infinite where no cut helps: what points straight down comes no farther from the axis.
    """
    inner, _ = _span(clamp, axis)
    lack = clear_radius(fingers, clamp.diameter_mm / 2, BETWEEN_MM) - inner
    gain = float(clamp.side * clamp.along[0])
    if lack <= 0.0:
        return 0.0
    # In whole tenths, as it is lettered; not one more for a rounding error.
    return float(np.ceil(10.0 * lack / gain - 1e-6)) / 10.0 if gain > _NO_GAIN else np.inf


def obstacle(clamp: Clamp, axis: float, fingers: int, outline: FloatArray) -> str:
    """Return what keeps so many fingers from sharing a palm; nothing where they can."""
    cut = shortening(clamp, axis, fingers)
    if np.isinf(cut):
        return "they stand closer than the tubes are wide"
    # A clamp that is short already is no reason to stand alone.
    if cut > 0.0 and clamp.length_mm - cut < LEAST_CLAMP_MM:
        return (
            f"each clamp of {short(clamp.length_mm)} mm would have to lose {short(cut)} mm at its "
            f"clamped end to clear the others, and keep {LEAST_CLAMP_MM:g} mm to hold by"
        )
    palm = _around(clamp, axis, fingers, outline)
    if palm.saddle_mm > palm.span_mm[1] - LEAST_CLAMP_MM / 2:
        return "their screws would meet"
    if palm.opening_mm + EDGE_MM > np.hypot(palm.saddle_mm, palm.aside_mm) - HOLE_MM / 2:
        return "the object is too wide above them to reach through between their screws"
    return ""


def _least_saddle(clamp: Clamp, fingers: int) -> float:
    """Return the least r of screws that do not meet those of the next finger."""
    return clear_radius(fingers, clamp.diameter_mm / 2 + ASIDE_MM, WASHER_MM)


def _span(clamp: Clamp, axis: float) -> tuple[float, float]:
    """Return the least and the largest r of a clamp as seen from above."""
    r = clamp.side * (clamp.ring[:, 0] - axis)
    return float(r.min()), float(r.max())


def _around(clamp: Clamp, axis: float, fingers: int, outline: FloatArray) -> Palm:
    cut = shortening(clamp, axis, fingers)
    inner, outer = _span(clamp, axis)
    inner += cut * max(float(clamp.side * clamp.along[0]), 0.0)
    level = float(clamp.ring[:, 1].max())
    first = 180.0 if clamp.side < 0 else 0.0
    fitting, meet = _fittings(clamp, axis, cut, level)
    return Palm(
        origin=np.array([axis, level]),
        along=np.array([clamp.side, 0.0]),
        normal=np.array([0.0, 1.0]),
        on_axis=True,
        turns_deg=tuple((first + k * 360.0 / fingers) % 360.0 for k in range(fingers)),
        span_mm=(inner, outer),
        diameter_mm=clamp.diameter_mm,
        saddle_mm=max((inner + outer) / 2, _least_saddle(clamp, fingers)),
        cut_off_mm=cut,
        held_mm=clamp.length_mm - cut,
        base_mm=float(clamp.side * (clamp.start[0] - axis)),
        fitting_mm=fitting,
        fittings_meet=meet,
        opening_mm=_opening(outline, axis, level),
    )


def _single(clamp: Clamp, axis: float | None) -> Palm:
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
        cut_off_mm=0.0,
        held_mm=clamp.length_mm,
        base_mm=r,
    )


def _fittings(clamp: Clamp, axis: float, cut: float, level: float) -> tuple[float | None, bool]:
    """Return the r at which air fittings meet the palm, if they do, or that they meet each other.

    They stick out straight behind the clamped ends. Nearer to the axis than half a tube there is
    no room for those of all fingers.
    """
    x, y = clamp.at(cut, clamp.diameter_mm / 2).tolist()
    down, out = -float(clamp.along[1]), float(clamp.side * clamp.along[0])
    rise = (level - y) / down if down > _NO_GAIN else np.inf
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
