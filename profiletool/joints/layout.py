"""The layout of an actuator: its joints along the tube, where it starts, what it works at."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from profiletool.bending.kinematics import Bend
from profiletool.records.design import Joint
from profiletool.records.frames import Pose


@dataclass(frozen=True)
class Layout:
    """The joints of an actuator, where it starts and what it works at.

    Attributes
    ----------
    joints : tuple of Joint
        In order from the clamped end.
    root_mm, length_mm : float
        From the clamped end to joint 1's centre, and of the whole tube.
    pressure_bar : float
    pose : Pose
        Of the object-facing line at the clamped end.
    """

    joints: tuple[Joint, ...]
    root_mm: float
    length_mm: float
    pressure_bar: float
    pose: Pose

    def bends(self) -> tuple[Bend, ...]:
        """Give the joints as the kinematics sees them, bent by the formula's angles.

        Raises
        ------
        profiletool.errors.UnreadableInput
            When a joint bends out of the plane.
        """
        return tuple(
            Bend(
                joint.centre_mm,
                joint.openF_mm,
                joint.sense * np.radians(joint.theta_formula_deg),
            )
            for joint in self.joints
        )
