"""Correction of an actuator until its bent shape lies on the profile, by any forward model.

Gauss-Newton on the numbers of `profiletool.joints.correction.parameters`: a forward model gives the
bent shape and what each number does to it. First all numbers are free; then they take the steps
that can be built, and what stays free follows.
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
from profiletool.joints.correction.parameters import Parameters, PosedChain
from profiletool.joints.correction.steps import Linear
from profiletool.joints.correction.surrogate import Surrogate
from profiletool.joints.expected import Aim
from profiletool.joints.misfit import Deviation, objective_of
from profiletool.records.frames import Shape
from profiletool.records.profile import Profile
from profiletool.records.units import BAR_PER_MPA, FloatArray

S = TypeVar("S")

_SHORTEST = 0.1  # share of a step's reach below which it gives up
_MOST_FREE, _MOST_BUILT = 5, 5
_WORTH = 0.2  # of the nominal cost: a step that promises less gain is not taken
_ENOUGH_MM = 0.3  # RMS of a shape whose numbers will be rounded: rounding costs as much
_AGAIN = 0.97  # of the pressure that a tube stands, where it does not stand the one tried
_BUILT = "in steps that can be built"
_SPARE_MM = 1.0  # how far the tube goes on beyond the profile's end


@dataclass(frozen=True)
class StepSizes:
    """The steps that numbers come in; 0 where they are free. rad, mm, MPa."""

    alpha: float
    place: float
    pressure: float


@dataclass(frozen=True)
class Iterate(Generic[S]):
    """A vector, the shape that it bends to, its closest points to the profile's, and a state.

    The state is the forward model's own: what it needs to bend a similar actuator from here.
    """

    parameters: Parameters
    vector: FloatArray
    shape: Shape
    closest: ClosestPoints
    state: S

    @property
    def posed(self) -> PosedChain:
        """The chain of joints of the vector."""
        return self.parameters.unpack(self.vector)


class ForwardModel(Protocol[S]):
    """A forward model: from an actuator to its bent shape, and what each number does to it."""

    def bend(self, posed: PosedChain, sign: float, near: Iterate[S] | None) -> tuple[Shape, S]:
        """Bend an actuator; ``near`` is a similar one that is bent already.

        Raises
        ------
        CannotBend
        """

    def motion(self, iterate: Iterate[S]) -> FloatArray:
        """Motion of the object-facing line's points by each number: (size, N, 2)."""


class CannotBend(Exception):
    """An actuator has no state that a forward model can find; the message says why.

    ``reached`` is the highest pressure that it was found at, MPa.
    """

    def __init__(self, message: str, reached: float) -> None:
        super().__init__(message)
        self.reached = reached


@dataclass(frozen=True)
class Corrected(Generic[S]):
    """A corrected actuator: the best iterate, and the RMS distance of every one, mm."""

    best: Iterate[S]
    rms_mm: tuple[float, ...]


def correct(
    forward: ForwardModel[S],
    model: Model,
    parameters: Parameters,
    vector: FloatArray,
    profile: Profile,
    steps: StepSizes,
    aim: Aim,
    say: Callable[[str], None],
) -> Corrected[S]:
    """Correct an actuator.

    Parameters
    ----------
    forward : ForwardModel
    model : Model
        Says how derivatives change on the way.
    parameters : Parameters
    vector : (size,)
        The first guess.
    profile : Profile
    steps : StepSizes
    aim : Aim
    say : callable
        Takes one line for every iterate.

    Raises
    ------
    CannotBend
        When the first guess cannot be bent, or nothing near it that can be built.
    """
    loop = _Loop(forward, model, profile, aim, say)
    coarse = max(steps.alpha, steps.place) > 0.0
    first = loop.iterate(parameters, vector, None, "first guess")
    best = loop.free(first, _ENOUGH_MM if coarse else 0.0)
    return Corrected(loop.built(best, steps), tuple(loop.rms))


