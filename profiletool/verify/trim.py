"""The trim table of a design: where it stands at pressures around the planned one, by FE."""

from __future__ import annotations

from math import ceil, floor

import numpy as np

from fem.equilibrium import lagrange
from fem.errors import NotConverged
from fem.loadpath import Options
from fem.onward import solve_onward
from fem.solution import Solution
from profiletool.records.built import TrimPoint
from profiletool.records.design import Design
from profiletool.records.side import side_sign
from profiletool.records.units import BAR_PER_MPA
from profiletool.verify.lines import shape_of
from profiletool.verify.run import Run

LOWEST, HIGHEST = 0.85, 1.1  # of the planned pressure
_USED = 0.65  # of it: states from there on carry the interpolation
_STEPS_BAR = (0.002, 0.005, 0.01, 0.02, 0.03, 0.04, 0.05, 0.1, 0.2, 0.5, 1.0)
_MOST_STEPS = 12
_ROUNDED_BAR = 0.01
_DECIMALS = 3  # of mm and deg
# Mostly one Newton step from the extrapolated state: angles within 0.02 deg, the tip 0.03 mm.
_OPTIONS = Options(tolerance=3e-3)


def trim_of(design: Design, run: Run) -> tuple[TrimPoint, ...]:
    """Tabulate tip and angles at pressures around the design's own.

    Two more states, above the planned pressure, are found from the run's last ones. Between the
    states tip and angles are interpolated by one polynomial.

    Parameters
    ----------
    design : Design
    run : Run
        Up to the design's pressure.

    Returns
    -------
    tuple of TrimPoint
        In rising order, one of them at the planned pressure; the last a tenth above it, or as far
        as there are stable states.
    """
    planned = design.pressure_bar
    solution, top = _further(run.solution, planned, _top(planned))
    # Beyond half a turn the angles go on, and do not start again from the other side.
    theta = np.unwrap([np.degrees(state.theta) for state in solution.states], period=360.0, axis=0)
    bars = np.array([BAR_PER_MPA * state.pressure for state in solution.states])
    used = bars > _USED * planned
    sign = side_sign(design.source.side)
    tips = [
        shape_of(solution.mesh, state, design.base_pose, sign).facing[-1]
        for state in np.array(solution.states, dtype=object)[used]
    ]
    points = []
    for bar in trim_pressures(planned, top):
        weights = lagrange(bars[used], bar)
        x, y = np.round(weights @ np.array(tips), _DECIMALS).tolist()
        angles = np.round(weights @ theta[used], _DECIMALS).tolist()
        points.append(TrimPoint(bar, (x, y), tuple(angles)))
    return tuple(points)


def trim_pressures(planned_bar: float, top_bar: float) -> tuple[float, ...]:
    """Give the pressures of a trim table, bar: even steps about the planned one, then the top."""
    span = (HIGHEST - LOWEST) * planned_bar
    enough = (step for step in _STEPS_BAR if span <= (_MOST_STEPS + 1e-6) * step)
    step = next(enough, span / _MOST_STEPS)
    below = ceil((1.0 - LOWEST) * planned_bar / step - 1e-6)
    above = floor((top_bar - planned_bar) / step - 0.5 + 1e-6)
    rows = [planned_bar + k * step for k in range(-below, max(above, 0) + 1)]
    rows = [bar for bar in rows if bar > 0.0 and (bar == planned_bar or bar < top_bar)]
    return tuple(round(bar, 6) for bar in rows) + ((top_bar,) if top_bar > planned_bar else ())


def _top(planned: float) -> float:
    """Give the highest pressure to ask for, bar."""
    return round(_ROUNDED_BAR * ceil(HIGHEST * planned / _ROUNDED_BAR - 1e-6), 6)


def _further(solution: Solution, planned: float, top: float) -> tuple[Solution, float]:
    """Take a run to the top, or as near to it as there are stable states."""
    try:
        for bar in (0.5 * (planned + top), top):
            solution = solve_onward(solution, bar / BAR_PER_MPA, _OPTIONS)
    except NotConverged as error:
        found = error.solution
        assert isinstance(found, Solution)
        reached = BAR_PER_MPA * found.states[-1].pressure
        down = round(_ROUNDED_BAR * floor(reached / _ROUNDED_BAR + 1e-6), 6)
        return found, max(planned, down)
    return solution, top
