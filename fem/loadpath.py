"""The path of equilibria as the pressure rises: steps, cut-backs, limit points.

A generator of equilibria, apart from Newton's method: it predicts the next state by
extrapolation in the chart of sections, sizes the step by how far off the last prediction was,
and reaches the asked pressures exactly.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fem.assembly import Forces, System
from fem.errors import Attempt, NotConverged
from fem.newton import Correction, correct
from fem.sections import Chart, Pose

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class Options:
    """How the path is followed.

    Attributes
    ----------
    tolerance, between : float
        Residual over the pressure's forces at asked pressures, and at those in between.
    aim : float
        Residual that a prediction may have.
    first : float
        First step, in parts of the rubber's shear modulus.
    smallest : float
        Step below which it gives up, in parts of the shear modulus.
    """

    tolerance: float = 1e-6
    between: float = 1e-3
    aim: float = 0.3
    first: float = 0.01
    smallest: float = 1e-4


@dataclass(frozen=True)
class Equilibrium:
    """A state in equilibrium.

    Attributes
    ----------
    pressure : float, MPa
    pose : Pose
    forces : Forces
    residual : float
        Relative to the pressure's forces.
    asked : bool
        Whether this pressure was asked for.
    """

    pressure: float
    pose: Pose
    forces: Forces
    residual: float
    asked: bool


def follow(
    system: System,
    chart: Chart,
    pressures: Sequence[float],
    options: Options,
    history: list[Attempt],
) -> Iterator[Equilibrium]:
    """Yield equilibria from rest through the asked pressures (rising, MPa).

    ``history`` takes every attempt.

    Raises
    ------
    NotConverged
    """
    mu = system.mesh.actuator.rubber.shear_modulus
    step = options.first * mu
    known: list[tuple[float, Pose]] = []
    pressure = 0.0
    for target in pressures:
        while pressure < target:
            count = max(1, int(np.ceil((target - pressure) / step - 1e-6)))
            asked = count == 1
            trial = target if asked else pressure + (target - pressure) / count
            pose = predict(chart, known, trial)
            tolerance = options.tolerance if asked else options.between
            done = correct(system, chart, pose, trial, tolerance)
            history.append(Attempt(trial, done.iterations, done.residual, done.outcome))
            if done.outcome != "converged":
                step = 0.5 * (trial - pressure)
                if step < options.smallest * mu:
                    raise NotConverged(_say(trial, done), tuple(history), pressure)
                continue
            factor = (options.aim / max(done.first, 1e-12)) ** (1.0 / 1.5)
            step = (trial - pressure) * float(np.clip(factor, 0.3, 2.5))
            pressure = trial
            known = [*known[-2:], (pressure, done.pose)]
            yield Equilibrium(pressure, done.pose, done.forces, done.residual, asked)


def predict(chart: Chart, known: Sequence[tuple[float, Pose]], pressure: float) -> Pose:
    """Extrapolate the last states to a pressure: a polynomial through all that are given."""
    if not known:
        return chart.rest()
    last, pose = known[-1]
    if len(known) == 1:
        return chart.move(pose, chart.difference(chart.rest(), pose) * (pressure / last - 1.0))
    places = [p for p, _ in known]
    increment: FloatArray | float = 0.0
    for k, (place, other) in enumerate(known[:-1]):
        weight = np.prod([(pressure - p) / (place - p) for j, p in enumerate(places) if j != k])
        increment = increment + float(weight) * chart.difference(pose, other)
    return chart.move(pose, np.asarray(increment))


def _say(pressure: float, done: Correction) -> str:
    return f"no equilibrium found at {10.0 * pressure:.3f} bar ({done.outcome})"
