"""Newton's method in the chart of sections, at a given pressure or a given enclosed volume."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from fem.arrays import FloatArray
from fem.assembly import Forces, Inverse, System
from fem.sections import Chart, Pose
from fem.slack import Switching

Outcome = Literal["converged", "residual", "inverted"]

_MOST = 10  # factorisations after which it gives up
_HOPELESS = 1e6  # so does it when the residual has grown this much
_DAMPINGS = 4
TIGHT, NEAR = 1e-4, 1e-3  # a tolerance below the one takes double precision below the other
SURE = 0.01  # of such a tolerance, after a step in single precision
_DESCENTS = 60  # factorisations
_TURN = 0.3  # rad, the most that a section turns in one step downhill
_DECREASE = 1e-4  # of the energy, over what its slope promises
_SHORTENINGS = 12


@dataclass(frozen=True)
class Correction:
    """What became of a predicted state.

    Attributes
    ----------
    outcome : {"converged", "residual", "inverted"}
        The residual stayed too large, or a brick turned inside out.
    pose : Pose
    pressure : float, MPa
    forces : Forces
    inverse : Inverse or None
        Of the last tangent; None where a brick was turned inside out.
    first, residual : float
        Residual of the predicted and of the last state, relative to the pressure's forces.
    factored, iterations : int
        Factorisations and Newton steps.
    """

    outcome: Outcome
    pose: Pose
    pressure: float
    forces: Forces
    inverse: Inverse | None
    first: float
    residual: float
    factored: int
    iterations: int

    @property
    def negative(self) -> int:
        """Negative eigenvalues of the last tangent."""
        return 0 if self.inverse is None else self.inverse.negative

    @property
    def flow(self) -> FloatArray:
        """Change of the unknowns with the pressure by the last tangent, (count,) mm/MPa."""
        g = self.forces.volume_gradient
        return np.zeros_like(g) if self.inverse is None else self.inverse.solve(g)


def correct(
    system: System,
    chart: Chart,
    pose: Pose,
    pressure: float,
    tolerance: float,
    volume: float | None = None,
) -> Correction:
    """Bring a predicted state into equilibrium.

    Parameters
    ----------
    system : System
    chart : Chart
    pose : Pose
        The predicted state.
    pressure : float
        MPa; the first guess where ``volume`` is given.
    tolerance : float
        Of the residual, relative to the pressure's forces.
    volume : float, optional
        Enclosed volume to hold, mm^3 (half of it in a half model); the pressure is then unknown.
    """
    outcome: Outcome = "residual"
    first = residual = np.inf
    factored = iterations = 0
    tight, enough = tolerance < TIGHT, tolerance
    while factored < _MOST:
        double = tight and residual < NEAR
        forces, inverse = system.factor(pose.x, pressure, double=double)
        factored += 1
        if inverse is None:
            outcome = "inverted"
            break
        residual = relative_residual(forces, pressure, volume)
        first = residual if factored == 1 else first
        if residual <= enough:
            outcome = "converged"
            break
        moved = _step(system, chart, pose, pressure, forces, inverse, volume)
        if moved is None:
            outcome = "inverted"
            break
        pose, pressure, forces = moved
        iterations += 1
        # A soft motion that a step in single precision left over hardly shows in the residual.
        enough = SURE * tolerance if tight and not double else tolerance
        residual = relative_residual(forces, pressure, volume)
        if residual <= enough:
            outcome = "converged"
            break
        if not residual < _HOPELESS * max(first, 1.0):
            break
    return Correction(
        outcome, pose, pressure, forces, inverse, first, residual, factored, iterations
    )


def descend(
    system: System, chart: Chart, pose: Pose, pressure: float, tolerance: float
) -> Correction:
    """Bring a state into a stable equilibrium by going down in the potential energy U - p V.

    Slower than `correct`, but neither a tangent that is nearly singular nor threads that switch
    lead it astray: where there is a stable equilibrium downhill, it is found.
    """
    outcome: Outcome = "residual"
    first = residual = np.inf
    factored = iterations = 0
    while factored < _DESCENTS:
        forces, inverse = system.factor(pose.x, pressure)
        factored += 1
        if inverse is None:
            outcome = "inverted"
            break
        residual = relative_residual(forces, pressure)
        first = residual if factored == 1 else first
        if residual <= tolerance and inverse.negative == 0:
            outcome = "converged"
            break
        moved = _downhill(system, chart, pose, pressure, forces, inverse)
        if moved is None:
            break
        pose = moved
        iterations += 1
    return Correction(
        outcome, pose, pressure, forces, inverse, first, residual, factored, iterations
    )


def _downhill(
    system: System, chart: Chart, pose: Pose, pressure: float, forces: Forces, inverse: Inverse
) -> Pose | None:
    """Take one step that lowers the potential energy; None where none does."""
    rhs = -forces.residual(pressure)
    if inverse.negative:
        du = inverse.solve(rhs, positive=True)
    else:
        du = Switching(system, inverse, pose.x).solve(rhs)
    increment = chart.increment(pose, system.expand(pose.x, du))
    slope = float(rhs @ du)
    energy = forces.energy - pressure * forces.volume
    share = min(1.0, _TURN / max(float(np.abs(chart.spins(increment)).max()), _TURN))
    for _ in range(_SHORTENINGS):
        moved = chart.move(pose, share * increment)
        new = system.forces(moved.x)
        # Near the bottom the change is lost in the rounding of the energy itself.
        allowed = energy - _DECREASE * share * slope + 1e-12 * abs(energy)
        if new.least_J > 0.0 and new.energy - pressure * new.volume <= allowed:
            return moved
        share *= 0.4
    return None


def relative_residual(forces: Forces, pressure: float, volume: float | None = None) -> float:
    """Unbalanced forces over the pressure's; with a volume to hold, that as well."""
    push = abs(pressure) * float(np.linalg.norm(forces.volume_gradient))
    value = float(np.linalg.norm(forces.residual(pressure))) / max(push, 1e-12)
    if volume is not None:
        value = max(value, abs(forces.volume - volume) / volume)
    return value


def _step(
    system: System,
    chart: Chart,
    pose: Pose,
    pressure: float,
    forces: Forces,
    inverse: Inverse,
    volume: float | None,
) -> tuple[Pose, float, Forces] | None:
    """Take one step, shortened where a brick would turn inside out."""
    du = Switching(system, inverse, pose.x).solve(-forces.residual(pressure))
    rise = 0.0
    if volume is not None:
        g = forces.volume_gradient
        flow = inverse.solve(g)
        rise = (volume - forces.volume - float(g @ du)) / float(g @ flow)
        du = du + rise * flow
    increment = chart.increment(pose, system.expand(pose.x, du))
    share = 1.0
    for _ in range(_DAMPINGS):
        moved = chart.move(pose, share * increment)
        new = system.forces(moved.x)
        if new.least_J > 0.0:
            return moved, pressure + share * rise, new
        share *= 0.4
    return None
