"""An actuator corrected until its bent shape lies on the profile, whoever bends it.

Gauss-Newton on the numbers of `profiletool.joints.correction.parameters`: a bench gives the bent
shape and what each number does to it. First all numbers are free; then they take the steps that can
be built, and what stays free follows.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, Protocol, TypeVar

import numpy as np

from profiletool.bending.model import Model
from profiletool.joints.closest import (
    ClosestPoints,
    closest_points,
    distance_jacobian,
    target_points,
)
from profiletool.joints.correction.parameters import Actuator, Parameters, facing_motion
from profiletool.joints.correction.steps import Linear
from profiletool.joints.correction.surrogate import Known
from profiletool.joints.misfit import Deviation, objective_of
from profiletool.records.frames import Shape
from profiletool.records.profile import Profile
from profiletool.records.units import BAR_PER_MPA, FloatArray

S = TypeVar("S")

_SHORTEST = 0.1  # share of a step's reach below which it gives up
_MOST_FREE, _MOST_BUILT = 5, 5
_WORTH = 0.8  # of the cost: a step that promises less is not taken
_ENOUGH_MM = 0.3  # RMS of a shape whose numbers will be rounded: rounding costs as much
_SPARE_MM = 1.0  # how far the tube goes on beyond the profile's end


@dataclass(frozen=True)
class Steps:
    """The steps that numbers come in; 0 where they are free. rad, mm, MPa."""

    alpha: float
    place: float
    pressure: float


@dataclass(frozen=True)
class Trial(Generic[S]):
    """A vector, the shape that it bends to, its closest points, and the bench's state."""

    parameters: Parameters
    vector: FloatArray
    shape: Shape
    closest: ClosestPoints
    state: S

    @property
    def actuator(self) -> Actuator:
        """What the vector says."""
        return self.parameters.unpack(self.vector)


class Bench(Protocol[S]):
    """What bends actuators."""

    def bend(self, actuator: Actuator, sign: float, near: Trial[S] | None) -> tuple[Shape, S]:
        """Bend an actuator; ``near`` is a similar one.

        Raises
        ------
        CannotBend
        """

    def motion(self, trial: Trial[S]) -> FloatArray:
        """Motion of the object-facing line's points by each number: (size, N, 2)."""


class CannotBend(Exception):
    """An actuator has no state that a bench can find; the message says why.

    ``reached`` is the highest pressure that it was found at, MPa.
    """

    def __init__(self, message: str, reached: float) -> None:
        super().__init__(message)
        self.reached = reached


class ModelBench:
    """Bends by a model."""

    def __init__(self, model: Model) -> None:
        self._model = model

    def bend(self, actuator: Actuator, sign: float, near: Trial[None] | None) -> tuple[Shape, None]:
        """Bend an actuator."""
        return self._model.shape(actuator.chain, actuator.pressure, actuator.pose, sign), None

    def motion(self, trial: Trial[None]) -> FloatArray:
        """Motion of the object-facing line's points by each number: (size, N, 2)."""
        return facing_motion(trial.parameters, self._model, trial.vector, trial.shape)


@dataclass(frozen=True)
class Corrected(Generic[S]):
    """What came of a correction: the best trial, and the RMS distance of every one, mm."""

    best: Trial[S]
    rms_mm: tuple[float, ...]


def correct(
    bench: Bench[S],
    model: Model,
    parameters: Parameters,
    vector: FloatArray,
    profile: Profile,
    steps: Steps,
    interference_mm: float,
    say: Callable[[str], None],
) -> Corrected[S]:
    """Correct an actuator.

    Parameters
    ----------
    bench : Bench
    model : Model
        Says how derivatives change on the way.
    parameters : Parameters
    vector : (size,)
        The first guess.
    profile : Profile
    steps : Steps
    interference_mm : float
        How deep the tube may lie in the object.
    say : callable
        Takes one line for every trial.

    Raises
    ------
    CannotBend
        When the first guess cannot be bent.
    """
    loop = _Loop(bench, model, profile, interference_mm, say)
    coarse = max(steps.alpha, steps.place) > 0.0
    first = loop.trial(parameters, vector, None, "first guess")
    best = loop.free(first, _ENOUGH_MM if coarse else 0.0)
    return Corrected(loop.built(best, steps), tuple(loop.rms))


