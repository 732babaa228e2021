"""Finite elements in the loop: an actuator corrected until its bent shape lies on the profile.

Gauss-Newton on the numbers of `profiletool.joints.parameters`: the whole actuator's FE gives the
gaps between tube and profile and, by direct differentiation, what each number does to them. First
all numbers are free; then they take the steps that can be built, and what stays free follows.
Every state but the first is found from the one before.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fem.errors import FemError, NotConverged
from fem.sensitivity import Rate, Sensitivities, sensitivities
from fem.solve import Solution, solve, solve_near
from profiletool.joints.parameters import (
    Actuator,
    Feet,
    Parameters,
    base_axes,
    feet,
    residual_jacobian,
    target_points,
)
from profiletool.joints.steps import Linear, badness, built_step, free_step, taught
from profiletool.records import FloatArray, Material, Profile, Shape
from profiletool.verify import shape_of, tube_of

_MOST_FREE, _MOST_BUILT = 5, 5
_WORTH = 0.9  # of the badness: a free step that brings less is the last one
_REACH, _SHORTEST = 3.0, 0.1  # steps over the scale; the share of that below which it gives up
_SPARE_MM = 0.5  # how far the tube goes on beyond the profile's end


@dataclass(frozen=True)
class Steps:
    """The steps that numbers come in; 0 where they are free. rad, mm, MPa."""

    alpha: float
    place: float
    pressure: float


@dataclass(frozen=True)
class Trial:
    """An actuator with its FE state and where that lies; ``built`` where its numbers are whole."""

    parameters: Parameters
    vector: FloatArray
    solution: Solution
    shape: Shape
    feet: Feet
    built: bool

    @property
    def actuator(self) -> Actuator:
        """What the vector says."""
        return self.parameters.unpack(self.vector)


@dataclass(frozen=True)
class Refined:
    """What came of the correction.

    Attributes
    ----------
    best : Trial
    rms_mm : tuple of float
        Distance between tube and profile at every FE run, in order.
    """

    best: Trial
    rms_mm: tuple[float, ...]


def refine(
    parameters: Parameters,
    vector: FloatArray,
    profile: Profile,
    material: Material,
    steps: Steps,
    interference_mm: float,
    say: Callable[[str], None],
) -> Refined:
    """Correct an actuator by finite elements.

    Parameters
    ----------
    parameters : Parameters
    vector : (size,)
        The first guess.
    profile : Profile
    material : Material
    steps : Steps
    interference_mm : float
        How deep the tube may lie in the object.
    say : callable
        Takes one line of progress at a time.

    Raises
    ------
    fem.errors.NotConverged
        When the first guess has no stable state at its pressure.
    fem.errors.BadGeometry
    """
    loop = _Loop(profile, material, interference_mm, say)
    best = loop.first(parameters, vector)
    best = loop.free(best)
    if max(steps.alpha, steps.place, steps.pressure) > 0.0:
        best = loop.built(best, steps)
    return Refined(best, tuple(loop.rms))


class _Loop:
    """The runs of one correction."""

    def __init__(
        self,
        profile: Profile,
        material: Material,
        interference_mm: float,
        say: Callable[[str], None],
    ) -> None:
        self._profile, self._material = profile, material
        self._interference, self._say = interference_mm, say
        self._points = target_points(profile)
        self.rms: list[float] = []

    def first(self, parameters: Parameters, vector: FloatArray) -> Trial:
        at = parameters.unpack(vector)
        solution = solve(tube_of(at.chain, self._material), [at.pressure])
        if solution.critical is not None:
            ended = solution.critical
            raise NotConverged(
                f"{ended.kind} at {10.0 * ended.pressure:.2f} bar", solution.history, ended.pressure
            )
        return self._seen(parameters, vector, solution, built=False)

    def free(self, best: Trial) -> Trial:
        """Take free steps as long as they pay."""
        share, model = 1.0, None
        for _ in range(_MOST_FREE):
            if model is None:
                model = self._model(best)
            target = free_step(model, share * _REACH * model.scale)
            trial = self._tried(best, target, built=False)
            gain = np.inf if trial is None else self._worth(trial) / self._worth(best)
            if trial is not None and gain < 1.0:
                best, model = trial, None
                if gain > _WORTH:
                    break
            else:
                share *= 0.4
                if share < _SHORTEST:
                    break
        return best

    def built(self, best: Trial, steps: Steps) -> Trial:
        """Go to numbers that can be built, and on from there."""
        model, found = self._model(best), None
        tried = list[FloatArray]()
        for _ in range(_MOST_BUILT):
            step = _step_sizes(model.vector, best.parameters, steps)
            target = built_step(model, step, _REACH * model.scale)
            if any(np.allclose(target, other, atol=1e-9) for other in tried):
                break
            tried.append(target)
            trial = self._tried(best, target, built=True)
            if trial is None:
                break
            if found is None or self._worth(trial) < self._worth(found):
                best = found = trial
                model = self._model(best)
            else:
                model = taught(model, target, trial.feet.gap)
        return best if found is None else found

    def _worth(self, trial: Trial) -> float:
        return float(badness(trial.feet.gap, self._interference))

    def _tried(self, near: Trial, vector: FloatArray, *, built: bool) -> Trial | None:
        """Run FE from a state nearby, or from rest where that fails; None where both do."""
        parameters = near.parameters.with_end(_end(near))
        at = parameters.unpack(vector)
        tube = tube_of(at.chain, self._material)
        try:
            solution = solve_near(tube, near.solution, at.pressure)
        except NotConverged:
            try:
                solution = solve(tube, [at.pressure])
            except FemError:
                return None
            if solution.critical is not None:
                return None
        except FemError:
            return None
        return self._seen(parameters, vector, solution, built=built)

    def _seen(
        self, parameters: Parameters, vector: FloatArray, solution: Solution, *, built: bool
    ) -> Trial:
        pose = parameters.unpack(vector).pose
        shape = shape_of(solution.mesh, solution.states[-1], pose, parameters.sign)
        found = feet(shape.facing, self._points, parameters.sign)
        self.rms.append(float(np.sqrt(np.mean(found.gap**2))))
        kind = "in steps that can be built" if built else "all numbers free"
        self._say(
            f"finite elements, run {len(self.rms)} ({kind}): {self.rms[-1]:.2f} mm RMS, "
            f"{np.abs(found.gap).max():.2f} at most, at "
            f"{10.0 * parameters.unpack(vector).pressure:.3f} bar"
        )
        return Trial(parameters, vector, solution, shape, found, built)

    def _model(self, trial: Trial) -> Linear:
        low, high = trial.parameters.bounds()
        return Linear(
            gap=trial.feet.gap,
            jacobian=residual_jacobian(trial.feet, motion_of(trial)),
            vector=trial.vector,
            low=low,
            high=high,
            scale=trial.parameters.scale(),
            interference_mm=self._interference,
        )


def motion_of(trial: Trial) -> FloatArray:
    """Motion of the object-facing line's points by each number of the vector: (size, N, 2)."""
    parameters, shape = trial.parameters, trial.shape
    solution, at = trial.solution, trial.actuator
    rates = sensitivities(solution.mesh, solution.states[-1].x, at.pressure)
    heading = np.radians(at.pose.heading_deg)
    along, outward = base_axes(float(heading), parameters.sign)

    def placed(rate: Rate) -> FloatArray:
        z, y = (np.interp(shape.along, solution.mesh.z, rate.facing[:, k]) for k in (2, 1))
        moved: FloatArray = z[:, None] * along + y[:, None] * outward
        return moved

    n = parameters.joints
    place = float(trial.vector[2 * n - 1])
    rooted = parameters.root(place + 1e-6) > parameters.root(place)
    slide = placed(rates.wrapped[0]) if rooted else np.broadcast_to(along, shape.facing.shape)
    rows = [*_inner(rates, placed), slide, placed(rates.pressure)]
    if parameters.limits.base_free:
        arm = shape.facing - parameters.start
        rows.append(parameters.sign * np.column_stack([-arm[:, 1], arm[:, 0]]))
        rows.append(np.broadcast_to(outward, shape.facing.shape))
    return np.stack(rows)


