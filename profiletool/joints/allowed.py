"""What the tube, the gauze, the model and the user allow a choice of joints."""

from __future__ import annotations

import numpy as np

from formula.errors import OutOfRange
from profiletool.joints.assign import END_WRAP_MM, wrap_mm
from profiletool.joints.model import Model
from profiletool.joints.parameters import Limits
from profiletool.records import FloatArray, Material

BASE_TURN_RAD, BASE_OFFSET_MM = float(np.radians(15.0)), 3.0
BAR_PER_MPA = 10.0


def limits_of(model: Model, material: Material, base_free: bool = False) -> Limits:
    """Say what the tube, the gauze and the model allow."""
    low, high = model.pressure
    return Limits(
        alpha=model.alpha,
        pressure=(low, max(min(high, material.max_pressure_bar / BAR_PER_MPA), low)),
        wrap_mm=wrap_mm(material),
        end_mm=END_WRAP_MM,
        root_mm=material.root_mm,
        max_length_mm=material.max_length_mm,
        base_turn_rad=BASE_TURN_RAD if base_free else 0.0,
        base_offset_mm=BASE_OFFSET_MM if base_free else 0.0,
    )


def cuts_of(model: Model, material: Material) -> FloatArray:
    """Give the cuts in whole meshes that the model holds for, mm.

    Raises
    ------
    formula.errors.OutOfRange
        When there is none.
    """
    (low, high), pitch = model.openF, material.pitch_mm
    cuts = np.arange(np.ceil(low / pitch - 1e-9), np.floor(high / pitch + 1e-9) + 1.0) * pitch
    if cuts.size == 0:
        raise OutOfRange(
            f"no whole number of {pitch:g} mm meshes lies within the {low:g} to {high:g} mm of "
            "openF that the joints are known for"
        )
    return np.asarray(cuts, dtype=float)
