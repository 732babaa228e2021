"""A state from a similar actuator's state, in place of the path from rest."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from fem import blas
from fem.actuator import Actuator
from fem.arrays import FloatArray
from fem.assembly import System
from fem.equilibrium import Equilibrium
from fem.errors import Attempt, NotConverged
from fem.items import MakeItem
from fem.loadpath import DEFAULT_OPTIONS, Options
from fem.material import LAWS, Law, law
from fem.mesh import Mesh, alike, make_mesh
from fem.newton import Correction, correct
from fem.sections import Chart
from fem.solution import Solution, state_of
from fem.transfer import settle, transfer

_LEAST_WAY = 0.5  # of the way from one actuator to another: below it the path from rest is shorter


def solve_near(
    actuator: Actuator,
    known: Solution,
    pressure: float,
    options: Options = DEFAULT_OPTIONS,
    *,
    flow: FloatArray | None = None,
    threads: int = 2,
    extra: Sequence[MakeItem] = (),
) -> Solution:
    """Find an actuator's state at one pressure from a similar actuator's last state.

    Newton's method at the pressure itself, on a way from actuator to actuator that is shortened
    where it does not converge, takes the place of the path from rest. So the work of the
    pressure is not known, and the energy error is NaN; and where the path from rest leads to
    another equilibrium this does not tell.

    Parameters
    ----------
    actuator : Actuator
        With the same section of the tube as the known one, and as many windows.
    known : Solution
    pressure : float, MPa
    options : Options
    flow : (layers + 1, ring + mid, 3), optional
        Motion of the known state's nodes to be expected, mm; see `fem.sensitivity.flow_to`.
    threads : {1, 2}
    extra : sequence of MakeItem
        What contributes to the energy beside bricks, gauze and air; see `fem.items`.

    Returns
    -------
    Solution
        With the states at rest and at ``pressure``, on a mesh of its own.

    Raises
    ------
    NotConverged
        Where the known state is too far off, or the state found is not stable; with the last
        state on the way, which is that of the actuator that its mesh holds.
    """
    begun = time.perf_counter()
    way = _Way(known, actuator, pressure, options, extra)
    with blas.one_thread():
        failed = not way.go(flow, threads)
        solution = way.solution(begun)
    if failed:
        assert solution.failure is not None
        raise NotConverged(solution.failure, solution.history, 0.0, solution)
    return solution


class _Way:
    """The way from a known actuator's state to another actuator's, at one pressure."""

    def __init__(
        self,
        known: Solution,
        actuator: Actuator,
        pressure: float,
        options: Options,
        extra: Sequence[MakeItem],
    ) -> None:
        self._first, self._actuator = known.mesh, actuator
        self._pressure, self._options, self._extra = pressure, options, extra
        self._mesh, self._x = known.mesh, known.states[-1].x  # of the last state
        self._done: Correction | None = None
        self._history: list[Attempt] = []
        self._share = 0.0

    def go(self, flow: FloatArray | None, threads: int) -> bool:
        """Go to the end in as few steps as converge; tell whether that was possible."""
        step = 1.0
        while self._share < 1.0:
            share = min(self._share + step, 1.0)
            there = self._between(share)
            mesh = make_mesh(there, self._first.size, not self._first.half, like=self._first)
            done = self._corrected(mesh, None if flow is None else step * flow, threads)
            if self._history[-1].outcome == "converged":
                # What is expected of the nodes of one mesh says nothing of another's.
                flow = flow if alike(mesh, self._mesh) else None
                self._share, self._mesh, self._x, self._done = share, mesh, done.pose.x, done
            elif step > _LEAST_WAY and self._between(0.5 * (self._share + share)) != there:
                step *= 0.5
            else:
                return False
        return True

    def _between(self, share: float) -> Actuator:
        if share == 1.0:
            return self._actuator
        return between(self._first.actuator, self._actuator, share)

    def _corrected(self, mesh: Mesh, flow: FloatArray | None, threads: int) -> Correction:
        chart = Chart(mesh)
        system = System(mesh, threads, self._extra, single=True)
        try:
            if flow is None or not alike(mesh, self._mesh):
                start = transfer(self._mesh, self._x, mesh)
            else:
                start = settle(_moved(self._mesh, self._x, flow), mesh, self._mesh)
            done = correct(system, chart, chart.of(start), self._pressure, self._options.tolerance)
        finally:
            system.close()
        unstable = done.outcome == "converged" and done.negative and self._options.stable
        outcome = "unstable" if unstable else done.outcome
        self._history.append(
            Attempt(self._pressure, done.iterations, done.factored, done.residual, outcome)
        )
        return done

    def solution(self, begun: float) -> Solution:
        """Give the last state, and that at rest."""
        mesh, done, history = self._mesh, self._done, self._history
        rest = System(mesh, 1, self._extra).forces(mesh.X)
        at_rest = Equilibrium(0.0, Chart(mesh).rest(), rest, np.nan, 0.0, True, 0)
        states = [state_of(mesh, at_rest, 0.0)]
        if done is not None:
            last = Equilibrium(
                self._pressure, done.pose, done.forces, np.nan, done.residual, True, 0
            )
            states.append(state_of(mesh, last, np.nan))
        reached = self._share >= 1.0
        return Solution(
            mesh=mesh,
            states=tuple(states),
            critical=None,
            history=tuple(history),
            newton_iterations=sum(a.iterations for a in history),
            factorisations=sum(a.factorisations for a in history),
            seconds=time.perf_counter() - begun,
            failure=None if reached else "no stable equilibrium found from the known one",
        )


def _moved(mesh: Mesh, x: FloatArray, flow: FloatArray) -> FloatArray:
    """Move nodes by a motion that may hold large rotations of the sections."""
    chart = Chart(mesh)
    pose = chart.of(x)
    return chart.move(pose, chart.increment(pose, flow)).x


def between(first: Actuator, last: Actuator, share: float) -> Actuator:
    """Actuator on the way from one to another with as many windows: lengths, angles, stiffness.

    All else, and rubber of another law, is the last one's.
    """

    def mix(a: float, b: float) -> float:
        return a + share * (b - a)

    windows = tuple(
        replace(
            w,
            centre=mix(v.centre, w.centre),
            openF=mix(v.openF, w.openF),
            alpha=mix(v.alpha, w.alpha),
            center=mix(v.center, w.center),
        )
        for v, w in zip(first.windows, last.windows, strict=True)
    )
    gauze = replace(
        last.gauze,
        stiffness=mix(first.gauze.stiffness, last.gauze.stiffness),
        slack=mix(first.gauze.slack, last.gauze.slack),
        allowance=mix(first.gauze.allowance, last.gauze.allowance),
    )
    return replace(
        last,
        length=mix(first.length, last.length),
        windows=windows,
        wall=mix(first.wall, last.wall),
        rubber=_mixed(first.rubber, last.rubber, mix),
        gauze=gauze,
    )


def _mixed(first: Law, last: Law, mix: Callable[[float, float], float]) -> Law:
    """Mix the constants of two rubbers of one law, where all of them are numbers."""
    if type(first) is not type(last) or last.name not in LAWS:
        return last
    mixed: dict[str, float] = {}
    for name, constant in last.constants.items():
        before = first.constants[name]
        if isinstance(before, tuple) or isinstance(constant, tuple):
            return last
        mixed[name] = mix(before, constant)
    return law(last.name, mixed)
