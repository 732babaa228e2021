"""From an actuator and pressures to states: the front door of the package."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from fem import blas, measure
from fem.actuator import Actuator
from fem.assembly import System
from fem.errors import Attempt, NotConverged
from fem.loadpath import Critical, Equilibrium, Options, Path
from fem.mesh import Mesh, alike, make_mesh
from fem.meshsize import DEFAULT_MESH, MeshSize
from fem.newton import correct
from fem.sections import Chart
from fem.transfer import settle, transfer

FloatArray = NDArray[np.float64]
DEFAULT_OPTIONS = Options()
_LEAST_WAY = 0.2  # of the way from one actuator to another, before it gives up


@dataclass(frozen=True)
class State:
    """An actuator at one pressure; all quantities are those of the whole tube.

    Attributes
    ----------
    pressure : float, MPa
    theta : (joints,) rad
        Positive toward the object; see `fem.measure.joint_angles`.
    shape : fem.measure.Shape
    sectors : tuple of fem.measure.Sector
    threads : fem.measure.Gauze
    volume : float, mm^3
        Enclosed: the air demand is what it exceeds that at rest.
    energy, work : float, N mm
        Stored in rubber and gauze; done by the pressure so far (NaN where that is not known).
    residual : float
        Unbalanced forces over the pressure's.
    least_J : float
        Smallest determinant of F.
    stretches : (layers,)
        Largest principal stretch of the rubber at any Gauss point of each layer.
    touches : bool
        Whether the tube's surface meets itself; the model has no contact.
    x : (layers + 1, ring + mid, 3) mm
        Nodal positions of the mesh.
    """

    pressure: float
    theta: FloatArray
    shape: measure.Shape
    sectors: tuple[measure.Sector, ...]
    threads: measure.Gauze
    volume: float
    energy: float
    work: float
    residual: float
    least_J: float
    stretches: FloatArray
    touches: bool
    x: FloatArray

    @property
    def largest_stretch(self) -> float:
        """Largest principal stretch of the rubber anywhere."""
        return float(self.stretches.max())

    @property
    def energy_error(self) -> float:
        """How far the stored energy is off the work done, over the work.

        0 at rest and at the first state, from which on the balance is counted; NaN where the
        work is not known.
        """
        return abs(self.energy - self.work) / self.work if self.work != 0.0 else 0.0


@dataclass(frozen=True)
class Solution:
    """What a run gives.

    Attributes
    ----------
    mesh : Mesh
    states : tuple of State
        At rest, then at every asked pressure that was reached, in order.
    critical : Critical or None
        What ended the path before the last asked pressure.
    history : tuple of Attempt
    newton_iterations, factorisations : int
    seconds : float
    """

    mesh: Mesh
    states: tuple[State, ...]
    critical: Critical | None
    history: tuple[Attempt, ...]
    newton_iterations: int
    factorisations: int
    seconds: float

    @property
    def converged(self) -> bool:
        """Whether every asked pressure was reached."""
        return self.critical is None


def solve(
    actuator: Actuator,
    pressures: Sequence[float],
    size: MeshSize = DEFAULT_MESH,
    options: Options = DEFAULT_OPTIONS,
    *,
    whole: bool = False,
    threads: int = 2,
    progress: Callable[[float], None] | None = None,
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

    Raises
    ------
    NotConverged
        With its history.
    ValueError
        When a pressure is negative or not finite.
    """
    asked = sorted({float(p) for p in pressures if p != 0.0})
    if not all(np.isfinite(asked)) or any(p < 0.0 for p in asked):
        raise ValueError("pressures must be finite numbers, 0 or above")
    begun = time.perf_counter()
    mesh = make_mesh(actuator, size, whole)
    chart = Chart(mesh)
    with blas.one_thread():
        system = System(mesh, threads)
        try:
            rest = system.forces(mesh.X)
            at_rest = Equilibrium(0.0, chart.rest(), rest, np.nan, 0.0, True, 0)
            states = [_state(mesh, at_rest, 0.0)]
            path = Path(system, chart, options)
            known: list[Equilibrium] = []
            work = 0.0
            for found in path.follow(asked):
                known = [*known[-3:], found]
                work += last_work(known)
                if progress is not None:
                    progress(found.pressure)
                if found.asked:
                    states.append(_state(mesh, found, work))
        finally:
            system.close()
    return Solution(
        mesh=mesh,
        states=tuple(states),
        critical=path.critical,
        history=tuple(path.history),
        newton_iterations=sum(a.iterations for a in path.history),
        factorisations=sum(a.factorisations for a in path.history),
        seconds=time.perf_counter() - begun,
    )


