"""The misfit between a bent tube and its profile, as an objective and as a verdict.

The objective is a list of terms (function, goal, weight) in least squares. Dynamic programming
takes its cost at every point, the polish its residuals and their Jacobian, the correction its cost
and its terms' rows. A new aim is one more `Term`: in `shape_terms` where it has a value at every
point of the profile, in `tube_terms` where it has one for the whole tube.

Glossary
--------
M : points of the profile that count;  q : numbers that are free
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
import shapely
from numpy.typing import NDArray

from profiletool.records.design import Misfit
from profiletool.records.frames import Shape, cross, direction
from profiletool.records.profile import Profile
from profiletool.records.units import BoolArray, FloatArray

Values = NDArray[np.floating[Any]]  # float32 in dynamic programming, float64 elsewhere

DEPTH_WEIGHT = 4.0  # of the square of what lies deeper in the object than it may
TOO_LONG_WEIGHT = 1.0  # of the square of a mm of tube beyond the longest, against one of distance
LENGTH_WEIGHT = 0.01**2  # and of any other: of equal shapes the shortest
LENGTH_COST_MM2 = 1e-3  # the same in dynamic programming, for a mm of tube
_DEEP_SHARE = 0.1  # of a mm of RMS: what a mm too deep costs between polished shapes
DEPTH_SLACK_MM = 0.1  # beyond the allowed depth, that nobody can see


@dataclass(frozen=True)
class Deviation:
    """A bent tube against its profile: the quantities that terms are functions of.

    A term that needs another quantity gets a field here, and its callers fill it.

    Attributes
    ----------
    distance : (..., M) mm
        Signed, of the profile's points (see `profiletool.joints.closest.ClosestPoints`).
    jacobian : (M, q), optional
        Derivatives of the distances.
    length : float, mm
        Of the tube.
    length_jacobian : (q,), optional
    """

    distance: Values
    jacobian: FloatArray | None = None
    length: float = 0.0
    length_jacobian: FloatArray | None = None

    def moved(self, change: FloatArray) -> Deviation:
        """Give the distances after a change of the numbers, (q,), to first order."""
        assert self.jacobian is not None
        return replace(self, distance=self.distance + self.jacobian @ change)


def _distance(at: Deviation) -> Values:
    return at.distance


def _distance_slope(at: Deviation) -> FloatArray:
    assert at.jacobian is not None
    return at.jacobian


def _length(at: Deviation) -> Values:
    return np.array([at.length])


def _length_slope(at: Deviation) -> FloatArray:
    assert at.length_jacobian is not None
    return at.length_jacobian[None, :]


@dataclass(frozen=True)
class Term:
    """One aim: a function shall take a goal; the square of what it misses counts by a weight.

    Attributes
    ----------
    function, slope : callable
        Values (..., R) of a `Deviation`, and their derivatives (R, q).
    goal : float
    weight : float
    counts : {"both", "below", "above"}
        On which side of the goal a value counts.
    """

    function: Callable[[Deviation], Values]
    slope: Callable[[Deviation], FloatArray]
    goal: float
    weight: float
    counts: Literal["both", "below", "above"] = "both"

    def active(self, at: Deviation) -> BoolArray:
        """Tell which values lie on the side that counts: (..., R)."""
        values = self.function(at)
        if self.counts == "both":
            return np.ones(values.shape, dtype=bool)
        return values < self.goal if self.counts == "below" else values > self.goal

    def missed(self, at: Deviation) -> Values:
        """Give what the values miss of the goal, 0 on the side that does not count: (..., R)."""
        off: Values = self.function(at) - self.goal
        if self.counts == "both":
            return off
        return np.minimum(off, 0.0) if self.counts == "below" else np.maximum(off, 0.0)

    def squares(self, at: Deviation) -> Values:
        """Give the weighted squares: (..., R)."""
        off = self.missed(at)
        return self.weight * (off * off)

    def residuals(self, at: Deviation) -> FloatArray:
        """Give residuals whose squares are `squares`: (R,)."""
        return np.asarray(np.sqrt(self.weight) * self.missed(at), dtype=float)

    def jacobian(self, at: Deviation) -> FloatArray:
        """Differentiate `residuals`: (R, q)."""
        rows = np.sqrt(self.weight) * self.slope(at)
        return np.asarray(rows if self.counts == "both" else rows * self.active(at)[:, None])

    def linear(self, at: Deviation, rows: BoolArray) -> tuple[FloatArray, FloatArray]:
        """Give Jacobian and residuals of some rows, as if the side that counts were known.

        Parameters
        ----------
        at : Deviation
        rows : (R,) bool
        """
        scale = np.sqrt(self.weight)
        off = (self.function(at) - self.goal)[rows]
        return scale * self.slope(at)[rows], np.asarray(scale * off, dtype=float)


def shape_terms(interference_mm: float) -> tuple[Term, ...]:
    """Give the aims that a bent shape is judged by, all of one value at every profile point.

    The tube shall lie on the profile, and nowhere deeper in the object than ``interference_mm``.
    """
    return (
        Term(_distance, _distance_slope, 0.0, 1.0),
        Term(_distance, _distance_slope, -interference_mm, DEPTH_WEIGHT, "below"),
    )


def tube_terms(max_length_mm: float) -> tuple[Term, ...]:
    """Give the aims for the tube itself: not too long, and of equal shapes the shortest."""
    return (
        Term(_length, _length_slope, max_length_mm, TOO_LONG_WEIGHT, "above"),
        Term(_length, _length_slope, 0.0, LENGTH_WEIGHT),
    )


@dataclass(frozen=True)
class Objective:
    """Aims in least squares.

    Attributes
    ----------
    shape : tuple of Term
        Of M values each, one at every point of the profile.
    tube : tuple of Term
        Of one value each; they count in `residuals`, not in `cost`.
    """

    shape: tuple[Term, ...]
    tube: tuple[Term, ...] = ()

    def density(self, at: Deviation) -> Values:
        """Give the shape's cost at every point, mm²: (..., M), in the distances' precision."""
        total, *others = (term.squares(at) for term in self.shape)
        for squares in others:
            total = total + squares
        return total

    def cost(self, at: Deviation) -> FloatArray:
        """Give the shape's mean cost, mm²: (...,)."""
        return np.asarray(np.mean(self.density(at), axis=-1))

    def residuals(self, at: Deviation) -> FloatArray:
        """Give the residuals of all terms, one after the other: (R,)."""
        return np.concatenate([term.residuals(at) for term in (*self.shape, *self.tube)])

    def jacobian(self, at: Deviation) -> FloatArray:
        """Differentiate `residuals`: (R, q)."""
        return np.concatenate([term.jacobian(at) for term in (*self.shape, *self.tube)])


