"""Newton's method in the chart of sections, at a given pressure or a given enclosed volume."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from fem.assembly import Forces, Inverse, System
from fem.sections import Chart, Pose
from fem.slack import Switching

FloatArray = NDArray[np.float64]
Outcome = Literal["converged", "residual", "inverted"]

_MOST = 10  # factorisations after which it gives up,
_PATIENT, _NEAR = 30, 1e-2  # or this many with the residual so near
_HOPELESS = 1e6  # so does it when the residual has grown this much
_DAMPINGS = 4


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
    flow : (count,) mm/MPa
        Change of the unknowns with the pressure, by the last factored tangent.
    negative : int
        Negative eigenvalues of that tangent.
    first, residual : float
        Residual of the predicted and of the last state, relative to the pressure's forces.
    factored, iterations : int
        Factorisations and Newton steps.
    """

    outcome: Outcome
    pose: Pose
    pressure: float
    forces: Forces
    flow: FloatArray
    negative: int
    first: float
    residual: float
    factored: int
    iterations: int


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
    flow, negative = np.zeros(system.unknowns.count), 0
    factored = iterations = 0
    while factored < (_PATIENT if residual < _NEAR else _MOST):
        forces, inverse = system.factor(pose.x, pressure)
        factored += 1
        if inverse is None:
            outcome = "inverted"
            break
        negative = inverse.negative
        residual = relative_residual(forces, pressure, volume)
        first = residual if factored == 1 else first
        if residual <= tolerance:
            flow = inverse.solve(forces.volume_gradient)
            outcome = "converged"
            break
        moved, flow = _step(system, chart, pose, pressure, forces, inverse, volume)
        if moved is None:
            outcome = "inverted"
            break
        pose, pressure, forces = moved
        iterations += 1
        residual = relative_residual(forces, pressure, volume)
        if residual <= tolerance:
            outcome = "converged"
            break
        if not residual < _HOPELESS * max(first, 1.0):
            break
    return Correction(
        outcome, pose, pressure, forces, flow, negative, first, residual, factored, iterations
    )


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
) -> tuple[tuple[Pose, float, Forces] | None, FloatArray]:
    """Take one step, shortened where a brick would turn inside out; give the flow too."""
    threads = Switching(system, inverse, pose.x)
    g = forces.volume_gradient
    du, flow = threads.solve(-forces.residual(pressure), g)
    rise = 0.0
    if volume is not None:
        rise = (volume - forces.volume - float(g @ du)) / float(g @ flow)
        du = du + rise * flow
    increment = chart.increment(pose, system.expand(pose.x, du))
    share = 1.0
    for _ in range(_DAMPINGS):
        moved = chart.move(pose, share * increment)
        new = system.forces(moved.x)
        if new.least_J > 0.0:
            return (moved, pressure + share * rise, new), flow
        share *= 0.4
    return None, flow
