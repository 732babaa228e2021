"""Results of the finger on its object: forces, contact pressure, payload."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from profiletool.errors import UsageError
from profiletool.records.frames import Shape
from profiletool.records.units import FloatArray

Solid = Literal["auto", "turned", "extruded"]
FRICTION = tuple(round(0.1 * k, 1) for k in range(11))
MOST_FINGERS, MOST_FRICTION = 12, 2.0


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


@dataclass(frozen=True)
class Pad:
    """Where one finger presses on its object, in the object's frame: n points.

    Attributes
    ----------
    points : (n, 3) mm
        x and y of the picture, z toward its viewer.
    force : (n, 3) N
        On the object, normal to it.
    kPa : (n,)
        Contact pressure, the mean over a disc of 2 mm radius.
    """

    points: FloatArray
    force: FloatArray
    kPa: FloatArray

    @property
    def mean_kPa(self) -> float:
        """Mean pressure, each point with its force."""
        size = np.linalg.norm(self.force, axis=1)
        return float(size @ self.kPa / size.sum()) if size.any() else 0.0


@dataclass(frozen=True)
class GripState:
    """A finger on its object at one pressure.

    Forces are those on the object. The sector that the clamp holds is left out of them but for
    ``clamped_N``: it presses whatever the clamp makes it press.

    Attributes
    ----------
    pressure_bar : float
    normal_N : float
        Sum of all normal forces.
    radial_N, axial_N : float
        Of their resultant: toward the object's axis, and along it, positive upward in the picture.
    peak_kPa, mean_kPa : float
        Contact pressure of the pad: the largest, and the mean by force.
    contact_share : float
        Of the tube's length, that touches.
    misfit_rms_mm, misfit_max_mm : float
        Of the object-facing line.
    joint_normal_N : tuple of float
        Normal force of every joint: its cut and the wrapped sector behind it.
    clamped_N : float
        Normal force of the sector before the first cut.
    clamp_N : (float, float)
        Force of the clamp on the tube along it and away from the object, without the push of the
        air on the clamped opening.
    depth_mm : float
        Of the deepest point in the object.
    energy_error : float
    shape : Shape
    theta_deg : tuple of float
        Of every joint, positive toward the object.
    air_ml : float
        That went in since rest.
    pad : Pad
    """

    pressure_bar: float
    normal_N: float
    radial_N: float
    axial_N: float
    peak_kPa: float
    mean_kPa: float
    contact_share: float
    misfit_rms_mm: float
    misfit_max_mm: float
    joint_normal_N: tuple[float, ...]
    clamped_N: float
    clamp_N: tuple[float, float]
    depth_mm: float
    energy_error: float
    shape: Shape
    theta_deg: tuple[float, ...]
    air_ml: float
    pad: Pad


@dataclass(frozen=True)
class Payload:
    """What fingers around an object carry, at the highest pressure.

    Attributes
    ----------
    fingers : int
    pressure_bar : float
    friction : tuple of float
        Coefficients.
    load_N : tuple of float
        Largest weight at each; 0 where the fingers push the object out.
    tilt_Nmm : tuple of float
        Largest moment about any level axis through the middle of the contact, without weight.
    undercut_N : float
        What the normal forces alone carry; negative where they push the object out.
    """

    fingers: int
    pressure_bar: float
    friction: tuple[float, ...]
    load_N: tuple[float, ...]
    tilt_Nmm: tuple[float, ...]
    undercut_N: float


@dataclass(frozen=True)
class Grip:
    """A finger on its object at rising pressures.

    Attributes
    ----------
    solid : {"turned", "extruded", "plane", "cylinder", "sphere"}
        What the profile was made an object by, or what was met in its place.
    states : tuple of GripState
    asked_bar : float
        The highest pressure asked for.
    first_touch_bar : float or None
        Pressure at which the free finger comes to the object; None where it does not.
    failure : str or None
        Why pressures are missing.
    factorisations : int
    seconds : float
    payload : Payload or None
        None where nothing touches, or something else was met.
    """

    solid: str
    states: tuple[GripState, ...]
    asked_bar: float
    first_touch_bar: float | None
    failure: str | None
    factorisations: int
    seconds: float
    payload: Payload | None = None

    @property
    def converged(self) -> bool:
        """Whether every asked pressure was reached."""
        return self.failure is None
