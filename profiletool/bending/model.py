"""The chain of joints, and the protocol of models that bend it.

Units: mm, rad, MPa. Angles of joints are magnitudes; ``sense`` gives the direction in the plane.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike

from profiletool.records.design import AWAY_DEG, TOWARD_DEG, sense_of
from profiletool.records.frames import Pose, Shape
from profiletool.records.units import FloatArray

TOWARD, AWAY = float(np.radians(TOWARD_DEG)), float(np.radians(AWAY_DEG))


def centers_of(sense: ArrayLike) -> FloatArray:
    """Give alpha_center, (n,) rad, of joints of a sense, (n,): +1 toward the object, -1 away."""
    return np.where(np.asarray(sense) > 0.0, TOWARD, AWAY)


@dataclass(frozen=True)
class Chain:
    """The joints of an actuator, in order from the clamped end; n of them.

    Attributes
    ----------
    centre, openF : (n,) mm
        Of the cuts, on the straight tube.
    alpha : (n,) rad
        alpha_closed.
    alpha_center : (n,) rad
        Angular position of the uncut sectors' middles: `TOWARD` bends toward the object, `AWAY`
        away from it, all others out of the plane.
    length : float, mm
        Of the tube.
    """

    centre: FloatArray
    openF: FloatArray
    alpha: FloatArray
    alpha_center: FloatArray
    length: float

    @cached_property
    def sense(self) -> FloatArray:
        """+1 where a joint bends toward the object, -1 away from it: (n,).

        Raises
        ------
        profiletool.errors.UnreadableInput
            Naming the first joint that bends out of the plane.
        """
        centers = np.degrees(self.alpha_center).tolist()
        return np.array([sense_of(center, k + 1) for k, center in enumerate(centers)])


class Model(Protocol):
    """A joint's answer to pressure, and a whole actuator's."""

    @property
    def radius(self) -> float:
        """Outer radius of the tube, mm."""

    @property
    def openF(self) -> tuple[float, float]:
        """Range of cuts that it holds for, mm."""

    @property
    def alpha(self) -> tuple[float, float]:
        """Range of alpha_closed that it holds for, rad."""

    @property
    def pressure(self) -> tuple[float, float]:
        """Range of pressures that it holds for, MPa."""

    def theta(self, openF: ArrayLike, alpha: ArrayLike, pressure: ArrayLike) -> FloatArray:
        """Angle of a joint alone, rad; arguments broadcast."""

    def alpha_for(self, openF: ArrayLike, theta: ArrayLike, pressure: ArrayLike) -> FloatArray:
        """alpha_closed that gives an angle, rad; NaN where none within the range does."""

    def line(self, openF: float, alpha: float, pressure: float, sense: float) -> FloatArray:
        """Object-facing line of a joint alone in a long straight tube: (N, 3).

        Rows are (x, y, heading) in the frame of the tube before the joint: x along its
        object-facing line, y away from the object, the origin where the window's first edge lies
        at rest if the tube before it did not deform at all. The line begins and ends where the tube
        is straight to good approximation. A joint with sense +1 turns toward -y.
        """

    def shape(self, chain: Chain, pressure: float, pose: Pose, sign: float) -> Shape:
        """Bend the whole tube at a pressure, neighbours' influence included.

        ``pose`` is that of the object-facing line at the clamped end; ``sign`` is +1 where a turn
        toward the object is counter-clockwise (see `Profile.sign`).
        """
