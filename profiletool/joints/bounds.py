"""Bounds on a plan of joints: wrapped sectors, pressures, cuts, uncut sectors, base pose."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from formula.errors import OutOfRange
from profiletool.bending.model import Model
from profiletool.records.request import PRESSURE_STEP_BAR, TubeSpec
from profiletool.records.units import BAR_PER_MPA, FloatArray

BASE_TURN_RAD, BASE_OFFSET_MM = float(np.radians(15.0)), 3.0


def limits_of(model: Model, spec: TubeSpec, base_free: bool = False) -> Limits:
    """Bounds that the tube, the gauze and the model set.

    Parameters
    ----------
    model : Model
    spec : TubeSpec
    base_free : bool
        Whether the base may leave the profile's start tangent, by up to `BASE_TURN_RAD` and
        `BASE_OFFSET_MM`.
    """
    low, high = model.pressure
    high = max(min(high, spec.max_pressure_bar / BAR_PER_MPA), low)
    if spec.pressure_bar is not None:
        low = high = spec.pressure_bar / BAR_PER_MPA
    return Limits(
        alpha=model.alpha,
        pressure=(low, high),
        wrap_mm=wrap_mm(spec),
        end_mm=END_WRAP_MM,
        root_mm=spec.root_mm,
        max_length_mm=spec.max_length_mm,
        base_turn_rad=BASE_TURN_RAD if base_free else 0.0,
        base_offset_mm=BASE_OFFSET_MM if base_free else 0.0,
    )


def cuts_of(model: Model, spec: TubeSpec) -> FloatArray:
    """Give the cuts in whole meshes that the model holds for, mm.

    Raises
    ------
    formula.errors.OutOfRange
        When there is none.
    """
    (low, high), pitch = model.openF, spec.pitch_mm
    cuts = np.arange(np.ceil(low / pitch - 1e-9), np.floor(high / pitch + 1e-9) + 1.0) * pitch
    if cuts.size == 0:
        raise OutOfRange(
            f"no whole number of {pitch:g} mm meshes lies within the {low:g} to {high:g} mm of "
            "openF that the joints are known for"
        )
    return np.asarray(cuts, dtype=float)


PRESSURE_STEP = PRESSURE_STEP_BAR / BAR_PER_MPA
WRAP_MM = 2.0  # least wrapped length between two windows, and at least one mesh
END_WRAP_MM = 4.0  # least wrapped length at the closed end: the paper's mould leaves 4 mm there


def wrap_mm(spec: TubeSpec) -> float:
    """Least wrapped length between two windows."""
    return max(WRAP_MM, spec.pitch_mm)


@dataclass(frozen=True)
class Limits:
    """Bounds that the tube, the gauze and the user set.

    Attributes
    ----------
    alpha, pressure : (float, float)
        rad, MPa.
    wrap_mm, end_mm, root_mm : float
        Least wrapped length between two windows and at the closed end; least distance of the
        first joint's centre from the clamped end.
    max_length_mm : float
    base_turn_rad, base_offset_mm : float
        How far the base may turn away from the profile's start tangent and lie off it, either
        way; both 0 where it is fixed.
    """

    alpha: tuple[float, float]
    pressure: tuple[float, float]
    wrap_mm: float
    end_mm: float
    root_mm: float
    max_length_mm: float
    base_turn_rad: float = 0.0
    base_offset_mm: float = 0.0

    @property
    def base_free(self) -> bool:
        """Whether the base may leave the profile's start tangent."""
        return self.base_turn_rad > 0.0 or self.base_offset_mm > 0.0
