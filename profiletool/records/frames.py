"""Poses and shapes in the object frame, and unit vectors along and across a line in it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from profiletool.records.units import FloatArray


def direction(heading: float | FloatArray) -> FloatArray:
    """Give unit vectors of headings in rad: (...) -> (..., 2)."""
    return np.stack([np.cos(heading), np.sin(heading)], axis=-1)


def outward(heading: float | FloatArray, sign: float) -> FloatArray:
    """Give unit vectors away from the object, across headings in rad: (...) -> (..., 2).

    ``sign`` is +1 where the object lies to the left of a heading, else -1 (see `Profile.sign`).
    """
    return sign * np.stack([np.sin(heading), -np.cos(heading)], axis=-1)


def cross(a: FloatArray, b: FloatArray) -> FloatArray:
    """Give the cross product in the plane, positive where b points left of a: (..., 2) -> (...)."""
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])


def base_axes(heading: float, sign: float) -> tuple[FloatArray, FloatArray]:
    """Give unit vectors along the tube and away from the object, (2,) each."""
    return direction(heading), outward(heading, sign)


@dataclass(frozen=True)
class Pose:
    """Where the object-facing line starts and which way it points (object frame)."""

    x_mm: float
    y_mm: float
    heading_deg: float


@dataclass(frozen=True)
class Shape:
    """A deformed (or straight) actuator in the object frame.

    Attributes
    ----------
    along : (N,) mm
        Position on the straight tube, from the clamped end.
    facing, axis, far : (N, 2) mm
        The object-facing surface line, the axis, the surface line on the other side.
    """

    along: FloatArray
    facing: FloatArray
    axis: FloatArray
    far: FloatArray
