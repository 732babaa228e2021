"""The clamp: the piece of tube and gauze that is held, behind the place where the actuator begins.

x = 0 of a design, of its template and of finite elements is the clamp's edge. Ahead of it the tube
is free. Behind it plug, tube, gauze and belt (or saddle) are one rigid piece, down to the tube's
open end.
"""

from __future__ import annotations

from dataclasses import dataclass

LEAST_MM = 8.0  # a saddle with M3 screws, and a rim on both sides of it


@dataclass(frozen=True)
class Clamp:
    """How the open end of a tube is held; all places are x along the tube, negative.

    Attributes
    ----------
    length_mm : float
        Of tube and gauze, from the open end to x = 0.
    """

    length_mm: float = 20.0

    @property
    def open_end_mm(self) -> float:
        """Place of the tube's open end, and of the gauze's."""
        return -self.length_mm

    @property
    def belt_mm(self) -> tuple[float, float]:
        """Belt or saddle, from and to."""
        return -0.75 * self.length_mm, -0.25 * self.length_mm

    @property
    def screws_mm(self) -> float:
        """Middle of the belt or saddle, where its screws are."""
        return -0.5 * self.length_mm

    @property
    def bead_mm(self) -> float:
        """Middle of the bead inside the tube, which seals in the plug's groove."""
        return -0.875 * self.length_mm
