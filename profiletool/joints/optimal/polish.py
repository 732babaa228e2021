"""Polish of an actuator: least squares on all its numbers but the cuts' lengths and senses."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from profiletool.bending.model import Model
from profiletool.joints.bounds import Limits
from profiletool.joints.closest import (
    ClosestPoints,
    closest_points,
    distance_jacobian,
    target_points,
)
from profiletool.joints.correction.parameters import (
    Parameters,
    PosedChain,
    facing_motion,
    parameters_of,
)
from profiletool.joints.expected import Aim, ExpectedRows
from profiletool.joints.misfit import Deviation, depth_inside, misfit, objective_of
from profiletool.joints.optimal.descent import descend
from profiletool.records.design import Misfit
from profiletool.records.frames import Shape
from profiletool.records.profile import Profile
from profiletool.records.units import FloatArray

_SPARE_MM = 20.0  # straight end that reaches past the profile's while the rest is moved
_BOUND_SHARE = 1e-3  # of a range: so near is at the bound


@dataclass(frozen=True)
class Goal:
    """Target and limits of a polish.

    Attributes
    ----------
    profile : Profile
    points : (M, 2) mm
        Of the profile, evenly spaced.
    limits : Limits
    aim : Aim
    """

    profile: Profile
    points: FloatArray
    limits: Limits
    aim: Aim


@dataclass(frozen=True)
class Polished:
    """An actuator with the shape that the model gives it.

    ``depth`` is how deep it lies in the object at most, ``errors`` what a build's errors move it by
    (RMS), mm.
    """

    posed: PosedChain
    shape: Shape
    misfit: Misfit
    depth: float
    errors: float


def goal_of(profile: Profile, limits: Limits, aim: Aim) -> Goal:
    """Sample a profile for a polish."""
    return Goal(profile, target_points(profile), limits, aim)


def polish(posed: PosedChain, model: Model, goal: Goal, runs: int = 12) -> Polished:
    """Move alpha, wrapped lengths, pressure and base until the objective is least.

    See `profiletool.joints.misfit.objective_of`. The straight end is cut where the profile ends.

    Parameters
    ----------
    posed : PosedChain
        Where to start.
    model : Model
    goal : Goal
    runs : int
        Most evaluations of the shape and its derivatives.
    """
    profile = goal.profile
    parameters = parameters_of(posed.chain, profile, goal.limits)
    parameters = parameters.with_end(parameters.end_mm + _SPARE_MM)
    problem = _Problem(parameters, model, goal)
    vector = descend(
        problem.residuals,
        problem.jacobian,
        parameters.pack(posed),
        parameters.bounds(),
        parameters.scale(),
        runs,
    )
    best = parameters.unpack(vector)
    return judge(cut_end(best, model, goal), model, goal)


def cut_end(posed: PosedChain, model: Model, goal: Goal) -> PosedChain:
    """End the tube where the profile ends, as far as the limits allow."""
    chain, limits, sign = posed.chain, goal.limits, goal.profile.sign
    edge = float(chain.centre[-1] + 0.5 * chain.openF[-1])
    longest = max(chain.length, edge + limits.end_mm + _SPARE_MM)
    long = replace(chain, length=longest)
    shape = model.shape(long, posed.pressure, posed.pose, sign)
    # Of the straight end only: the profile may come near the tube elsewhere.
    tip, before = shape.facing[-1], shape.facing[-2]
    along = (tip - before) / np.hypot(*(tip - before))
    reached = longest + float((goal.points[-1] - tip) @ along)
    length: float = max(min(reached, limits.max_length_mm), edge + limits.end_mm)
    return replace(posed, chain=replace(chain, length=length))


def judge(posed: PosedChain, model: Model, goal: Goal) -> Polished:
    """Bend an actuator and measure it against the profile."""
    shape = model.shape(posed.chain, posed.pressure, posed.pose, goal.profile.sign)
    fit = misfit(shape, goal.profile)
    errors = 0.0
    if goal.aim.expected is not None:
        closest = closest_points(shape.facing, goal.points, goal.profile.sign)
        errors = goal.aim.expected.rms_mm(posed, shape, closest)
    return Polished(posed, shape, fit, depth_inside(shape, goal.profile), errors)


def at_bound(posed: PosedChain, limits: Limits) -> FloatArray:
    """Signs of the bounds that alpha ends at: -1 the least, +1 the largest, 0 none; (n,)."""
    low, high = limits.alpha
    near = _BOUND_SHARE * (high - low)
    alpha = posed.chain.alpha
    return np.where(alpha >= high - near, 1.0, 0.0) - np.where(alpha <= low + near, 1.0, 0.0)


class _Problem:
    """Residuals and Jacobian, both from the last shape."""

    def __init__(self, parameters: Parameters, model: Model, goal: Goal) -> None:
        self._parameters, self._model, self._goal = parameters, model, goal
        self._objective = objective_of(goal.aim.interference_mm, goal.limits.max_length_mm)
        self._last: tuple[FloatArray, Shape, ClosestPoints] | None = None

    def residuals(self, vector: FloatArray) -> FloatArray:
        _, closest = self._bent(vector)
        at = Deviation(closest.distance, length=self._least_length(vector))
        residuals = self._objective.residuals(at)
        errors = self._errors(vector)
        return residuals if errors is None else np.append(residuals, errors.values)

    def jacobian(self, vector: FloatArray) -> FloatArray:
        shape, closest = self._bent(vector)
        motion = facing_motion(self._parameters, self._model, vector, shape)
        n = self._parameters.joints
        longer = np.zeros(len(vector))
        longer[n : 2 * n - 1] = 1.0  # by the wrapped lengths
        at = Deviation(
            closest.distance,
            distance_jacobian(closest, motion),
            self._least_length(vector),
            longer,
        )
        jacobian = self._objective.jacobian(at)
        errors = self._errors(vector)
        return jacobian if errors is None else np.vstack([jacobian, errors.jacobian])

    def _errors(self, vector: FloatArray) -> ExpectedRows | None:
        """Rows of the errors, weighed as all of the points together."""
        expected = self._goal.aim.expected
        if expected is None:
            return None
        rows = expected.rows(self._parameters, vector, *self._bent(vector))
        return rows.scaled(np.sqrt(len(self._goal.points)))

    def _bent(self, vector: FloatArray) -> tuple[Shape, ClosestPoints]:
        if self._last is None or not np.array_equal(self._last[0], vector):
            at = self._parameters.unpack(vector)
            sign = self._parameters.sign
            shape = self._model.shape(at.chain, at.pressure, at.pose, sign)
            closest = closest_points(shape.facing, self._goal.points, sign)
            self._last = (vector.copy(), shape, closest)
        return self._last[1], self._last[2]

    def _least_length(self, vector: FloatArray) -> float:
        """Length of the tube with the shortest end."""
        chain = self._parameters.unpack(vector).chain
        return float(chain.centre[-1] + 0.5 * chain.openF[-1]) + self._goal.limits.end_mm