def _inner(rates: Sensitivities, placed: Callable[[Rate], FloatArray]) -> list[FloatArray]:
    return [placed(rate) for rate in (*rates.alpha, *rates.wrapped[1:-1])]


def _step_sizes(vector: FloatArray, parameters: Parameters, steps: Steps) -> FloatArray:
    """Step of each number: the base slides freely as long as the root keeps its length."""
    n = parameters.joints
    place = float(vector[2 * n - 1])
    rooted = parameters.root(place + 1e-6) > parameters.root(place)
    sizes = [steps.alpha] * n + [steps.place] * (n - 1)
    sizes += [steps.place if rooted else 0.0, steps.pressure]
    return np.array(sizes + [0.0, 0.0] * parameters.limits.base_free)


def _end(trial: Trial) -> float:
    """Give the wrapped length at the closed end that just reaches the profile's end."""
    found, facing = trial.feet, trial.shape.facing
    first, share = int(found.first[-1]), float(found.share[-1])
    left = np.hypot(*np.diff(facing[first:], axis=0).T)
    beyond = float(left.sum() - share * left[0])
    missing = 0.0
    if first == len(facing) - 2 and share >= 1.0:
        missing = abs(float(found.gap[-1]))
    end = trial.parameters.end_mm + missing + _SPARE_MM - beyond
    return float(np.ceil(end))
