"""Angles of an actuator over pressure, rubber, threads and wall, from one finite-element run.

Rubber that is c times as stiff, at a pressure P, bends as the known one does at P / c in a gauze
that is 1 / c times as stiff. Threads, wall and gauze are taken to first order, by FE's own
derivatives at some of the run's states.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy.interpolate import CubicSpline

from fem.actuator import Actuator
from fem.errors import BadGeometry, FemError, NotConverged
from fem.near import solve_near
from fem.parameters import ANGLE_STEP, LENGTH_STEP, SHARE_STEP, Parameter
from fem.sensitivity import rates_by
from fem.solver import solve
from formula.rubber import RubberLaw
from profiletool.errors import NotVerified
from profiletool.records.design import Design
from profiletool.records.rubber import law_of
from profiletool.records.units import BAR_PER_MPA, FloatArray, IntArray
from profiletool.verify.run import shortly
from profiletool.verify.tube import actuator_of

RUBBER, DEAD, THREAD, WALL = range(4)
_STATES, _EVERY = 10, 3  # states of a run; of them are differentiated


@dataclass(frozen=True)
class Surrogate:
    """Angles near an actuator that finite elements know.

    Attributes
    ----------
    base : (4,)
        Its numbers: ln of the rubber's stiffness over the design's, bar, deg, mm.
    top : float, bar
        Highest pressure of the run.
    theta : CubicSpline
        (J,) deg over bar.
    by_thread, by_wall, by_gauze : CubicSpline
        (J,) deg per deg, per mm, per share of itself.
    """

    base: FloatArray
    top: float
    theta: CubicSpline
    by_thread: CubicSpline
    by_wall: CubicSpline
    by_gauze: CubicSpline

    def angles(self, values: FloatArray, bars: FloatArray, joints: IntArray) -> FloatArray:
        """Angles (N,) deg of joints at pressures on the gauge, bar, of a tube of such numbers."""
        step = values - self.base
        own = np.maximum(bars - values[DEAD], 0.0) * np.exp(-step[RUBBER])
        inside = np.minimum(own, self.top)
        rows = np.arange(len(bars))
        theta = self.theta(inside) + (own - inside)[:, None] * self.theta(inside, 1)
        theta = theta + step[THREAD] * self.by_thread(inside) + step[WALL] * self.by_wall(inside)
        return np.asarray((theta - step[RUBBER] * self.by_gauze(inside))[rows, joints])


def tube_by(design: Design, values: FloatArray) -> Design:
    """Build a design with other rubber, threads and wall."""
    known = law_of(design.tube.rubber, design.model.nu)
    stiff = float(np.exp(values[RUBBER]))
    constants = {
        key: tuple(stiff * v for v in value) if isinstance(value, tuple) else stiff * value
        for key, value in known.constants.items()
    }
    if known.name == "ogden":  # its exponents have no unit
        constants["alpha"] = known.constants["alpha"]
    tube = replace(
        design.tube,
        rubber=RubberLaw("calibrated", known.name, constants),
        wall_mm=design.tube.wall_mm + float(values[WALL]),
    )
    extra = design.model.sector_extra_deg + float(values[THREAD])
    return replace(design, tube=tube, model=replace(design.model, sector_extra_deg=extra, nu=None))


def surrogate_at(
    design: Design,
    values: FloatArray,
    top_bar: float,
    progress: Callable[[float], None] | None = None,
) -> Surrogate:
    """Run finite elements of a design with such numbers, up to a pressure inside the tube.

    Raises
    ------
    NotVerified
        They do not come far.
    """
    bars = np.linspace(0.0, top_bar, _STATES + 1)

    def told(pressure: float) -> None:
        if progress is not None:
            progress(0.5 * min(1.0, BAR_PER_MPA * pressure / top_bar))

    try:
        actuator = actuator_of(tube_by(design, values))
        found = solve(actuator, (bars[1:] / BAR_PER_MPA).tolist(), progress=told)
    except NotConverged as error:
        raise NotVerified(f"finite elements of this tube: {shortly(error)}") from error
    except BadGeometry as error:
        raise NotVerified(f"finite elements of this tube: {error}") from error
    states = found.states
    bars = np.array([BAR_PER_MPA * state.pressure for state in states])
    theta = np.unwrap([np.degrees(state.theta) for state in states], period=360.0, axis=0)
    count = len(actuator.windows)
    chosen = list(range(len(states) - 1, 0, -_EVERY))[::-1]
    rows = [np.zeros((3, count))]
    for n, k in enumerate(chosen, start=1):
        try:
            # States in between are as exact as the path needs them: not enough for derivatives.
            near = replace(found, states=states[: k + 1])
            exact = solve_near(actuator, near, states[k].pressure).states[-1]
            rates = rates_by(found.mesh, exact.x, exact.pressure, _PARAMETERS)
        except FemError as error:
            raise NotVerified(
                f"finite elements of this tube have no derivatives: {error}"
            ) from error
        rows.append(np.degrees([rate.theta for rate in rates]))
        if progress is not None:
            progress(0.5 + 0.5 * n / len(chosen))
    slopes = np.array(rows)
    slopes[:, 0] = np.radians(slopes[:, 0])  # a sector's width is told in deg
    at = bars[[0, *chosen]]
    splines = (CubicSpline(at, slopes[:, k]) for k in range(3))
    return Surrogate(values, float(bars[-1]), CubicSpline(bars, theta), *splines)


def _widen(actuator: Actuator, amount: float) -> Actuator:
    gauze = replace(actuator.gauze, allowance=actuator.gauze.allowance + amount)
    return replace(actuator, gauze=gauze)


def _thicken(actuator: Actuator, amount: float) -> Actuator:
    return replace(actuator, wall=actuator.wall + amount)


def _stiffen(actuator: Actuator, share: float) -> Actuator:
    gauze = replace(actuator.gauze, stiffness=(1.0 + share) * actuator.gauze.stiffness)
    return replace(actuator, gauze=gauze)


_PARAMETERS = (
    Parameter(None, ANGLE_STEP, _widen),
    Parameter(None, LENGTH_STEP, _thicken),
    Parameter(None, SHARE_STEP, _stiffen),
)
