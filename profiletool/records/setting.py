"""Angles read at a finished actuator, and the pressure to set on it."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class AngleReading:
    """The angle of a joint of a finished actuator, as it was measured.

    Attributes
    ----------
    pressure_bar : float
        At which it was measured.
    joint : int
        From 1, from the clamped end on.
    theta_deg : float
        Positive toward the object; where the joint bends away from it, a magnitude will do.
    sigma_deg : float
        Standard deviation of the reading.
    time_s : float or None
        When it was read, where that is known.
    """

    pressure_bar: float
    joint: int
    theta_deg: float
    sigma_deg: float = 1.0
    time_s: float | None = None


@dataclass(frozen=True)
class PressureSetting:
    """The pressure at which a finished actuator fits.

    Attributes
    ----------
    pressure_bar : float
        To set, in steps of 0.01 bar.
    planned_bar : float
        Of the design.
    stiffness : float
        Of the actuator, over the nominal one's: at a pressure it stands where the nominal one
        does at the pressure over this.
    off_mm : float or None
        Distance of the measured tip from the way of the nominal one; None where angles were read.
    rms_deg : float or None
        Of what remains of the angles; None where the tip was measured.
    fit_mm : float or None
        RMS off the profile, as finite elements of the calibrated tube have it; None elsewhere.
    dead_bar : float
        Of ``pressure_bar``: what the gauge reads too much.
    joints_off : tuple of int
        Joints that bend otherwise than the others let expect.
    beyond : bool
        Whether it was measured beyond the trim table, so that the pressure is but the next to try.
    operate_bar : float or None
        To work at against the object; None where the design says nothing of it, or it was measured
        beyond the table.
    notes : tuple of str
        What its user should know.
    """

    pressure_bar: float
    planned_bar: float
    stiffness: float
    off_mm: float | None = None
    rms_deg: float | None = None
    fit_mm: float | None = None
    dead_bar: float = 0.0
    joints_off: tuple[int, ...] = ()
    beyond: bool = False
    operate_bar: float | None = None
    notes: tuple[str, ...] = ()
