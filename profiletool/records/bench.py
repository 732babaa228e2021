"""An actuator on the bench: what is predicted, what its pictures show, how the two agree."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from profiletool.records.frames import Shape
from profiletool.records.units import FloatArray

State = Literal["measured", "by hand", "lost"]


@dataclass(frozen=True)
class Predicted:
    """An actuator at rising pressures, as a model has it; n states, J joints.

    Attributes
    ----------
    pressure_bar : (n,)
        The first is 0.
    theta_deg : (n, J)
        Positive toward the object.
    shapes : tuple of Shape
        One for each state, at the same places along the tube.
    windows_mm : (J, 2)
        Where each cut starts and ends along the tube.
    sign : float
        +1 where a turn toward the object is counter-clockwise, y up (see `Profile.sign`).
    heading_deg : float
        Of the clamped end, in the shapes' frame.
    error_share : float
        By how much of themselves turns may run otherwise along the tube: what an angle that is
        read with this model is uncertain by.
    """

    pressure_bar: FloatArray
    theta_deg: FloatArray
    shapes: tuple[Shape, ...]
    windows_mm: FloatArray
    sign: float
    heading_deg: float
    error_share: float = 0.003


@dataclass(frozen=True)
class Angle:
    """The angle of a joint in a picture; NaN where it is lost.

    Attributes
    ----------
    theta_deg, sigma_deg : float
        Positive toward the object; standard deviation.
    state : {"measured", "by hand", "lost"}
    """

    theta_deg: float
    sigma_deg: float
    state: State


@dataclass(frozen=True)
class Seen:
    """An actuator as one picture shows it.

    Attributes
    ----------
    picture : str
        Its name.
    pressure_bar : float
    angles : tuple of Angle
        Joint by joint.
    outline_px : (2, S, 2)
        Both lines of the fitted tube in the picture, facing first; S places along the tube.
    predicted_px : (2, S, 2)
        The same as the model has the tube at that pressure, from the clamp as it is seen.
    edges_px : (N, 2)
        Edges that were believed.
    sectors_px : (J + 1, 2, 2)
        Ends of the middle line of every wrapped sector.
    phalanges_mm : (J + 1, 2)
        Middles of the wrapped sectors: x along the clamped tube, y toward the object.
    mm_per_px : float
        At the clamp.
    rms_px : float
        Of the believed edges about the fitted lines.
    time_s : float or None
        When the picture was taken, where that is known.
    """

    picture: str
    pressure_bar: float
    angles: tuple[Angle, ...]
    outline_px: FloatArray
    predicted_px: FloatArray
    edges_px: FloatArray
    sectors_px: FloatArray
    phalanges_mm: FloatArray
    mm_per_px: float
    rms_px: float
    time_s: float | None = None


@dataclass(frozen=True)
class Agreement:
    """How measured angles agree with a model's: ``measured = slope * model + intercept``.

    Attributes
    ----------
    count : int
    r2 : float
        Alone it says little: a model that is 30 % too stiff has nearly 1.
    slope, intercept_deg : float
    rmse_deg, bias_deg : float
        Of measured less model.
    limits_deg : (low, high)
        Limits of agreement: bias -+ 1.96 standard deviations.
    """

    count: int
    r2: float
    slope: float
    intercept_deg: float
    rmse_deg: float
    bias_deg: float
    limits_deg: tuple[float, float]
