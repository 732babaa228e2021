"""Equilibria of a tube against an obstacle at one pressure: Newton downhill, then multipliers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem.arrays import FloatArray
from fem.assembly import Forces, Inverse, System
from fem.contact import Contact, pressed_of
from fem.errors import Attempt
from fem.newton import NEAR, SURE, TIGHT, relative_residual
from fem.sections import Chart, Pose
from fem.slack import Switching

DEPTH_MM = 0.01  # that a reported state may lie in the obstacle
_MOST = 25  # factorisations after which a start is given up
_PASSES = 6  # of multipliers
_TURN = 0.3  # rad, the most that a section turns in one step
_MOVE_MM = 4.0  # the most that a node moves in one step
_DECREASE = 1e-4  # of the energy, over what its slope promises
_SHORTENINGS = 9
_ROUNDING = 1e-12  # of the energy


@dataclass(frozen=True)
class Found:
    """A state in equilibrium with an obstacle.

    Attributes
    ----------
    pressure : float, MPa
    pose : Pose
    forces : Forces
    flow : (count,) mm/MPa
        Change of the unknowns with the pressure, the contact kept.
    residual : float
        Over the pressure's forces.
    factored : int
        Factorisations that it took.
    """

    pressure: float
    pose: Pose
    forces: Forces
    flow: FloatArray
    residual: float
    factored: int


class Finder:
    """Finds equilibria of one system whose last item is contact.

    Attributes
    ----------
    history : list of Attempt
        All that was tried so far.
    """

    def __init__(self, system: System, chart: Chart, contact: Contact) -> None:
        self._system, self.chart, self._contact = system, chart, contact
        self.history: list[Attempt] = []

    def potential(self, pose: Pose, pressure: float) -> float:
        """Potential energy at a pose, N mm; infinite where a brick is turned inside out."""
        forces = self._system.forces(pose.x)
        if not forces.least_J > 0.0:
            return np.inf
        return forces.energy - pressure * forces.volume

    def find(self, pose: Pose, pressure: float, tolerance: float) -> Found | None:
        """Go downhill from a pose to a stable equilibrium; None where none is found.

        Newton's steps, shortened until the potential energy sinks as it should: contact that
        closes or opens within a step then does no harm.
        """
        system, outcome, residual = self._system, "residual", np.inf
        iterations = factored = 0
        found = None
        tight = tolerance < TIGHT
        while factored < _MOST:
            double = tight and residual < NEAR
            forces, inverse = system.factor(pose.x, pressure, double=double)
            factored += 1
            if inverse is None:
                outcome = "inverted"
                break
            residual = relative_residual(forces, pressure)
            if residual > tolerance or inverse.negative:
                moved = self._step(pose, pressure, forces, inverse)
                if moved is None:
                    outcome = "unstable" if residual <= tolerance else outcome
                    break
                pose, forces = moved
                iterations += 1
                residual = relative_residual(forces, pressure)
            # As in `fem.newton.correct`: single precision may leave a soft motion over.
            enough = tolerance if double or not tight else SURE * tolerance
            if residual <= enough and not inverse.negative:
                outcome = "converged"
                flow = inverse.solve(forces.volume_gradient)
                found = Found(pressure, pose, forces, flow, residual, factored)
                break
        self.history.append(Attempt(pressure, iterations, factored, residual, outcome))
        return found

    def _step(
        self, pose: Pose, pressure: float, forces: Forces, inverse: Inverse
    ) -> tuple[Pose, Forces] | None:
        system, chart = self._system, self.chart
        rhs = -forces.residual(pressure)
        if inverse.negative:
            du = inverse.solve(rhs, positive=True)
        else:
            du = Switching(system, inverse, pose.x).solve(rhs)
        motion = system.expand(pose.x, du)
        increment = chart.increment(pose, motion)
        turn = float(np.abs(chart.spins(increment)).max())
        # A turn carries the nodes behind it far: they count without it.
        local = float(np.abs(increment[chart.spins(increment).size :]).max())
        share = min(1.0, _TURN / max(turn, 1e-12), _MOVE_MM / max(local, 1e-12))
        slope, energy = float(rhs @ du), forces.energy - pressure * forces.volume
        for _ in range(_SHORTENINGS):
            moved = chart.move(pose, share * increment)
            new = system.forces(moved.x)
            # Near the bottom the change is lost in the rounding of the energy itself.
            allowed = energy - _DECREASE * share * slope + _ROUNDING * abs(energy)
            if new.least_J > 0.0 and new.energy - pressure * new.volume <= allowed:
                return moved, new
            share *= 0.4
        return None

    def settle(self, found: Found, tolerance: float) -> tuple[Found, float] | None:
        """Pass the depth on to the multipliers, until a state lies less than `DEPTH_MM` deep.

        Returns
        -------
        (Found, float) or None
            The state, deeper where multipliers do not help in a few passes, and the work that the
            obstacle does as they push the tube out, N mm; None where an equilibrium is lost.
        """
        mesh, contact, work = self._system.mesh, self._contact, 0.0
        pressed = pressed_of(contact, mesh, found.pose.x)
        for _ in range(_PASSES):
            if pressed.own_depth <= DEPTH_MM:
                break
            before = contact.offset
            contact.update(pressed)
            better = self.find(found.pose, found.pressure, tolerance)
            if better is None:
                return None
            found, last = better, pressed
            pressed = pressed_of(contact, mesh, found.pose.x)
            assert contact.offset is not None
            rise = contact.offset - (0.0 if before is None else before)
            mean = 0.5 * (last.pressure + pressed.pressure)
            work += float((pressed.area * mean * rise).sum())
        return found, work