def objective_of(interference_mm: float, max_length_mm: float | None = None) -> Objective:
    """Give the objective for a bent shape, and for the tube's length where that may be too long.

    Parameters
    ----------
    interference_mm : float
        How deep the tube may lie in the object.
    max_length_mm : float, optional
    """
    tube = () if max_length_mm is None else tube_terms(max_length_mm)
    return Objective(shape_terms(interference_mm), tube)


def misfit(shape: Shape, profile: Profile) -> Misfit:
    """Distance between the object-facing line and the target profile, both ways.

    Every point of the profile counts with its distance to the line, and every point of the line
    with its distance to the profile, but for what lies beyond the profile's ends; both ways weigh
    the same.
    """
    return misfit_to(shape, profile.points)


def misfit_to(shape: Shape, points: FloatArray) -> Misfit:
    """`misfit` to a profile of which only the points (N, 2), 0.1 mm apart, are known."""
    line, target = shapely.LineString(shape.facing), _target_line(points)
    shapely.prepare([line, target])
    to_line = shapely.distance(shapely.points(points), line)
    _, inside = _beside(shape, target)
    to_target = shapely.distance(shapely.points(shape.facing[inside]), target)
    ways = [way for way in (to_line, to_target) if len(way)]
    rms = np.sqrt(np.mean([np.mean(way**2) for way in ways]))
    return Misfit(float(rms), float(max(way.max() for way in ways)))


def depth_inside(shape: Shape, profile: Profile) -> float:
    """Largest depth of the object-facing line inside the object, mm; 0 where it stays outside."""
    target = _target_line(profile.points)
    along, inside = _beside(shape, target)
    at = np.searchsorted(profile.s, along * (profile.length_mm / target.length))
    at = np.clip(at, 0, len(profile.s) - 1)
    away = shape.facing - profile.points[at]
    inward = profile.sign * cross(direction(profile.heading[at]), away)
    return float(np.max(inward, where=inside, initial=0.0))


def score(fit: Misfit, depth_mm: float, interference_mm: float) -> float:
    """RMS and a share of what lies too deep, mm: what decides between polished shapes."""
    return fit.rms_mm + _DEEP_SHARE * max(depth_mm - interference_mm, 0.0)


def is_good(fit: Misfit, depth_mm: float, tolerance_mm: float, interference_mm: float) -> bool:
    """Whether a shape lies within a tolerance (RMS), and not too deep in the object."""
    deep = depth_mm > interference_mm + DEPTH_SLACK_MM
    return fit.rms_mm <= tolerance_mm and not deep


def _target_line(points: FloatArray) -> shapely.LineString:
    """Thin a profile for distances: at half a millimetre an arc of 10 mm is right to 0.003 mm."""
    every = np.append(np.arange(0, len(points) - 1, 5), len(points) - 1)
    return shapely.LineString(points[every])


def _beside(shape: Shape, target: shapely.LineString) -> tuple[FloatArray, BoolArray]:
    """Places (N,) along the target of the facing line's points; false where beyond either end."""
    along = np.asarray(shapely.line_locate_point(target, shapely.points(shape.facing)))
    return along, (along > 0.0) & (along < target.length)
