"""Sensitivity of the bent shape to small errors of the build, by FE's own derivatives."""

from __future__ import annotations

import numpy as np

from profiletool.records.design import Design, Sensitivity
from profiletool.records.units import BAR_PER_MPA, FloatArray
from profiletool.verify.check import DECIMALS
from profiletool.verify.fields import ErrorFields

_PRESSURE_BAR, _WALL_SHARE, _OPENF_MM, _PLACE_MM, _SCALE_SHARE = 0.05, 0.05, 2.0, 1.0, 0.01


def sensitivity_of(
    design: Design, fields: ErrorFields, points: FloatArray
) -> tuple[Sensitivity, ...]:
    """Say how far the object-facing line moves for usual errors, to first order.

    Of what every joint has, the joint that matters most counts.

    Parameters
    ----------
    design : Design
    fields : ErrorFields
        Of the design.
    points : (M, 2) mm
        Of the profile, those of the fields.
    """
    wall = _WALL_SHARE * design.tube.wall_mm
    scale = design.source.scale_error_share or _SCALE_SHARE
    # What lies off the start grows with the scale.
    grown = scale * np.einsum("mk,mk->m", fields.normal, points - points[0])
    pressure = _PRESSURE_BAR / BAR_PER_MPA
    return (
        _told(f"pressure {_PRESSURE_BAR:g} bar off", None, pressure * fields.pressure),
        _worst("one thread more or less uncut", design.thread_rad * fields.alpha),
        _worst(f"cut {_OPENF_MM:g} mm longer or shorter", _OPENF_MM * fields.openF),
        _worst(f"joint {_PLACE_MM:g} mm off its place", _PLACE_MM * fields.wrapped[:-1]),
        _told(f"wall {100.0 * _WALL_SHARE:g} % off", None, wall * fields.wall),
        _told(f"scale {100.0 * scale:.2g} % off", None, grown),
    )


def _worst(what: str, moved: FloatArray) -> Sensitivity:
    k = int(np.argmax(np.mean(moved**2, axis=-1)))
    return _told(what, k + 1, moved[k])


def _told(what: str, joint: int | None, moved: FloatArray) -> Sensitivity:
    rms, most = float(np.sqrt(np.mean(moved**2))), float(np.abs(moved).max())
    return Sensitivity(what, joint, round(rms, DECIMALS - 2), round(most, DECIMALS - 2))
