"""The expected square of what a build's errors move the tube, for the choice of joints.

Threads and cuts of a joint are off by themselves: the angle that they cost moves all of the tube
behind the joint, by its lever. Rubber, wall and pressure are one direction, which setting the
pressure on the finished actuator takes out; how well it can be set remains. So may all sectors be
off together: how far the wall between two threads is held is a convention of the model.

Glossary
--------
n, M, q : number of joints, of the profile's points, of free numbers
lever : normal motion of a point per angle of a joint before it
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from profiletool.bending.model import Model
from profiletool.joints.closest import ClosestPoints
from profiletool.joints.correction.parameters import Parameters, PosedChain
from profiletool.profile.curve import points_at
from profiletool.records.built import BuildErrors
from profiletool.records.frames import Shape
from profiletool.records.request import TubeSpec
from profiletool.records.units import BAR_PER_MPA, FloatArray

# Of the square that errors cost, against that of the nominal distance: a shape that is off for
# certain is worse than one that may be.
BUILT_WEIGHT = 1.0 / 36.0
# More of it where a choice is polished, for there is much that the shape alone leaves open.
POLISHED_WEIGHT = 1.0 / 9.0
_ALPHA_STEP, _OPENF_STEP, _PRESSURE_STEP = 1e-3, 1e-2, 1e-4  # of differences: rad, mm, MPa
_LEAST = 1e-9  # keeps roots smooth where nothing is off


@dataclass(frozen=True)
class ErrorSizes:
    """Standard deviations of what remains after the pressure is set: rad, mm, MPa."""

    alpha: float
    openF: float
    pressure: float


def error_sizes(build: BuildErrors, spec: TubeSpec) -> ErrorSizes | None:
    """Give the errors that count in the choice of joints; None where nothing is ever off."""
    sizes = ErrorSizes(
        build.sigma("thread") * spec.thread_rad,
        build.sigma("cut"),
        build.sigma("pressure") / BAR_PER_MPA,
    )
    return sizes if any(vars(sizes).values()) else None


@dataclass(frozen=True)
class Slopes:
    """Derivatives of joints' angles: by alpha, by openF (rad/mm) and by the pressure (rad/MPa)."""

    alpha: FloatArray
    openF: FloatArray
    pressure: FloatArray


def slopes_of(model: Model, openF: ArrayLike, alpha: ArrayLike, pressure: ArrayLike) -> Slopes:
    """Differentiate a model's angles, within its ranges; arguments broadcast."""
    steps = (_OPENF_STEP, _ALPHA_STEP, _PRESSURE_STEP)
    ranges = (model.openF, model.alpha, model.pressure)
    given = zip((openF, alpha, pressure), ranges, strict=True)
    numbers = np.broadcast_arrays(*(np.clip(value, *bounds) for value, bounds in given))
    ends, widths = [], []
    for k, (step, bounds) in enumerate(zip(steps, ranges, strict=True)):
        low, high = (np.clip(numbers[k] + s, *bounds) for s in (-step, step))
        widths.append(high - low)
        ends += [[*numbers[:k], end, *numbers[k + 1 :]] for end in (low, high)]
    # One call for all: a model's own overhead is larger than its arithmetic.
    theta = model.theta(*np.moveaxis(np.array(ends), 1, 0))
    by_openF, by_alpha, by_pressure = (
        (theta[2 * k + 1] - theta[2 * k]) / width for k, width in enumerate(widths)
    )
    return Slopes(by_alpha, by_openF, by_pressure)


def angle_variance(slopes: Slopes, sizes: ErrorSizes) -> FloatArray:
    """Variance of joints' angles by their own threads and cuts, rad²."""
    return np.asarray((sizes.alpha * slopes.alpha) ** 2 + (sizes.openF * slopes.openF) ** 2)


def levers(posed: PosedChain, shape: Shape, closest: ClosestPoints) -> FloatArray:
    """Levers of all joints at the closest points to the profile's: (n, M) mm per rad.

    Parameters
    ----------
    posed : PosedChain
    shape : Shape
        Of the chain, bent.
    closest : ClosestPoints
        Of its object-facing line.
    """
    centre = posed.chain.centre
    pivot = points_at(centre, shape.along, shape.facing)
    place = closest.at(shape.along[:, None])[:, 0]
    arm = closest.at(shape.facing) - pivot[:, None]
    turned = closest.normal[:, 1] * arm[..., 0] - closest.normal[:, 0] * arm[..., 1]
    return np.asarray(np.where(place > centre[:, None], turned, 0.0))


