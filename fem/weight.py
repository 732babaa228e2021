"""The weight of an actuator: a dead load on rubber, gauze and plug."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Weight:
    """Specific weights of an actuator, and where they pull.

    Attributes
    ----------
    direction : (float, float, float)
        Unit vector in the frame of the tube: x, y across it, z along it.
    rubber : float
        Weight of the rubber per volume, N/mm^3; the plug is of it too.
    gauze : float
        Weight of all turns of the gauze per area of the tube's outer surface, N/mm^2.

    Raises
    ------
    ValueError
        When a weight is negative, or the direction is no unit vector.
    """

    direction: tuple[float, float, float]
    rubber: float
    gauze: float

    def __post_init__(self) -> None:
        length = float(np.linalg.norm(self.direction))
        if not (abs(length - 1.0) < 1e-6 and self.rubber >= 0.0 and self.gauze >= 0.0):
            raise ValueError("a weight needs a unit vector, and weights that are not negative")

    @property
    def in_plane(self) -> bool:
        """Whether it leaves the plane x = 0 a plane of symmetry."""
        return abs(self.direction[0]) < 1e-9