class _Loop(Generic[S]):
    """The iterates of one correction."""

    def __init__(
        self,
        forward: ForwardModel[S],
        model: Model,
        profile: Profile,
        aim: Aim,
        say: Callable[[str], None],
    ) -> None:
        self._forward, self._model = forward, model
        self._objective, self._say = objective_of(aim.interference_mm), say
        self._expected = aim.expected
        self._points = target_points(profile)
        self.rms: list[float] = []

    def free(self, best: Iterate[S], enough_mm: float) -> Iterate[S]:
        """Take free steps as long as they pay and the shape is farther off than is enough."""
        share, surrogate = 1.0, None
        for _ in range(_MOST_FREE):
            if self._nominal(best) < enough_mm**2:
                break
            surrogate = surrogate or self._surrogate(best)
            target, promised = surrogate.free(share)
            if not self._pays(promised, best):
                break
            iterate = self._tried(best, target, "all numbers free")
            if iterate is not None and self._cost(iterate) < self._cost(best):
                best, surrogate = iterate, None
            else:
                share *= 0.4
                if share < _SHORTEST:
                    break
        return best

    def built(self, best: Iterate[S], steps: StepSizes) -> Iterate[S]:
        """Go to numbers that can be built, and on from there.

        Where one of them cannot be bent, others below the pressure that it was found at are tried.

        Raises
        ------
        CannotBend
            When none of them can be bent.
        """
        if not max(steps.alpha, steps.place, steps.pressure) > 0.0:
            return best
        surrogate, built, problem = self._surrogate(best), None, None
        tried, most = list[FloatArray](), np.inf
        for _ in range(_MOST_BUILT):
            target, promised = surrogate.built(_step_sizes(best.vector, best.parameters, steps))
            if any(np.allclose(target, other, atol=1e-9) for other in tried):
                break
            if built is not None and not self._pays(promised, built):
                break
            tried.append(target)
            try:
                iterate = self._next(best, target, _BUILT)
            except CannotBend as found:
                self._say(f"{_BUILT}: {found}")
                problem = found
                if found.reached <= surrogate.linear.low[2 * best.parameters.joints]:
                    break
                most = _AGAIN * found.reached
                surrogate = surrogate.below(most)
                continue
            if built is None or self._cost(iterate) < self._cost(built):
                best = built = iterate
                surrogate = self._surrogate(best).below(most)
            else:
                surrogate = surrogate.broyden_update(target, iterate.closest.distance)
        if built is None and problem is not None:
            raise problem
        return best if built is None else built

    def _nominal(self, iterate: Iterate[S]) -> float:
        return float(self._objective.cost(Deviation(iterate.closest.distance)))

    def _cost(self, iterate: Iterate[S]) -> float:
        """Cost of the shape, and of what a build's errors do to it, mm²."""
        nominal = self._nominal(iterate)
        if self._expected is None:
            return nominal
        rows = self._expected.rows(
            iterate.parameters, iterate.vector, iterate.shape, iterate.closest
        )
        return nominal + rows.cost

    def _pays(self, promised: float, best: Iterate[S]) -> bool:
        """Tell whether a promised cost is worth a run of the forward model."""
        return promised <= self._cost(best) - _WORTH * self._nominal(best)

    def _tried(self, near: Iterate[S], vector: FloatArray, what: str) -> Iterate[S] | None:
        try:
            return self._next(near, vector, what)
        except CannotBend as problem:
            self._say(f"{what}: {problem}")
            return None

    def _next(self, near: Iterate[S], vector: FloatArray, what: str) -> Iterate[S]:
        return self.iterate(near.parameters.with_end(_end(near)), vector, near, what)

    def iterate(
        self, parameters: Parameters, vector: FloatArray, near: Iterate[S] | None, what: str
    ) -> Iterate[S]:
        """Bend the actuator of a vector and lay it onto the profile."""
        at = parameters.unpack(vector)
        shape, state = self._forward.bend(at, parameters.sign, near)
        closest = closest_points(shape.facing, self._points, parameters.sign)
        self.rms.append(float(np.sqrt(np.mean(closest.distance**2))))
        self._say(
            f"{what}: {self.rms[-1]:.2f} mm RMS, {np.abs(closest.distance).max():.2f} at most, "
            f"at {BAR_PER_MPA * at.pressure:.3f} bar"
        )
        return Iterate(parameters, vector, shape, closest, state)

    def _surrogate(self, iterate: Iterate[S]) -> Surrogate:
        low, high = iterate.parameters.bounds()
        linear = Linear(
            distance=iterate.closest.distance,
            jacobian=distance_jacobian(iterate.closest, self._forward.motion(iterate)),
            vector=iterate.vector,
            centre=iterate.vector,
            low=low,
            high=high,
            scale=iterate.parameters.scale(),
            objective=self._objective,
        )
        parameters, points = iterate.parameters, self._points
        return Surrogate(linear, parameters, self._model, points, self._expected)


def _step_sizes(vector: FloatArray, parameters: Parameters, steps: StepSizes) -> FloatArray:
    """Step of each number: the tube slides freely as long as its root keeps its length."""
    n = parameters.joints
    sizes = [steps.alpha] * n + [steps.place] * (n - 1)
    sizes += [steps.place if parameters.root_grows(vector) else 0.0, steps.pressure]
    return np.array(sizes + [0.0, 0.0] * parameters.limits.base_free)


def _end(iterate: Iterate[S]) -> float:
    """Give the wrapped length at the closed end that just reaches the profile's end."""
    closest, facing = iterate.closest, iterate.shape.facing
    first, share = int(closest.first[-1]), float(closest.share[-1])
    left = np.hypot(*np.diff(facing[first:], axis=0).T)
    beyond = float(left.sum() - share * left[0])
    missing = 0.0
    if first == len(facing) - 2 and share >= 1.0:
        missing = abs(float(closest.distance[-1]))
    end = iterate.parameters.end_mm + missing + _SPARE_MM - beyond
    return float(np.ceil(end))
