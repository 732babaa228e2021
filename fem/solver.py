"""From an actuator and pressures to states: the path of equilibria from rest."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence

import numpy as np

from fem import blas
from fem.actuator import Actuator
from fem.assembly import System
from fem.equilibrium import Critical, Equilibrium, last_work
from fem.errors import NotConverged
from fem.items import MakeItem
from fem.loadpath import DEFAULT_OPTIONS, Options, Path
from fem.mesh import Mesh, make_mesh
from fem.meshsize import DEFAULT_MESH, MeshSize
from fem.sections import Chart
from fem.solution import Solution, state_of


def solve(
    actuator: Actuator,
    pressures: Sequence[float],
    size: MeshSize = DEFAULT_MESH,
    options: Options = DEFAULT_OPTIONS,
    *,
    whole: bool = False,
    threads: int = 2,
    progress: Callable[[float], None] | None = None,
    extra: Sequence[MakeItem] = (),
) -> Solution:
    """Inflate an actuator.

    Parameters
    ----------
    actuator : Actuator
    pressures : sequence of float
        Gauge pressures to report, MPa; taken in rising order.
    size : MeshSize
    options : Options
    whole : bool
        Model the whole tube even where half of it would do.
    threads : {1, 2}
    progress : callable, optional
        Takes the pressure reached so far, MPa.
    extra : sequence of MakeItem
        What contributes to the energy beside bricks, gauze and air; see `fem.items`.

    Returns
    -------
    Solution
        Ending early, with ``critical`` set, where the path loses its stability.

    Raises
    ------
    NotConverged
        With its history, and the states that were reached.
    ValueError
        When a pressure is negative or not finite.
    """
    return solve_mesh(
        make_mesh(actuator, size, whole),
        pressures, options, threads=threads, progress=progress, extra=extra,
    )  # fmt: skip


def solve_mesh(
    mesh: Mesh,
    pressures: Sequence[float],
    options: Options = DEFAULT_OPTIONS,
    *,
    threads: int = 2,
    progress: Callable[[float], None] | None = None,
    extra: Sequence[MakeItem] = (),
) -> Solution:
    """Inflate an actuator whose mesh is given; see `solve`."""
    asked = sorted({float(p) for p in pressures if p != 0.0})
    if not all(np.isfinite(asked)) or any(p < 0.0 for p in asked):
        raise ValueError("pressures must be finite numbers, 0 or above")
    begun = time.perf_counter()
    with blas.one_thread():
        system = System(mesh, threads, extra, single=True)
        try:
            return _inflate(system, asked, options, progress, begun)
        finally:
            system.close()


def _inflate(
    system: System,
    asked: Sequence[float],
    options: Options,
    progress: Callable[[float], None] | None,
    begun: float,
) -> Solution:
    mesh, chart = system.mesh, Chart(system.mesh)
    at_rest = Equilibrium(0.0, chart.rest(), system.forces(mesh.X), np.nan, 0.0, True, 0)
    states = [state_of(mesh, at_rest, 0.0)]
    path = Path(system, chart, options)
    last: list[Equilibrium] = []
    work, failure = 0.0, None
    try:
        for equilibrium in path.follow(asked):
            last = [*last[-3:], equilibrium]
            work += last_work(last)
            if progress is not None:
                progress(equilibrium.pressure)
            if equilibrium.asked:
                states.append(state_of(mesh, equilibrium, work))
    except NotConverged as error:
        failure = error
    critical, beyond = path.critical, None
    if asked and max(state.pressure for state in states) >= asked[-1]:
        critical, beyond = None, critical
        if failure is not None:
            beyond, failure = Critical("no equilibrium", failure.reached), None
    solution = Solution(
        mesh=mesh,
        states=tuple(states),
        critical=critical,
        history=tuple(path.history),
        newton_iterations=sum(a.iterations for a in path.history),
        factorisations=sum(a.factorisations for a in path.history),
        seconds=time.perf_counter() - begun,
        failure=None if failure is None else str(failure),
        ahead=beyond,
    )
    if failure is not None:
        raise NotConverged(str(failure), failure.history, failure.reached, solution) from failure
    return solution
