"""States in equilibrium, and what a few of them in a row tell about the path."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from fem.arrays import FloatArray
from fem.assembly import Forces
from fem.sections import Pose


@dataclass(frozen=True)
class Equilibrium:
    """A state in equilibrium.

    Attributes
    ----------
    pressure : float, MPa
    pose : Pose
    forces : Forces
    compliance : float
        dV/dp, mm^3/MPa; negative past a limit point. At the first states and by volume, else NaN.
    residual : float
        Relative to the pressure's forces.
    asked : bool
        Whether this state shall be reported.
    negative : int
        Negative eigenvalues of the tangent; 0 where the state is stable under pressure.
    """

    pressure: float
    pose: Pose
    forces: Forces
    compliance: float
    residual: float
    asked: bool
    negative: int


@dataclass(frozen=True)
class Critical:
    """Where the path loses its stability under pressure.

    Attributes
    ----------
    kind : {"limit point", "bifurcation", "no equilibrium"}
        Beyond a limit point there is no equilibrium nearby at a higher pressure: the tube
        balloons. At a bifurcation it buckles into another shape. The last is said only ahead of
        the asked pressures: none was found beyond this one, and no reason is known.
    pressure : float, MPa
    """

    kind: Literal["limit point", "bifurcation", "no equilibrium"]
    pressure: float


def potential(forces: Forces, pressure: float) -> float:
    """Potential energy U - p V, N mm."""
    return forces.energy - pressure * forces.volume


def lagrange(places: FloatArray, at: float) -> FloatArray:
    """Weights of the polynomial through values at ``places`` (n,), taken at ``at``: (n,)."""
    apart = places[:, None] - places
    np.fill_diagonal(apart, 1.0)
    ahead = np.broadcast_to(at - places, apart.shape).copy()
    np.fill_diagonal(ahead, 1.0)
    weights: FloatArray = (ahead / apart).prod(axis=1)
    return weights


def spread(states: Sequence[Equilibrium]) -> float:
    """How much the pressures of the last three states differ, over the highest."""
    pressures = [e.pressure for e in states[-3:]]
    return (max(pressures) - min(pressures)) / max(pressures)


def peak(states: Sequence[Equilibrium]) -> float:
    """Highest pressure of the parabola through the last three states over their volumes, MPa."""
    last = states[-3:]
    volumes = np.array([e.forces.volume for e in last])
    pressures = np.array([e.pressure for e in last])
    middle, width = volumes.mean(), np.ptp(volumes)
    c, b, a = np.polynomial.polynomial.polyfit((volumes - middle) / width, pressures, 2)
    return float(max(c - b * b / (4.0 * a), pressures.max())) if a < 0.0 else float(pressures.max())


def last_work(states: Sequence[Equilibrium]) -> float:
    """Work of the pressure on the way to the last of up to four states, N mm.

    V(p) is taken as the polynomial through the states; on the second way it is the cubic that
    dV/dp at both ends gives. The balance is counted from the first state, at a few hundredths of
    a bar: until there the threads tighten, and V(p) has a kink that two states cannot tell.
    """
    after = states[-1]
    if len(states) == 1:
        return after.forces.energy
    before = states[-2]
    rise, p1 = after.pressure - before.pressure, after.pressure
    V0, V1 = before.forces.volume, after.forces.volume
    if len(states) == 2:
        area = 0.5 * (V0 + V1) * rise + rise**2 / 12.0 * (before.compliance - after.compliance)
        return p1 * V1 - before.pressure * V0 - area
    # In t = (p - p1) / rise, which runs from -1 to 0 on this way.
    t = np.array([(e.pressure - p1) / rise for e in states])
    V = np.array([e.forces.volume - V1 for e in states])
    whole = np.polynomial.Polynomial.fit(t, V, len(states) - 1).integ()
    area = float(whole(0.0) - whole(-1.0)) * rise
    return before.pressure * (V1 - V0) - area
