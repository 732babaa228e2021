"""What can go wrong, each kind with what the caller needs to act on it."""

from __future__ import annotations

from dataclasses import dataclass


class FemError(Exception):
    """A failure of the finite-element model."""


class BadGeometry(FemError, ValueError):
    """No such actuator can exist, or none that this model describes; the message says why."""


@dataclass(frozen=True)
class Attempt:
    """One pressure that the solver tried.

    ``residual`` is relative to the pressure's nodal forces; ``outcome`` says in a word what came
    of it: "converged", "residual" (still too large), "inverted" (a brick turned inside out) or
    "unstable" (equilibrium, but not a stable one).
    """

    pressure: float
    iterations: int
    factorisations: int
    residual: float
    outcome: str


class NotConverged(FemError):
    """No equilibrium was found at an asked pressure.

    Attributes
    ----------
    history : tuple of Attempt
        All that was tried, in order.
    reached : float
        The highest pressure with a converged state, MPa.
    """

    def __init__(self, message: str, history: tuple[Attempt, ...], reached: float) -> None:
        super().__init__(message)
        self.history = history
        self.reached = reached
