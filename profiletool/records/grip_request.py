"""Request: what is asked of the finger on its object."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from profiletool.errors import UsageError

Solid = Literal["auto", "turned", "extruded"]
FRICTION = tuple(round(0.1 * k, 1) for k in range(11))
MOST_FINGERS, MOST_FRICTION = 12, 2.0


@dataclass(frozen=True)
class OnObject:
    """How a design is pressed on its object.

    Attributes
    ----------
    pressed : bool
        Whether finite elements press the verified actuator on it.
    force_N : float or None
        Normal force to work with; None for the least expected misfit.
    solid, clearance_mm
        As in `GripRequest`.
    """

    pressed: bool = True
    force_N: float | None = None
    solid: Solid = "auto"
    clearance_mm: float = 0.0


@dataclass(frozen=True)
class GripRequest:
    """What is asked of a finger on its object.

    Attributes
    ----------
    pressures_bar : tuple of float
        Empty for the design's own and some above it.
    friction : tuple of float
        Coefficients to tell the payload at.
    fingers : int
        Evenly around the object's axis.
    solid : {"auto", "turned", "extruded"}
        The profile turned about the object's axis, or the same at every depth.
    clearance_mm : float
        That the profile keeps from the object.
    max_contact_kpa : float or None
        Contact pressure that the object bears.
    against : str or None
        Something else in place of the object: "plane:X,Y,DEG" through a point, its normal pointing
        so many degrees counter-clockwise from x; "cylinder:X,Y,R" across the picture, or
        "sphere:X,Y,R"; mm, object frame.
    free_N : float or None
        Weight of the object, which is let go at every pressure; None where it stays.

    Raises
    ------
    UsageError
        When a value makes no sense.
    """

    pressures_bar: tuple[float, ...] = ()
    friction: tuple[float, ...] = FRICTION
    fingers: int = 3
    solid: Solid = "auto"
    clearance_mm: float = 0.0
    max_contact_kpa: float | None = None
    against: str | None = None
    free_N: float | None = None

    def __post_init__(self) -> None:
        if not all(math.isfinite(bar) and bar > 0.0 for bar in self.pressures_bar):
            raise UsageError("`pressures_bar` must be numbers above 0")
        if not all(0.0 <= mu <= MOST_FRICTION for mu in self.friction):
            raise UsageError(f"`friction` must be 0 to {MOST_FRICTION:g}")
        if not 1 <= self.fingers <= MOST_FINGERS:
            raise UsageError(f"`fingers` must be 1 to {MOST_FINGERS}, not {self.fingers}")
        if not (math.isfinite(self.clearance_mm) and self.clearance_mm >= 0.0):
            raise UsageError(f"`clearance_mm` must be 0 or more, not {self.clearance_mm:g}")
        most = self.max_contact_kpa
        if most is not None and not (math.isfinite(most) and most > 0.0):
            raise UsageError(f"`max_contact_kpa` must be above 0, not {most:g}")
        if self.free_N is not None:
            self._check_free(self.free_N)

    def _check_free(self, weight_N: float) -> None:
        if not (math.isfinite(weight_N) and weight_N >= 0.0):
            raise UsageError(f"`free_N` must be 0 or more, not {weight_N:g}")
        if self.fingers < 2:
            raise UsageError(
                "`free_N`: one finger has nothing to hold an object against; take 2 `fingers` or "
                "more"
            )
        if self.against is not None:
            raise UsageError("`free_N` lets the object go, so leave out `against`")
