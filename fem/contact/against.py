"""From a tube's free run to its states against a rigid obstacle."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from fem import blas
from fem.arrays import FloatArray
from fem.assembly import System
from fem.contact.find import Finder, Found
from fem.contact.gap import Obstacle
from fem.contact.item import Contact, Pressed, Surface, pressed_of
from fem.equilibrium import Equilibrium, lagrange, last_work
from fem.errors import Attempt
from fem.mesh import Mesh
from fem.sections import Chart, Pose
from fem.solution import Solution, State, state_of

_LEAN_MM = 0.4  # depth of a free state from which the tube gives way at once
_CLAMP_MM = 0.05  # depth at the clamp, where it cannot
_BETWEEN, _ASKED = 3e-3, 1e-5  # residuals over the pressure's forces
_FIRST, _SMALLEST = 0.04, 2e-3  # steps, over the highest pressure asked for
_FEW, _MANY = 3, 7  # factorisations of a step, below and above which the next is longer, shorter
_FINE = 8  # places between two free states, where first touch is looked for
_BISECTIONS = 20
_FRICTION_PASSES = 2
_MOVE_IN_MM, _LEAST_IN_MM = 0.5, 0.05  # first and shortest step of an obstacle that comes near


@dataclass(frozen=True)
class Touch:
    """What an obstacle does to a tube at one pressure; forces are those of the whole tube.

    Attributes
    ----------
    pressed : Pressed
        Contact at the points of the mesh, half of it in a half model.
    depth : float, mm
        Of the deepest point in the obstacle.
    force : (3,) N
        On the obstacle.
    clamp : (3,) N
        Of the clamp on the tube: with the push of the air on the clamped opening and the
        obstacle's force on the tube it adds up to nothing.
    """

    pressed: Pressed
    depth: float
    force: FloatArray
    clamp: FloatArray


@dataclass(frozen=True)
class Contacts:
    """A run against an obstacle.

    Attributes
    ----------
    mesh : Mesh
    states : tuple of State
        At the pressures that were reached, rising. Their energy is the tube's own.
    touches : tuple of Touch
        Of the states.
    first_touch : float or None
        Pressure at which the free tube comes to the obstacle, MPa; None where it does not.
    failure : str or None
        Why pressures are missing.
    history : tuple of Attempt
    seconds : float
    """

    mesh: Mesh
    states: tuple[State, ...]
    touches: tuple[Touch, ...]
    first_touch: float | None
    failure: str | None
    history: tuple[Attempt, ...]
    seconds: float

    @property
    def factorisations(self) -> int:
        """How many factorisations the run took."""
        return sum(attempt.factorisations for attempt in self.history)


def solve_against(
    free: Solution,
    contact: Contact | Obstacle,
    pressures: Sequence[float],
    *,
    tolerance: float = _ASKED,
    settle: bool = True,
    threads: int = 2,
    progress: Callable[[float], None] | None = None,
) -> Contacts:
    """Press a tube against an obstacle.

    The run goes on from the last free state on whose way the tube lies hardly in the obstacle.

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
        When pressures make no sense, or half a tube meets an obstacle that is not symmetric.
    """
    asked = sorted({float(p) for p in pressures})
    if not asked or not all(np.isfinite(asked)) or asked[0] <= 0.0:
        raise ValueError("pressures must be finite numbers above 0")
    begun = time.perf_counter()
    touching = contact if isinstance(contact, Contact) else Contact(contact)
    touching.multiplier = touching.hold = None
    with blas.one_thread():
        run = _Run(free, touching, tolerance, threads, settle=settle)
        try:
            run.go(asked, progress)
        finally:
            run.system.close()
    return Contacts(
        free.mesh, tuple(run.states), tuple(run.touches), run.first_touch, run.failure,
        tuple(run.finder.history), time.perf_counter() - begun,
    )  # fmt: skip


class _Run:
    def __init__(
        self, free: Solution, contact: Contact, tolerance: float, threads: int, *, settle: bool
    ) -> None:
        self._free, self._contact = free, contact
        self._tolerance, self._settle = tolerance, settle
        self._mesh = free.mesh
        self.system = System(free.mesh, threads, [contact])
        self._chart = Chart(free.mesh)
        self._surface = Surface.of(free.mesh)
        self.finder = Finder(self.system, self._chart, contact)
        self.states: list[State] = []
        self.touches: list[Touch] = []
        self.failure: str | None = None
        self.first_touch: float | None = None
        self._last: list[Found] = []
        self._work = np.nan

    def go(self, asked: Sequence[float], progress: Callable[[float], None] | None) -> None:
        """Go through all pressures, as far as that is possible."""
        _check_symmetry(self._mesh, self._contact.obstacle)
        gap = self._contact.obstacle.gap(self._mesh.X[0, self._mesh.outer_ring])
        if gap.distance.min() < -_CLAMP_MM:
            self.failure = f"the clamped end lies {-gap.distance.min():.1f} mm deep in the object"
            return
        starts = self._starts(asked[0])
        if not self._begin(starts, asked[0]):
            return
        step = _FIRST * asked[-1]
        for target in asked:
            while (pressure := self._last[-1].pressure) < target * (1.0 - 1e-12):
                count = max(1, int(np.ceil((target - pressure) / step - 1e-6)))
                trial = target if count == 1 else pressure + (target - pressure) / count
                found = self._try(trial, count == 1)
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

    def _starts(self, most: float) -> list[State]:
        """Free states to begin at, best first; finds the first touch, too."""
        way = [s for s in self._free.states if s.pressure <= most * (1.0 + 1e-9)]
        good, stopped = [way[0]], False
        for before, after in pairwise(way):
            depths = self._depths(before, after)
            if self.first_touch is None and depths.max() > 0.0:
                self.first_touch = self._first(before, after, depths)
            stopped = stopped or bool(depths.max() > _LEAN_MM)
            if not stopped:
                good.append(after)
        return good[::-1]

    def _between(self, before: State, after: State) -> tuple[Pose, FloatArray]:
        first = self._chart.fitted(before.x)
        return first, self._chart.difference(first, self._chart.fitted(after.x))

    def _depth_at(self, pose: Pose) -> float:
        points = self._surface.points(pose.x.reshape(-1, 3)).reshape(-1, 3)
        points = points[self._contact.obstacle.near(points)]
        if not points.size:
            return -np.inf
        return -float(self._contact.obstacle.gap(points).distance.min())

    def _depths(self, before: State, after: State) -> FloatArray:
        """Depths on the way from one free state to the next, (k,) mm."""
        pose, way = self._between(before, after)
        shares = np.linspace(0.0, 1.0, _FINE + 1)[1:]
        return np.array([self._depth_at(self._chart.move(pose, t * way)) for t in shares])

    def _first(self, before: State, after: State, depths: FloatArray) -> float:
        """Pressure of the first touch between two free states, by bisection."""
        pose, way = self._between(before, after)
        k = int(np.argmax(depths > 0.0))
        low, high = k / _FINE, (k + 1) / _FINE
        for _ in range(_BISECTIONS):
            middle = 0.5 * (low + high)
            if self._depth_at(self._chart.move(pose, middle * way)) > 0.0:
                high = middle
            else:
                low = middle
        return before.pressure + high * (after.pressure - before.pressure)

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
        contact.lift = max(0.0, self._depth_at(pose))
        step, found = _MOVE_IN_MM, self.finder.find(pose, pressure, tolerance)
        while found is not None and (lift := contact.lift) > 0.0:
            contact.lift = max(0.0, lift - step)
            moved = self.finder.find(found.pose, pressure, tolerance)
            if moved is not None:
                found, step = moved, 2.0 * step
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
            return self._own_energy(found)
        pressed = pressed_of(self._contact, self._mesh, found.pose.x)
        points = self._surface.points(free.x.reshape(-1, 3)).reshape(-1, 3)
        depth = -self._contact.obstacle.gap(points).distance.reshape(pressed.pressure.shape)
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
        ends = [
            Equilibrium(
                f.pressure, f.pose, f.forces,
                float(f.forces.volume_gradient @ f.flow), f.residual, False, 0,
            )
            for f in self._last
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
            found = settled
        self._work += found.pressure * (found.forces.volume - before.forces.volume)
        self._last[-1] = found
        mesh, twice = self._mesh, 2.0 if self._mesh.half else 1.0
        pressed = pressed_of(self._contact, mesh, found.pose.x)
        own = replace(found.forces, energy=self._own_energy(found))
        state = state_of(
            mesh,
            Equilibrium(found.pressure, found.pose, own, np.nan, found.residual, True, 0),
            self._work,
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
        return True

    def _fail(self, pressure: float) -> None:
        reached = self._last[-1].pressure if self._last else 0.0
        self.failure = (
            f"no stable equilibrium found against the object at {10.0 * pressure:.3f} bar; the "
            f"last one is at {10.0 * reached:.3f} bar"
        )


def _check_symmetry(mesh: Mesh, obstacle: Obstacle) -> None:
    if not mesh.half:
        return
    x = mesh.X[:, mesh.outer_ring].reshape(-1, 3)
    ours, theirs = (obstacle.gap(x * [sign, 1.0, 1.0]).distance for sign in (1.0, -1.0))
    if np.abs(ours - theirs).max() > 1e-6 * mesh.actuator.diameter:
        raise ValueError("half a tube cannot meet an obstacle that is not symmetric about x = 0")
