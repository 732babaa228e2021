"""Objects that lie or lean: by how much to turn an outline until its axis stands upright."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from scipy.optimize import minimize
from shapely import affinity

from profiletool.profile.symmetry import body_of, mismatch_of
from profiletool.records.units import FloatArray

_STEPS_DEG = np.arange(-90.0, 90.0, 5.0)
_MOST = 4  # valleys that are looked into
_NEAR = 0.1  # of mismatch: what the coarse steps may miss of a valley's depth
_AS_GOOD = 0.02  # of mismatch: between such axes mirroring does not decide
_LONG = 1.15  # length over width, from which on an object of several axes stands on its end
_LYING_DEG = 60.0  # from here on, which end was up in the picture says nothing
_FINE_DEG = 0.02
_ASKEW = 0.15  # of mismatch: cameras are held level; against the diagonal of a mug and its handle


@dataclass(frozen=True)
class Upright:
    """How an outline is turned upright.

    Attributes
    ----------
    turn_deg : float
        Counter-clockwise, above -180 to 180.
    mismatch : float
        What the outline and its mirror image about the axis do not share (see `Symmetry`).
    """

    turn_deg: float
    mismatch: float


def upright_of(outline: FloatArray) -> Upright:
    """Find the turn that brings the axis of an outline upright.

    The axis is the one about which the outline mirrors itself best, one that lies level or
    upright in the picture sooner than a diagonal one; of several, as a can has them, the long
    one, or where none is longer, the nearest. What leaned keeps its top up; what lay, more than
    60 degrees off, comes to stand on its heavier end.

    Parameters
    ----------
    outline : (N, 2) array, mm or px, y up, closed, first point not repeated

    Raises
    ------
    ValueError
        The outline encloses no area.
    """
    body = body_of(outline)
    coarse = np.array([_mismatch(body, turn, 0.0) for turn in _STEPS_DEG])
    valleys = np.flatnonzero((coarse <= np.roll(coarse, 1)) & (coarse <= np.roll(coarse, -1)))
    valleys = valleys[coarse[valleys] <= coarse.min() + _NEAR]
    valleys = valleys[np.argsort(coarse[valleys], kind="stable")][:_MOST]
    found = [_refined(body, float(_STEPS_DEG[k])) for k in valleys]
    marks = [one.mismatch + _ASKEW * _askew(one.turn_deg) for one in found]
    good = [one for one, mark in zip(found, marks, strict=True) if mark <= min(marks) + _AS_GOOD]
    longest = max(good, key=lambda one: _slenderness(outline, one.turn_deg))
    if _slenderness(outline, longest.turn_deg) < _LONG:
        longest = min(good, key=lambda one: abs(one.turn_deg))
    return Upright(_heavy_end_down(outline, longest.turn_deg), longest.mismatch)


def turned(points: FloatArray, turn_deg: float) -> FloatArray:
    """Turn points (..., 2), y up, counter-clockwise about the origin; quarter turns are exact."""
    angle = np.radians(turn_deg)
    c, s = float(np.round(np.cos(angle), 15)), float(np.round(np.sin(angle), 15))
    return np.asarray(points @ np.array([[c, s], [-s, c]]))


def y_up(px: FloatArray) -> FloatArray:
    """Bring points (..., 2) from the picture frame, y down, to one with y up, or back."""
    return px * [1.0, -1.0]


def turned_px(px: FloatArray, turn_deg: float, middle: FloatArray) -> FloatArray:
    """Turn points (..., 2) of a picture about its middle, counter-clockwise as seen."""
    return y_up(turned(y_up(px - middle), turn_deg)) + middle


def _mismatch(body: shapely.Geometry, turn_deg: float, aside: float) -> float:
    """Compare with the mirror image about the axis that a turn brings upright.

    The axis passes the centre of area at a distance ``aside``.
    """
    tilt = np.radians(90.0 - turn_deg)  # of the axis as it is now
    c, s = np.cos(2.0 * tilt), np.sin(2.0 * tilt)
    middle = np.array([body.centroid.x, body.centroid.y])
    middle += aside * np.array([np.sin(tilt), -np.cos(tilt)])
    x, y = middle - np.array([[c, s], [s, -c]]) @ middle
    return mismatch_of(body, affinity.affine_transform(body, (c, s, s, -c, x, y)))


def _refined(body: shapely.Geometry, turn_deg: float) -> Upright:
    size = float(np.sqrt(body.area))
    step = float(np.ptp(_STEPS_DEG[:2]))

    def off(values: FloatArray) -> float:
        return _mismatch(body, turn_deg + step * values[0], 0.1 * size * values[1])

    start = np.array([[0.0, 0.0], [0.4, 0.0], [0.0, 0.2]])
    found = minimize(
        off, start[0], method="Nelder-Mead",
        options={"initial_simplex": start, "xatol": _FINE_DEG / step, "fatol": 1e-5},
    )  # fmt: skip
    return Upright(float(turn_deg + step * found.x[0]), float(found.fun))


def _askew(turn_deg: float) -> float:
    """How far an axis is from level and upright: 0 to 1."""
    off = abs(turn_deg) % 90.0
    return min(off, 90.0 - off) / 45.0


def _slenderness(outline: FloatArray, turn_deg: float) -> float:
    width, height = np.ptp(turned(outline, turn_deg), axis=0)
    return float(height / width)


def _heavy_end_down(outline: FloatArray, turn_deg: float) -> float:
    """Choose between the two ways up of what lay; what leaned stays as it is."""
    if abs(turn_deg) > _LYING_DEG:
        points = turned(outline, turn_deg)
        middle = 0.5 * (points[:, 1].min() + points[:, 1].max())
        if shapely.Polygon(points).centroid.y > middle:
            turn_deg += 180.0
    return float(turn_deg - 360.0 * np.ceil((turn_deg - 180.0) / 360.0))
