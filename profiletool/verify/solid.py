"""The object as a rigid obstacle in the frame of the finite elements."""

from __future__ import annotations

import numpy as np

from fem.contact.gap import Obstacle
from fem.contact.outline import Extruded, Outline, Revolved
from profiletool.errors import UsageError
from profiletool.records.design import Design
from profiletool.records.frames import base_axes
from profiletool.records.grip import Solid
from profiletool.records.side import side_sign
from profiletool.records.units import FloatArray

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
    radius = 0.5 * design.tube.outer_diameter_mm
    beyond = float((sign * target[:, 0]).max())
    made = solid
    if solid == "auto":
        made = "turned" if beyond <= _OFF_AXIS_MM else "extruded"
    if made == "turned" and beyond > _OFF_AXIS_MM:
        raise UsageError(
            f"the profile reaches {beyond:.1f} mm beyond the object's axis, so it cannot be "
            "turned about it; take `solid` extruded"
        )
    pose = design.base_pose
    axes = np.stack(base_axes(float(np.radians(pose.heading_deg)), sign), axis=1)

    def placed(points: FloatArray) -> FloatArray:
        """Object frame to (along the clamped tube, away from the object off its axis)."""
        moved: FloatArray = (points - [pose.x_mm, pose.y_mm]) @ axes - [0.0, radius]
        return moved

    # The body must lie on the right of the line, seen with `along` to the right and `away` up.
    outline = Outline(placed(target), back_mm=clearance_mm)
    if made == "extruded":
        return Extruded(outline), made
    down, out = np.array([0.0, -1.0]) @ axes, np.array([-sign, 0.0]) @ axes
    return Revolved(outline, placed(np.zeros((1, 2)))[0], down, out), made
