"""The results of a run against an obstacle."""

from __future__ import annotations

from dataclasses import dataclass

from fem.arrays import FloatArray
from fem.contact import Pressed
from fem.errors import Attempt
from fem.mesh import Mesh
from fem.release import Released
from fem.solution import Solution, State


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
    free : Solution
        The run without the obstacle.
    states : tuple of State
        At the pressures that were reached, rising. Their energy is the tube's own.
    touches : tuple of Touch
        Of the states.
    first_touch : float or None
        Pressure at which the free tube comes to the obstacle, MPa; None where it does not.
    failure : str or None
        Why pressures are missing.
    released : tuple of Released
        What became of the obstacle that was let go in each state; empty where it stays.
    history : tuple of Attempt
    seconds : float
    """

    free: Solution
    states: tuple[State, ...]
    touches: tuple[Touch, ...]
    first_touch: float | None
    failure: str | None
    history: tuple[Attempt, ...]
    seconds: float
    released: tuple[Released, ...] = ()

    @property
    def mesh(self) -> Mesh:
        """The mesh of both runs."""
        return self.free.mesh

    @property
    def factorisations(self) -> int:
        """How many factorisations the run took."""
        return sum(attempt.factorisations for attempt in self.history)