def solve_near(
    actuator: Actuator,
    known: Solution,
    pressure: float,
    options: Options = DEFAULT_OPTIONS,
    *,
    flow: FloatArray | None = None,
    threads: int = 2,
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

    Returns
    -------
    Solution
        With the states at rest and at ``pressure``, on a mesh of its own.

    Raises
    ------
    NotConverged
        Where the known state is too far off, or the state found is not stable.
    """
    begun = time.perf_counter()
    first, history = known.mesh, list[Attempt]()
    last, x, share, step = first, known.states[-1].x, 0.0, 1.0
    with blas.one_thread():
        while share < 1.0:
            there = between(first.actuator, actuator, min(share + step, 1.0))
            mesh = make_mesh(there, first.size, not first.half, like=first)
            chart = Chart(mesh)
            system = System(mesh, threads)
            try:
                if flow is None or not alike(mesh, last):
                    start = transfer(last, x, mesh)
                else:
                    start = settle(_moved(last, x, step * flow), mesh, last)
                done = correct(system, chart, chart.of(start), pressure, options.tolerance)
            finally:
                system.close()
            history.append(
                Attempt(pressure, done.iterations, done.factored, done.residual, done.outcome)
            )
            if done.outcome == "converged" and not (done.negative and options.stable):
                # What is expected of the nodes of one mesh says nothing of another's.
                flow = flow if alike(mesh, last) else None
                share, last, x = min(share + step, 1.0), mesh, done.pose.x
            elif step > _LEAST_WAY:
                step *= 0.5
            else:
                raise NotConverged(
                    "no stable equilibrium found from the known one", tuple(history), 0.0
                )
        rest = System(last, threads=1).forces(last.X)
    at_rest = Equilibrium(0.0, chart.rest(), rest, np.nan, 0.0, True, 0)
    found = Equilibrium(pressure, done.pose, done.forces, np.nan, done.residual, True, 0)
    return Solution(
        mesh=last,
        states=(_state(last, at_rest, 0.0), _state(last, found, np.nan)),
        critical=None,
        history=tuple(history),
        newton_iterations=sum(a.iterations for a in history),
        factorisations=sum(a.factorisations for a in history),
        seconds=time.perf_counter() - begun,
    )


def _moved(mesh: Mesh, x: FloatArray, flow: FloatArray) -> FloatArray:
    """Move nodes by a motion that may hold large rotations of the sections."""
    chart = Chart(mesh)
    pose = chart.of(x)
    return chart.move(pose, chart.increment(pose, flow)).x


def between(first: Actuator, last: Actuator, share: float) -> Actuator:
    """Actuator on the way from one to another with as many windows: lengths and angles.

    All else is the last one's.
    """

    def mix(a: float, b: float) -> float:
        return a + share * (b - a)

    windows = tuple(
        replace(
            w,
            centre=mix(v.centre, w.centre),
            openF=mix(v.openF, w.openF),
            alpha=mix(v.alpha, w.alpha),
        )
        for v, w in zip(first.windows, last.windows, strict=True)
    )
    return replace(last, length=mix(first.length, last.length), windows=windows)


def last_work(known: Sequence[Equilibrium]) -> float:
    """Work of the pressure on the way to the last of up to four states, N mm.

    V(p) is taken as the polynomial through the states; on the second way it is the cubic that
    dV/dp at both ends gives. The balance is counted from the first state, at a few hundredths of
    a bar: until there the threads tighten, and V(p) has a kink that two states cannot tell.
    """
    after = known[-1]
    if len(known) == 1:
        return after.forces.energy
    before = known[-2]
    rise, p1 = after.pressure - before.pressure, after.pressure
    V0, V1 = before.forces.volume, after.forces.volume
    if len(known) == 2:
        area = 0.5 * (V0 + V1) * rise + rise**2 / 12.0 * (before.compliance - after.compliance)
        return p1 * V1 - before.pressure * V0 - area
    # In t = (p - p1) / rise, which runs from -1 to 0 on this way.
    t = np.array([(e.pressure - p1) / rise for e in known])
    V = np.array([e.forces.volume - V1 for e in known])
    whole = np.polynomial.Polynomial.fit(t, V, len(known) - 1).integ()
    area = float(whole(0.0) - whole(-1.0)) * rise
    return before.pressure * (V1 - V0) - area


def _state(mesh: Mesh, found: Equilibrium, work: float) -> State:
    x, forces = found.pose.x, found.forces
    twice = 2.0 if mesh.half else 1.0
    shape = measure.lines(mesh, x)
    wrapped = measure.sectors(mesh, shape)
    return State(
        pressure=found.pressure,
        theta=measure.joint_angles(mesh, x, wrapped),
        shape=shape,
        sectors=wrapped,
        threads=measure.threads(mesh, x),
        volume=twice * forces.volume,
        energy=twice * forces.energy,
        work=twice * work,
        residual=found.residual,
        least_J=forces.least_J,
        stretches=measure.stretches(mesh, x),
        touches=measure.touches(mesh, x),
        x=x,
    )
