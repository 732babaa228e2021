"""Poses and shapes in the object frame, and the axes of a base."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from profiletool.records.units import FloatArray


def base_axes(heading: float, sign: float) -> tuple[FloatArray, FloatArray]:
    """Give unit vectors along the tube and away from the object, (2,) each."""
    cos, sin = np.cos(heading), np.sin(heading)
    return np.array([cos, sin]), sign * np.array([sin, -cos])


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
