"""Results of the finger on its object: forces, contact pressure, payload."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np

from profiletool.records.frames import Shape
from profiletool.records.units import FloatArray


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
class LetGo:
    """The object, let go at one pressure: fingers all around leave it its axis to move along.

    Attributes
    ----------
    moved_mm : float
        Upward in the picture, so far as it was followed.
    end : {"rests", "leaves", "lost"}
        Whether it comes to rest, or leaves the fingers; lost where no equilibrium of the finger
        was found on its way.
    normal_N : float
        Sum of all normal forces of one finger there.
    unbalanced_N : float
        Force along the axis that is left over, of one finger and its share of the weight.
    """

    moved_mm: float
    end: Literal["rests", "leaves", "lost"]
    normal_N: float
    unbalanced_N: float


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
    let_go : LetGo or None
        None where the object stays.
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
    let_go: LetGo | None = None


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

    def normal_at(self, bar: float) -> float:
        """Interpolate the normal force at a pressure within the run, N."""
        bars, forces = zip(*((s.pressure_bar, s.normal_N) for s in self.states), strict=True)
        return float(np.interp(bar, bars, forces))

    def bar_at(self, force_N: float) -> float:
        """Find the lowest pressure with a normal force, bar; infinite where none has it."""
        if self.states[0].normal_N >= force_N:
            return self.states[0].pressure_bar
        for before, after in pairwise(self.states):
            if before.normal_N < force_N <= after.normal_N:
                share = (force_N - before.normal_N) / (after.normal_N - before.normal_N)
                return before.pressure_bar + share * (after.pressure_bar - before.pressure_bar)
        return np.inf

    @property
    def converged(self) -> bool:
        """Whether every asked pressure was reached."""
        return self.failure is None
