"""The object as a rigid obstacle in the frame of the finite elements."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from fem.body import Body
from fem.gap import Cylinder, Obstacle, Plane, Sphere
from fem.outline import Extruded, Outline, Revolved
from profiletool.errors import UsageError
from profiletool.records.design import Design
from profiletool.records.frames import base_axes, direction
from profiletool.records.grip_request import Solid
from profiletool.records.side import side_sign
from profiletool.records.units import FloatArray

_KINDS = ("plane", "cylinder", "sphere")
_LEVEL = 1e-9
_OFF_AXIS_MM = 1.0  # beyond its axis that a turned profile may reach


def object_of(
    design: Design, target: FloatArray, solid: Solid = "auto", clearance_mm: float = 0.0
) -> tuple[Obstacle, str]:
    """Make the object that a profile belongs to.

    Parameters
    ----------
    design : Design
    target : (N, 2) mm
        The profile, object frame.
    solid : {"auto", "turned", "extruded"}
        The profile turned about the object's axis, x = 0, or the same at every depth; by itself
        turned where it lies on its own side of that axis.
    clearance_mm : float
        That the profile keeps from the object.

    Returns
    -------
    Obstacle
    "turned" or "extruded"

    Raises
    ------
    UsageError
        A profile that crosses the axis cannot be turned about it.
    """
    sign = side_sign(design.source.side)  # +1 on the left, where x is negative
    beyond = float((sign * target[:, 0]).max())
    made = solid
    if solid == "auto":
        made = "turned" if beyond <= _OFF_AXIS_MM else "extruded"
    if made == "turned" and beyond > _OFF_AXIS_MM:
        raise UsageError(
            f"the profile reaches {beyond:.1f} mm beyond the object's axis, so it cannot be "
            "turned about it; take `solid` extruded"
        )
    frame = _Frame(design)
    # The body must lie on the right of the line, seen with `along` to the right and `away` up.
    outline = Outline(frame.placed(target), back_mm=clearance_mm)
    if made == "extruded":
        return Extruded(outline), made
    down, out = frame.turned([0.0, -1.0]), frame.turned([-sign, 0.0])
    return Revolved(outline, frame.placed(np.zeros((1, 2)))[0], down, out), made


def given_obstacle(design: Design, text: str) -> tuple[Obstacle, str]:
    """Make what the actuator meets in place of its object: see `GripRequest.against`.

    Raises
    ------
    UsageError
        The text says nothing that can be met.
    """
    kind, _, rest = text.partition(":")
    try:
        x, y, last = (float(part) for part in rest.split(","))
    except ValueError:
        x = y = last = np.nan
    if kind not in _KINDS or not np.isfinite([x, y, last]).all():
        raise UsageError(
            f'`against` takes "plane:X,Y,DEG", "cylinder:X,Y,R" or "sphere:X,Y,R", not {text!r}'
        )
    frame = _Frame(design)
    z, v = frame.placed(np.array([[x, y]]))[0]
    point = np.array([0.0, v, z])
    if kind == "plane":
        along, away = frame.turned(direction(float(np.radians(last))))
        return Plane(point, np.array([0.0, away, along])), kind
    if last <= 0.0:
        raise UsageError(f"`against`: the radius must be above 0, not {last:g}")
    if kind == "sphere":
        return Sphere(point, last), kind
    return Cylinder(point, np.array([1.0, 0.0, 0.0]), last), kind


def body_of(design: Design, weight_N: float, fingers: int) -> Body:
    """Give an object between equal fingers its freedom: along its axis, with its share of weight.

    Raises
    ------
    UsageError
        Gravity pulls across the axis.
    """
    pull = design.model.pull(side_sign(design.source.side)) or (0.0, -1.0)
    if abs(pull[0]) > _LEVEL:
        raise UsageError(
            "`free_N`: with `gravity` across the object's axis the fingers do not bear the same; "
            "let it pull down or up"
        )
    along, away = _Frame(design).turned([0.0, 1.0])
    up = np.array([away, along, 0.0])
    return Body(up[None], pull[1] * weight_N / fingers * up, np.zeros(3))


class _Frame:
    """From the object's frame to (along the clamped tube, away from the object off its axis)."""

    def __init__(self, design: Design) -> None:
        pose, sign = design.base_pose, side_sign(design.source.side)
        self._axes = np.stack(base_axes(float(np.radians(pose.heading_deg)), sign), axis=1)
        self._start = np.array([pose.x_mm, pose.y_mm])
        self._radius = 0.5 * design.tube.outer_diameter_mm

    def placed(self, points: FloatArray) -> FloatArray:
        """Place points (N, 2)."""
        moved: FloatArray = (points - self._start) @ self._axes - [0.0, self._radius]
        return moved

    def turned(self, vector: ArrayLike) -> FloatArray:
        """Turn a vector (2,)."""
        return np.asarray(vector, dtype=float) @ self._axes
