"""Results of finite elements: states, the critical point, the verification."""

from __future__ import annotations

from dataclasses import dataclass

from profiletool.records.frames import Shape
from profiletool.records.units import FloatArray


@dataclass(frozen=True)
class CriticalPoint:
    """Where the path of equilibria ends.

    ``kind`` is "limit point" or "bifurcation", or "no equilibrium" where none was found beyond
    this pressure and no reason is known.
    """

    kind: str
    pressure_bar: float


@dataclass(frozen=True)
class FeState:
    """An actuator at one pressure, by finite elements.

    Attributes
    ----------
    pressure_bar : float
    theta_deg : tuple of float
        Of every joint, positive toward the object.
    shape : Shape
    phalanges : (joints + 1, 2) mm, object frame
        Midpoints of the wrapped sectors, the clamped one first.
    air_ml : float
        Volume gained since rest, at the tube's own pressure.
    joint_stretch : tuple of float
        Stretch of the rubber at every joint, in the mean over the most stretched piece of it; see
        `fem.measure.stretches`.
    largest_stretch, least_J : float
        Of the rubber: the same anywhere, and the smallest change of volume.
    slack_share : float
        Of the wrapped surface: where axial threads are slack.
    thread_N : float
        Largest force in a single thread.
    residual, energy_error : float
        Unbalanced forces over the pressure's; stored energy off the pressure's work, over it.
    touches : bool
        Whether the tube runs into itself; the model has no contact.
    overlap_mm : float
        How deep.
    joint_bulge : tuple of float
        By how much the surface stands out at every joint, over the tube's radius.
    """

    pressure_bar: float
    theta_deg: tuple[float, ...]
    shape: Shape
    phalanges: FloatArray
    air_ml: float
    joint_stretch: tuple[float, ...]
    largest_stretch: float
    least_J: float
    slack_share: float
    thread_N: float
    residual: float
    energy_error: float
    touches: bool
    overlap_mm: float = 0.0
    joint_bulge: tuple[float, ...] = ()


@dataclass(frozen=True)
class Verification:
    """What finite elements say of an actuator.

    Attributes
    ----------
    rest : FeState
    states : tuple of FeState
        At the asked pressures that were reached, in rising order.
    asked_bar : float
        The highest pressure asked for.
    critical : CriticalPoint or None
        What ended the path before that.
    elements, nodes, dofs, newton_iterations : int
    seconds : float
    failure : str or None
        Why no state was found beyond those, where no critical point ended the path.
    ahead : CriticalPoint or None
        What ends the path beyond the pressure asked for, as far as the run looked.
    theta_uncertain : tuple of int
        Numbers of the joints that are too near to each other for an angle each.
    breaks : float or None
        Stretch at which the rubber breaks; None where nothing tells.
    """

    rest: FeState
    states: tuple[FeState, ...]
    asked_bar: float
    critical: CriticalPoint | None
    elements: int
    nodes: int
    dofs: int
    newton_iterations: int
    seconds: float
    failure: str | None = None
    ahead: CriticalPoint | None = None
    theta_uncertain: tuple[int, ...] = ()
    breaks: float | None = None

    @property
    def converged(self) -> bool:
        """Whether every asked pressure was reached."""
        return self.critical is None and self.failure is None

    @property
    def last(self) -> FeState:
        """The state at the highest pressure that was reached."""
        return self.states[-1] if self.states else self.rest

    @property
    def pressures_bar(self) -> tuple[float, ...]:
        """The pressures of the states."""
        return tuple(state.pressure_bar for state in self.states)

    @property
    def theta_deg(self) -> tuple[tuple[float, ...], ...]:
        """Angles of every joint, one for each state."""
        columns = range(len(self.rest.theta_deg))
        return tuple(tuple(state.theta_deg[k] for state in self.states) for k in columns)
