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

_DAMPINGS = 4


@dataclass(frozen=True)
class Correction:
    """What became of a predicted state.

    Attributes
    ----------
    outcome : {"converged", "residual", "inverted"}
    pose : Pose
    pressure : float, MPa
    forces : Forces
    inverse : Inverse or None
        The last factored tangent, at the state before the last steps.
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


def correct(
    system: System,
    chart: Chart,
    pose: Pose,
    pressure: float,
    tolerance: float,
    volume: float | None = None,
    most: int = 10,
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
    most : int
        Factorisations after which it gives up.
    """
    first = np.inf
    iterations = 0
    for factored in range(1, most + 1):
        forces, inverse = system.factor(pose.x, pressure)
        if inverse is None:
            return Correction(
                "inverted", pose, pressure, forces, None, first, np.inf, factored, iterations
            )
        residual = relative_residual(forces, pressure, volume)
        if factored == 1:
            first = residual
            if not np.isfinite(first):
                break
        if residual <= tolerance:
            return Correction(
                "converged", pose, pressure, forces, inverse, first, residual, factored, iterations
            )
        moved = _step(system, chart, pose, pressure, forces, inverse, volume)
        if moved is None:
            return Correction(
                "inverted", pose, pressure, forces, inverse, first, residual, factored, iterations
            )
        pose, pressure, forces = moved
        iterations += 1
        residual = relative_residual(forces, pressure, volume)
        if residual <= tolerance:
            return Correction(
                "converged", pose, pressure, forces, inverse, first, residual, factored, iterations
            )
        if not residual < 1e6 * max(first, 1.0):
            break
    return Correction(
        "residual", pose, pressure, forces, inverse, first, residual, factored, iterations
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
) -> tuple[Pose, float, Forces] | None:
    """Take one step, shortened where a brick would turn inside out."""
    threads = Switching(system, inverse, pose.x)
    du = threads.solve(-forces.residual(pressure))
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
