"""An obstacle that is let go: where it comes to rest, by Newton's method on the bordered system."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from fem.arrays import FloatArray
from fem.assembly import System
from fem.body import Body, Moved, border_of
from fem.contact import Contact, Pressed, pressed_of
from fem.downhill import Finder, Found
from fem.sections import Pose

End = Literal["rests", "leaves", "lost"]

_BALANCE_N = 1e-7  # of the force on an obstacle at rest
_ROUGH, _FINE = 3e-3, 1e-9  # residuals over the pressure's forces, on the way and at rest
_NEAR_N = 1e-3  # from balance, where the fine one is taken
_STEP_MM, _LEAST_MM, _MOST_MM = 0.5, 1e-3, 2.0  # first, shortest and longest motion at a time
_SOFT = 1e-6  # N/mm, of a motion that nothing resists
_MOST, _SETTLINGS = 60, 4


@dataclass(frozen=True)
class Released:
    """An obstacle that was let go at one pressure.

    Attributes
    ----------
    motion : (3,)
        Along y and z, mm, and about x, rad; so far as it was followed.
    end : {"rests", "leaves", "lost"}
        Whether it comes to rest on the tube, or is pushed off it; lost where the tube finds no
        equilibrium on the way.
    unbalanced : float, N
        What force is left over on it (along its ways, of the whole tube).
    pressed : Pressed
        Contact at the end.
    x : (layers + 1, ring + mid, 3) mm
        Nodes at the end.
    """

    motion: FloatArray
    end: End
    unbalanced: float
    pressed: Pressed
    x: FloatArray


def let_go(finder: Finder, system: System, contact: Contact, found: Found, body: Body) -> Released:
    """Let the obstacle of a state in contact go, and leave contact as it was.

    Parameters
    ----------
    finder : Finder
    system : System
    contact : Contact
        Without friction.
    found : Found
        With the obstacle in its place.
    body : Body
    """
    obstacle, offset = contact.obstacle, contact.offset
    try:
        return _Fall(finder, system, contact, body).follow(found)
    finally:
        contact.obstacle, contact.offset = obstacle, offset


@dataclass(frozen=True)
class _Place:
    """A place q of the obstacle, and the tube's equilibrium there."""

    q: FloatArray
    found: Found
    energy: float


@dataclass(frozen=True)
class _Step:
    """A step of Newton's on the bordered system.

    Attributes
    ----------
    off : float, N
        That the obstacle is off balance.
    stable : bool
    q : (k,)
    u : (count,)
        Of the tube.
    """

    off: float
    stable: bool
    q: FloatArray
    u: FloatArray


class _Fall:
    def __init__(self, finder: Finder, system: System, contact: Contact, body: Body) -> None:
        self._finder, self._system, self._contact = finder, system, contact
        self._body, self._obstacle = body, contact.obstacle
        self._share = 0.5 if system.mesh.half else 1.0
        self._load = self._share * body.ways @ body.load

    def _motion(self, q: FloatArray) -> FloatArray:
        return np.asarray(q @ self._body.ways)

    def _move_to(self, q: FloatArray) -> None:
        self._contact.obstacle = Moved(self._obstacle, self._motion(q), self._body.about)

    def _at(self, q: FloatArray, pose: Pose, pressure: float, tolerance: float) -> _Place | None:
        """Find the tube's equilibrium with the obstacle at q."""
        self._move_to(q)
        found = self._finder.find(pose, pressure, tolerance)
        return None if found is None else self._placed(q, found)

    def _placed(self, q: FloatArray, found: Found) -> _Place:
        energy = found.forces.energy - found.pressure * found.forces.volume
        return _Place(q, found, energy - float(self._load @ q))

    def _step(self, place: _Place) -> _Step | None:
        """Solve the bordered system at a place; downhill where it is not stable."""
        system, found, body = self._system, place.found, self._body
        x = found.pose.x
        forces, inverse = system.factor(x, found.pressure)
        if inverse is None:
            return None
        border = border_of(self._contact, system.mesh, x, body, self._motion(place.q))
        B = np.array([system.restrict(x, rows) for rows in border.mixed])
        residual = forces.residual(found.pressure)
        solved = inverse.solve(np.vstack([B, residual]))
        left = border.slope - self._load
        values, vectors = np.linalg.eigh(border.curve - B @ solved[:-1].T)
        down = vectors.T @ (B @ solved[-1] - left)
        off, stable = float(np.abs(left).max()) / self._share, bool(values[0] > -_SOFT)
        if off < _BALANCE_N and not stable:  # on the top of a hill: off it
            down[0] = np.copysign(_STEP_MM * values[0], down[0])
        q = vectors @ (down / np.maximum(np.abs(values), _SOFT))
        return _Step(off, stable, q, -solved[-1] - q @ solved[:-1])

    def follow(self, found: Found) -> Released:
        """Go downhill with the obstacle until it rests, or has left the tube."""
        place, size, settlings = self._placed(np.zeros(len(self._load)), found), _STEP_MM, 0
        fine, off = False, np.inf
        end: End = "lost"
        for _ in range(_MOST):
            step = self._step(place)
            if step is None:
                break
            off = step.off
            if self._left(place):
                end = "leaves"
                break
            if off < _BALANCE_N and fine and step.stable:
                settled = self._finder.settle(place.found, _FINE)
                if settled is None or settled[0] is place.found or settlings == _SETTLINGS:
                    end = "rests"
                    break
                place, settlings = self._placed(place.q, settled[0]), settlings + 1
                continue
            fine = off < _NEAR_N
            new = None
            while new is None and size > _LEAST_MM:
                new = self._moved(place, step, size, fine=fine)
                size = 0.4 * size if new is None else min(2.0 * size, _MOST_MM)
            if new is None:
                break
            place = new
        return self._released(place, end, off)

    def _moved(self, place: _Place, step: _Step, size: float, *, fine: bool) -> _Place | None:
        """Take a step of at most a size; None where it leads nowhere or uphill."""
        share = min(1.0, size / max(float(np.abs(step.q).max()), 1e-300))
        chart, pose = self._finder.chart, place.found.pose
        du = self._system.expand(pose.x, share * step.u)
        pose = chart.move(pose, chart.increment(pose, du))
        new = self._at(
            place.q + share * step.q, pose, place.found.pressure, _FINE if fine else _ROUGH
        )
        uphill = new is not None and not fine and new.energy > place.energy
        return None if uphill else new

    def _left(self, place: _Place) -> bool:
        """Whether it is further off than a tube is wide, or free of it without any load."""
        mesh = self._system.mesh
        if float(np.abs(self._motion(place.q)[:2]).max()) > mesh.actuator.diameter:
            return True
        pressed = pressed_of(self._contact, mesh, place.found.pose.x)
        touching = float((pressed.area * pressed.pressure).sum()) > _BALANCE_N
        return not touching and not self._load.any()

    def _released(self, place: _Place, end: End, off: float) -> Released:
        self._move_to(place.q)  # a step that led nowhere may have left it elsewhere
        x = place.found.pose.x
        pressed = pressed_of(self._contact, self._system.mesh, x)
        return Released(self._motion(place.q), end, off, pressed, x)
