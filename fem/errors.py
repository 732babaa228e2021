"""The errors of this package, each with what the caller needs to act on it.

FemError
    BadGeometry     no such actuator, or none that this model describes; a ValueError too
    NotConverged    no equilibrium at an asked pressure; carries the states that were reached
"""

from __future__ import annotations

from dataclasses import dataclass


class FemError(Exception):
    """A failure of the finite-element model."""


class BadGeometry(FemError, ValueError):
    """No such actuator can exist, or none that this model describes; the message says why."""


@dataclass(frozen=True)
class Attempt:
    """One pressure that the solver tried.

    Attributes
    ----------
    pressure : float, MPa
    iterations, factorisations : int
        Newton steps, and factorisations of the tangent.
    residual : float
        Unbalanced forces over the pressure's.
    outcome : {"converged", "residual", "inverted", "unstable"}
        The last three: the residual stayed too large, a brick turned inside out, an equilibrium
        but not a stable one.
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
    solution : fem.solution.Solution or None
        The states that were reached, at rest and at asked pressures; None where nobody kept them.
    """

    def __init__(
        self,
        message: str,
        history: tuple[Attempt, ...],
        reached: float,
        solution: object = None,
    ) -> None:
        super().__init__(message)
        self.history = history
        self.reached = reached
        self.solution = solution

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle all of it: a campaign's runs raise in processes of their own."""
        return type(self), (str(self), self.history, self.reached, self.solution)
