"""From a tube's free run to its states against a rigid obstacle."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from fem import blas
from fem.approach import Approach
from fem.arrays import FloatArray
from fem.assembly import System
from fem.body import Body
from fem.contact import Contact, pressed_of
from fem.downhill import Finder, Found
from fem.equilibrium import Equilibrium, lagrange, last_work
from fem.gap import Obstacle
from fem.grasp import Contacts, Touch
from fem.release import Released, let_go
from fem.sections import Chart, Pose
from fem.solution import Solution, State, state_of

_BETWEEN, _ASKED = 3e-3, 1e-5  # residuals over the pressure's forces
_FIRST, _SMALLEST = 0.04, 2e-3  # steps, over the highest pressure asked for
_FEW, _MANY = 3, 7  # factorisations of a step, below and above which the next is longer, shorter
_FRICTION_PASSES = 2
_KINK = 1e-3  # of the pressure: nearer the first touch counts as reached
_MOVE_IN_MM, _LEAST_IN_MM = 0.5, 0.05  # first and shortest step of an obstacle that comes near


def solve_against(
    free: Solution,
    contact: Contact | Obstacle,
    pressures: Sequence[float],
    *,
    tolerance: float = _ASKED,
    settle: bool = True,
    body: Body | None = None,
    threads: int = 2,
    progress: Callable[[float], None] | None = None,
) -> Contacts:
    """Press a tube against an obstacle, from the last free state that lies hardly in it on.

    Parameters
    ----------
    free : Solution
        Of the tube without the obstacle, from rest.
    contact : Contact or Obstacle
        Symmetric about x = 0 where the mesh is half a tube.
    pressures : sequence of float
        Gauge pressures to report, MPa; taken in rising order.
    tolerance : float
        Residual of reported states over the pressure's forces.
    settle : bool
        Whether multipliers take the depth away that the penalty leaves, some hundredths of a mm.
    body : Body, optional
        Lets the obstacle go at every reported pressure; it is held in its place until then.
    threads : {1, 2}
    progress : callable, optional
        Takes the pressure reached so far, MPa.

    Returns
    -------
    Contacts
        Ending early, with ``failure`` set, where no equilibrium is found.

    Raises
    ------
    ValueError
        When pressures make no sense, half a tube meets an obstacle that is not symmetric, or one
        with friction is to be let go.
    """
    asked = sorted({float(p) for p in pressures})
    if not asked or not all(np.isfinite(asked)) or asked[0] <= 0.0:
        raise ValueError("pressures must be finite numbers above 0")
    begun = time.perf_counter()
    touching = contact if isinstance(contact, Contact) else Contact(contact)
    touching.offset = touching.hold = None
    if body is not None and touching.friction > 0.0:
        raise ValueError("an obstacle with friction cannot be let go")
    with blas.one_thread():
        run = _Run(free, touching, body, tolerance, threads, settle=settle)
        try:
            run.go(asked, progress)
        finally:
            run.system.close()
    return Contacts(
        free, tuple(run.states), tuple(run.touches), run.first_touch, run.failure,
        tuple(run.finder.history), time.perf_counter() - begun, tuple(run.released),
    )  # fmt: skip


class _Run:
    def __init__(
        self, free: Solution, contact: Contact, body: Body | None, tolerance: float, threads: int,
        *, settle: bool,
    ) -> None:  # fmt: skip
        self._free, self._contact, self._body = free, contact, body
        self._tolerance, self._settle = tolerance, settle
        self._mesh = free.mesh
        self.system = System(free.mesh, threads, [contact], single=True)
        self._chart = Chart(free.mesh)
        self._approach = Approach(free.mesh, free.states, contact.obstacle)
        self.finder = Finder(self.system, self._chart, contact)
        self.states: list[State] = []
        self.touches: list[Touch] = []
        self.released: list[Released] = []
        self.failure: str | None = None
        self.first_touch: float | None = None
        self._last: list[Found] = []
        self._work = np.nan

    def go(self, asked: Sequence[float], progress: Callable[[float], None] | None) -> None:
        """Go through all pressures, as far as that is possible."""
        if blocked := self._approach.blocked():
            self.failure = blocked
            return
        starts = self._approach.starts(asked[0])
        self.first_touch = self._approach.first_touch
        if not self._begin(starts, asked[0]):
            return
        step = _FIRST * asked[-1]
        for target in asked:
            while (pressure := self._last[-1].pressure) < target * (1.0 - 1e-12):
                count = max(1, int(np.ceil((target - pressure) / step - 1e-6)))
                trial = target if count == 1 else pressure + (target - pressure) / count
                first = self.first_touch  # a kink in V(p): no step goes across it
                if first is not None and pressure * (1.0 + _KINK) < first < trial:
                    trial = first
                found = self._try(trial, trial == target)
                if found is None:
                    step = 0.4 * (trial - pressure)
                    if step < _SMALLEST * asked[-1]:
                        self._fail(trial)
                        return
                    continue
                self._keep(found)
                if found.factored <= _FEW:
                    step = max(step, 1.6 * (trial - pressure))
                elif found.factored >= _MANY:
                    step = 0.6 * (trial - pressure)
                if progress is not None:
                    progress(trial)
            if not self._report():
                return

    def _begin(self, starts: Sequence[State], first: float) -> bool:
        """Find the first state in contact, from the best free state that leads to one."""
        least = _SMALLEST * self._free.states[-1].pressure
        for free in starts:
            pose = self._chart.fitted(free.x)
            pressure = free.pressure
            if pressure == 0.0:
                pose = self._chart.taut(2.0 * self._mesh.actuator.gauze.transition)
                pressure = max(least, 0.02 * self._mesh.actuator.rubber.shear_modulus)
            tolerance = self._tolerance if pressure >= first * (1.0 - 1e-12) else _BETWEEN
            if pressure > free.pressure:
                found = self._moved_in(pose, pressure, tolerance)
            else:
                found = self.finder.find(pose, pressure, tolerance)
            if found is not None:
                self._last = [found]
                self._contact.take_hold(self._mesh, found.pose.x)
                self._work = self._work_to(free, found)
                return True
        self._fail(starts[-1].pressure)
        return False

    def _moved_in(self, pose: Pose, pressure: float, tolerance: float) -> Found | None:
        """Find the first state from rest: the obstacle comes to its place from where it is free."""
        contact = self._contact
        contact.lift = max(0.0, self._approach.depth_at(pose))
        step, found = _MOVE_IN_MM, self.finder.find(pose, pressure, tolerance)
        way: FloatArray | None = None  # per mm, of the last step
        while found is not None and (lift := contact.lift) > 0.0:
            contact.lift = max(0.0, lift - step)
            poses, rise = [found.pose], lift - contact.lift
            if way is not None:
                poses.append(self._chart.move(found.pose, rise * way))
            best = min(poses, key=lambda pose: self.finder.potential(pose, pressure))
            moved = self.finder.find(best, pressure, tolerance)
            if moved is not None:
                way = self._chart.difference(found.pose, moved.pose) / rise
                found = moved
                step = 2.0 * step if moved.factored <= _FEW else step
                continue
            contact.lift, step = lift, 0.4 * step
            if step < _LEAST_IN_MM:
                found = None
        contact.lift = 0.0
        return found

    def _work_to(self, free: State, found: Found) -> float:
        """Work that led to the first state: the free state's, and what the obstacle's push adds.

        The obstacle comes from the free tube's surface to its place, against a force that grows
        from nothing.
        """
        twice = 2.0 if self._mesh.half else 1.0
        if free.pressure == 0.0:
            return found.forces.energy
        pressed = pressed_of(self._contact, self._mesh, found.pose.x)
        depth = self._approach.depth_of(free.x)
        push = 0.5 * float((pressed.area * pressed.pressure * np.maximum(depth, 0.0)).sum())
        work = free.energy if np.isnan(free.work) else free.work
        return work / twice + found.pressure * (found.forces.volume - free.volume / twice) + push

    def _own_energy(self, found: Found) -> float:
        """Energy without what the penalty stores."""
        return found.forces.energy - self._contact.energy(self._mesh, found.pose.x)

    def _try(self, pressure: float, asked: bool) -> Found | None:
        """Predict in several ways, and go downhill from the best."""
        last = self._last[-1]
        rise = pressure - last.pressure
        flow = self.system.expand(last.pose.x, last.flow)
        chart = self._chart
        poses = [chart.move(last.pose, chart.increment(last.pose, flow) * rise)]
        if len(self._last) > 1:
            weights = lagrange(np.array([f.pressure for f in self._last]), pressure)
            way = sum(
                w * chart.difference(last.pose, f.pose)
                for w, f in zip(weights[:-1], self._last[:-1], strict=True)
            )
            poses.append(chart.move(last.pose, np.asarray(way)))
        poses.append(last.pose)
        best = min(poses, key=lambda pose: self.finder.potential(pose, pressure))
        tolerance = self._tolerance if asked else _BETWEEN
        found = self.finder.find(best, pressure, tolerance)
        for _ in range(_FRICTION_PASSES if self._contact.friction > 0.0 else 0):
            if found is None:
                break
            self._contact.take_hold(self._mesh, found.pose.x, slip=False)
            found = self.finder.find(found.pose, pressure, tolerance)
        return found

    def _keep(self, found: Found) -> None:
        self._last = [*self._last[-2:], found]
        self._contact.take_hold(self._mesh, found.pose.x)
        # By the volume and its slope at both ends: contact may have changed in any earlier step.
        ends = [
            Equilibrium(
                f.pressure, f.pose, f.forces,
                float(f.forces.volume_gradient @ f.flow), f.residual, False, 0,
            )
            for f in self._last[-2:]
        ]  # fmt: skip
        self._work += last_work(ends)

    def _report(self) -> bool:
        """Report the last state, with its depth passed on to the multipliers."""
        found = before = self._last[-1]
        if self._settle:
            settled = self.finder.settle(before, self._tolerance)
            if settled is None:
                self._fail(before.pressure)
                return False
            found, pushed = settled
            self._work += pushed
        self._work += found.pressure * (found.forces.volume - before.forces.volume)
        self._last[-1] = found
        mesh, twice = self._mesh, 2.0 if self._mesh.half else 1.0
        pressed = pressed_of(self._contact, mesh, found.pose.x)
        own = replace(found.forces, energy=self._own_energy(found))
        state = state_of(
            mesh,
            Equilibrium(found.pressure, found.pose, own, np.nan, found.residual, True, 0),
            self._work - self._contact.energy(mesh, found.pose.x),
        )
        clamp = twice * self.system.clamp(found.pose.x, found.pressure)
        force = twice * pressed.force.sum(axis=(0, 1, 2))
        if mesh.half:
            force[0] = clamp[0] = 0.0
        if state.touches:
            self.failure = (
                f"the tube runs into itself at {10.0 * found.pressure:.2f} bar, which this model "
                "does not hold apart"
            )
            return False
        self.states.append(state)
        self.touches.append(Touch(pressed, pressed.depth, force, clamp))
        if self._body is not None:
            self.released.append(let_go(self.finder, self.system, self._contact, found, self._body))
        return True

    def _fail(self, pressure: float) -> None:
        reached = self._last[-1].pressure if self._last else 0.0
        self.failure = (
            f"no stable equilibrium found against the object at {10.0 * pressure:.3f} bar; the "
            f"last one is at {10.0 * reached:.3f} bar"
        )