@dataclass(frozen=True)
class ExpectedRows:
    """Residuals whose squares add to what errors cost, mm², and their derivatives.

    Attributes
    ----------
    values : (n + 2,) mm
        Of each joint's own errors; then of the pressure, and of all sectors together.
    jacobian : (n + 2, q)
        The levers held.
    """

    values: FloatArray
    jacobian: FloatArray

    def moved(self, change: FloatArray) -> FloatArray:
        """Give the values after changes of the numbers, (..., q), to first order: (..., n + 2)."""
        return np.asarray(self.values + change @ self.jacobian.T)

    def scaled(self, factor: float) -> ExpectedRows:
        """Rows by a factor."""
        return ExpectedRows(factor * self.values, factor * self.jacobian)

    @property
    def cost(self) -> float:
        """Sum of the squares, mm²."""
        return float(self.values @ self.values)


@dataclass(frozen=True)
class Aim:
    """How deep the tube may lie in the object, mm, and what its errors cost, if anything."""

    interference_mm: float
    expected: Expected | None = None


@dataclass(frozen=True)
class Expected:
    """What errors of a build cost an actuator near the one that is bent.

    Attributes
    ----------
    model : Model
    sizes : ErrorSizes
    weight : float
        Of the squares in the rows.
    """

    model: Model
    sizes: ErrorSizes
    weight: float = BUILT_WEIGHT

    def rms_mm(self, posed: PosedChain, shape: Shape, closest: ClosestPoints) -> float:
        """Give how far errors and the convention move the line, RMS, mm, without any weight."""
        arms = levers(posed, shape, closest)
        own, common = self._joints(posed, posed.chain.alpha, posed.pressure)
        together = np.sum(np.mean((common @ arms) ** 2, axis=1))
        return float(np.sqrt(own**2 @ np.mean(arms**2, axis=1) + together))

    def trimmed_mm(self, posed: PosedChain, shape: Shape, closest: ClosestPoints) -> float:
        """Give how far a build's errors move the line once the pressure is set on it, RMS, mm.

        As `profiletool.verify.built` has it by finite elements: what each joint's own errors move
        along the pressure's direction is taken out, and how well the pressure is set remains.
        """
        chain, arms = posed.chain, levers(posed, shape, closest)
        slopes = slopes_of(self.model, chain.openF, chain.alpha, posed.pressure)
        swing = (chain.sense * slopes.pressure) @ arms
        along = arms @ swing / max(float(swing @ swing), _LEAST**2)
        left = np.mean((arms - np.outer(along, swing)) ** 2, axis=1)
        own = angle_variance(slopes, self.sizes) @ left
        return float(np.sqrt(own + self.sizes.pressure**2 * np.mean(swing**2)))

    def rows(
        self, parameters: Parameters, vector: FloatArray, shape: Shape, closest: ClosestPoints
    ) -> ExpectedRows:
        """Give the rows at a vector, (q,), whose shape is bent already."""
        posed, n = parameters.unpack(vector), parameters.joints
        arms, alpha, P = levers(posed, shape, closest), posed.chain.alpha, posed.pressure
        a, p = _ALPHA_STEP, _PRESSURE_STEP
        alphas = np.clip([alpha, alpha + a, alpha - a, alpha, alpha], *self.model.alpha)
        pressures = np.clip([P, P, P, P + p, P - p], *self.model.pressure)
        own, common = self._joints(posed, alphas, pressures[:, None])
        da, dP = alphas[1] - alphas[2], pressures[3] - pressures[4]
        lever = np.sqrt(np.mean(arms**2, axis=1))
        swing = common[:, 0] @ arms
        moved = np.maximum(np.sqrt(np.mean(swing**2, axis=1)), _LEAST)
        # Of the root of a mean square, by the angle of each joint.
        by_angle = swing @ arms.T / (arms.shape[1] * moved[:, None])
        jacobian = np.zeros((n + len(moved), len(vector)))
        jacobian[np.arange(n), np.arange(n)] = lever * (own[1] - own[2]) / da
        jacobian[n:, :n] = by_angle * (common[:, 1] - common[:, 2]) / da
        jacobian[:n, 2 * n] = lever * (own[3] - own[4]) / dP
        jacobian[n:, 2 * n] = np.sum(by_angle * (common[:, 3] - common[:, 4]), axis=1) / dP
        rows = ExpectedRows(np.concatenate([lever * own[0], moved]), jacobian)
        return rows.scaled(float(np.sqrt(self.weight)))

    def _joints(
        self, posed: PosedChain, alpha: FloatArray, pressure: FloatArray | float
    ) -> tuple[FloatArray, FloatArray]:
        """Give the angles' standard deviations, rad, (..., n), and what is common, (2, ..., n)."""
        slopes = slopes_of(self.model, posed.chain.openF, alpha, pressure)
        own = np.sqrt(angle_variance(slopes, self.sizes) + _LEAST**2)
        common = [self.sizes.pressure * slopes.pressure, self.sizes.alpha * slopes.alpha]
        return own, posed.chain.sense * np.array(common)