class _Loop(Generic[S]):
    """The trials of one correction."""

    def __init__(
        self,
        bench: Bench[S],
        model: Model,
        profile: Profile,
        interference_mm: float,
        say: Callable[[str], None],
    ) -> None:
        self._bench, self._model = bench, model
        self._objective, self._say = objective_of(interference_mm), say
        self._points = target_points(profile)
        self.rms: list[float] = []

    def free(self, best: Trial[S], enough_mm: float) -> Trial[S]:
        """Take free steps as long as they pay and the shape is farther off than is enough."""
        share, known = 1.0, None
        for _ in range(_MOST_FREE):
            if self._cost(best) < enough_mm**2:
                break
            known = known or self._known(best)
            target, promised = known.free(share)
            if promised > _WORTH * self._cost(best):
                break
            trial = self._tried(best, target, "all numbers free")
            if trial is not None and self._cost(trial) < self._cost(best):
                best, known = trial, None
            else:
                share *= 0.4
                if share < _SHORTEST:
                    break
        return best

    def built(self, best: Trial[S], steps: Steps) -> Trial[S]:
        """Go to numbers that can be built, and on from there."""
        if not max(steps.alpha, steps.place, steps.pressure) > 0.0:
            return best
        known, found = self._known(best), None
        tried = list[FloatArray]()
        for _ in range(_MOST_BUILT):
            target, promised = known.built(_step_sizes(best.vector, best.parameters, steps))
            if any(np.allclose(target, other, atol=1e-9) for other in tried):
                break
            if found is not None and promised > _WORTH * self._cost(found):
                break
            tried.append(target)
            trial = self._tried(best, target, "in steps that can be built")
            if trial is None:
                break
            if found is None or self._cost(trial) < self._cost(found):
                best = found = trial
                known = self._known(best)
            else:
                known = known.broyden_update(target, trial.closest.distance)
        return best if found is None else found

    def _cost(self, trial: Trial[S]) -> float:
        return float(self._objective.cost(Deviation(trial.closest.distance)))

    def _tried(self, near: Trial[S], vector: FloatArray, what: str) -> Trial[S] | None:
        try:
            return self.trial(near.parameters.with_end(_end(near)), vector, near, what)
        except CannotBend as problem:
            self._say(f"{what}: {problem}")
            return None

    def trial(
        self, parameters: Parameters, vector: FloatArray, near: Trial[S] | None, what: str
    ) -> Trial[S]:
        """Bend the actuator of a vector and lay it onto the profile."""
        at = parameters.unpack(vector)
        shape, state = self._bench.bend(at, parameters.sign, near)
        closest = closest_points(shape.facing, self._points, parameters.sign)
        self.rms.append(float(np.sqrt(np.mean(closest.distance**2))))
        self._say(
            f"{what}: {self.rms[-1]:.2f} mm RMS, {np.abs(closest.distance).max():.2f} at most, "
            f"at {BAR_PER_MPA * at.pressure:.3f} bar"
        )
        return Trial(parameters, vector, shape, closest, state)

    def _known(self, trial: Trial[S]) -> Known:
        low, high = trial.parameters.bounds()
        linear = Linear(
            distance=trial.closest.distance,
            jacobian=distance_jacobian(trial.closest, self._bench.motion(trial)),
            vector=trial.vector,
            centre=trial.vector,
            low=low,
            high=high,
            scale=trial.parameters.scale(),
            objective=self._objective,
        )
        return Known(linear, trial.parameters, self._model, self._points)


def _step_sizes(vector: FloatArray, parameters: Parameters, steps: Steps) -> FloatArray:
    """Step of each number: the tube slides freely as long as its root keeps its length."""
    n = parameters.joints
    sizes = [steps.alpha] * n + [steps.place] * (n - 1)
    sizes += [steps.place if parameters.root_grows(vector) else 0.0, steps.pressure]
    return np.array(sizes + [0.0, 0.0] * parameters.limits.base_free)


def _end(trial: Trial[S]) -> float:
    """Give the wrapped length at the closed end that just reaches the profile's end."""
    closest, facing = trial.closest, trial.shape.facing
    first, share = int(closest.first[-1]), float(closest.share[-1])
    left = np.hypot(*np.diff(facing[first:], axis=0).T)
    beyond = float(left.sum() - share * left[0])
    missing = 0.0
    if first == len(facing) - 2 and share >= 1.0:
        missing = abs(float(closest.distance[-1]))
    end = trial.parameters.end_mm + missing + _SPARE_MM - beyond
    return float(np.ceil(end))
