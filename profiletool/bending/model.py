"""What the choice of joints asks of a model of the actuator, whatever the model is.

Units: mm, rad, MPa. Angles of joints are magnitudes; ``sense`` gives the direction.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from numpy.typing import ArrayLike

from profiletool.records.frames import Pose, Shape
from profiletool.records.units import FloatArray


@dataclass(frozen=True)
class Chain:
    """The joints of an actuator, in order from the clamped end; n of them.

    Attributes
    ----------
    centre, openF : (n,) mm
        Of the cuts, on the straight tube.
    alpha : (n,) rad
        alpha_closed.
    sense : (n,)
        +1 where a joint bends toward the object, -1 away from it.
    length : float, mm
        Of the tube.
    """

    centre: FloatArray
    openF: FloatArray
    alpha: FloatArray
    sense: FloatArray
    length: float


class Model(Protocol):
    """A joint's answer to pressure, and a whole actuator's."""

    @property
    def radius(self) -> float:
        """Outer radius of the tube, mm."""

    @property
    def openF(self) -> tuple[float, float]:
        """What cuts it holds for, mm."""

    @property
    def alpha(self) -> tuple[float, float]:
        """What alpha_closed it holds for, rad."""

    @property
    def pressure(self) -> tuple[float, float]:
        """What pressures it holds for, MPa."""

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
