"""States beyond a run's last pressure, from its own last states."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from fem import blas
from fem.assembly import System
from fem.equilibrium import Equilibrium, lagrange
from fem.errors import Attempt, NotConverged
from fem.items import MakeItem
from fem.loadpath import DEFAULT_OPTIONS, Options
from fem.newton import correct
from fem.sections import Chart, Pose
from fem.solution import Solution, State, state_of

_KNOWN = 3  # states that the next one is extrapolated from
_LEAST = 0.25  # of the way to the pressure, the shortest step before it gives up
# Residual of a prediction from which Newton's method finds the state that belongs to it. Further
# off, it may end in another one: threads can slacken in several ways.
_NEAR = 0.3


def solve_onward(
    known: Solution,
    pressure: float,
    options: Options = DEFAULT_OPTIONS,
    *,
    threads: int = 2,
    extra: Sequence[MakeItem] = (),
) -> Solution:
    """Take a run further, to a pressure somewhat above its last one.

    Newton's method starts from the parabola through the last states in the chart of sections.
    Where it does not converge, the step is halved. A limit point or a bifurcation on the way is
    not named.

    Parameters
    ----------
    known : Solution
        With states at rest and at pressures that rise.
    pressure : float, MPa
        Above the last one.
    options : Options
        Of which ``tolerance`` and ``stable`` count.
    threads : {1, 2}
    extra : sequence of MakeItem
        As the run had them.

    Returns
    -------
    Solution
        The run with the states found on the way, the last at ``pressure``; their work is NaN.

    Raises
    ------
    NotConverged
        With the run as far as it could be taken.
    ValueError
        When the pressure is not above the last one.
    """
    begun, last = time.perf_counter(), known.states[-1].pressure
    if not pressure > last:
        raise ValueError(f"the run has come to {last:g} MPa already, not below {pressure:g}")
    with blas.one_thread():
        system = System(known.mesh, threads, extra, single=True)
        try:
            way = _Way(system, known, options)
            failed = not way.go(pressure)
        finally:
            system.close()
    history = (*known.history, *way.history)
    found = replace(
        known, states=tuple(way.states), history=history,
        newton_iterations=sum(a.iterations for a in history),
        factorisations=sum(a.factorisations for a in history),
        seconds=known.seconds + time.perf_counter() - begun,
        failure="no stable equilibrium found from the last states" if failed else None,
    )  # fmt: skip
    if found.failure is not None:
        raise NotConverged(found.failure, history, found.states[-1].pressure, found)
    return found


class _Way:
    """The way from the last states of a run to a higher pressure."""

    def __init__(self, system: System, known: Solution, options: Options) -> None:
        self._system, self._chart, self._options = system, Chart(system.mesh), options
        self.states: list[State] = list(known.states)
        self.history: list[Attempt] = []

    def go(self, pressure: float) -> bool:
        """Go there in as few steps as converge; tell whether that was possible."""
        least = _LEAST * (pressure - self.states[-1].pressure)
        trial = pressure
        while (last := self.states[-1].pressure) < pressure:
            if self._try(trial):
                trial = pressure
            elif 0.5 * (trial - last) >= (1.0 - 1e-9) * least:
                trial = 0.5 * (last + trial)
            else:
                return False
        return True

    def _try(self, pressure: float) -> bool:
        start, tolerance = self._predicted(pressure), self._options.tolerance
        done = correct(self._system, self._chart, start, pressure, tolerance)
        outcome: str = done.outcome
        if outcome == "converged" and self._options.stable and done.negative:
            outcome = "unstable"
        elif outcome == "converged" and done.first > _NEAR:
            outcome = "residual"
        self.history.append(
            Attempt(pressure, done.iterations, done.factored, done.residual, outcome)
        )
        if outcome != "converged":
            return False
        found = Equilibrium(pressure, done.pose, done.forces, np.nan, done.residual, True, 0)
        self.states.append(state_of(self._system.mesh, found, np.nan))
        return True

    def _predicted(self, pressure: float) -> Pose:
        """Extrapolate the last states; rest counts where there are few others."""
        used = self.states[1:][-_KNOWN:] if len(self.states) > _KNOWN else self.states
        *before, last = (self._chart.fitted(state.x) for state in used)
        weights = lagrange(np.array([state.pressure for state in used]), pressure)
        steps = (self._chart.difference(last, pose) for pose in before)
        increment = sum(w * step for w, step in zip(weights[:-1], steps, strict=True))
        return self._chart.move(last, np.asarray(increment))
