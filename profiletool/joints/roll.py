"""The gauze as it is rolled: angles on the tube and lengths along the sheet.

Conventions
-----------
Angles on the tube count counter-clockwise as seen from the closed end, looking to the clamped
end; 270 deg faces the object. The sheet lies face up, x along the tube from the clamp's edge, y
up from the start edge, which lies on the seam.

A sheet of gauze is rolled: the tube is laid *on* the face with its seam line on the start edge
and rolled toward +y, so the face ends up inside, against the tube, and angles grow with y:
angle = seam + phi. phi 0 .. 360 is the inner turn, 360 .. 720 the second. A sleeve's pattern and
a marking strip go once around what is on the tube already, face outside: angle = seam - phi.

Glossary
--------
phi : roll angle from the start edge, deg; it keeps counting over all turns
r : radius of the sheet's middle surface, mm; gauze: D/2 + t/2 + t phi / (2 pi)
t : thickness of one layer of gauze, the thread's, mm
y : arc length along the roll, the integral of r dphi, mm
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from profiletool.joints.windows import FULL_CIRCLE, SAME_DEG, cut_sector
from profiletool.records.design import Gauze, Joint, Tube
from profiletool.records.units import FloatArray

Variant = Literal["gauze", "sleeve", "strip"]
PAPER_MM = 0.1  # thickness of a marking strip


@dataclass(frozen=True)
class Roll:
    """How a sheet lies around the tube.

    Attributes
    ----------
    start_mm : float
        Radius of its middle surface at the start edge.
    rise_mm : float
        By how much that grows with each turn: one layer where it is rolled up, 0 where it closes.
    turns : int
        How many times it goes around.
    outside : bool
        Whether its face lies outside, so that angles fall with y.
    """

    start_mm: float
    rise_mm: float
    turns: int
    outside: bool = False

    @property
    def length_mm(self) -> float:
        """Length of the sheet along the roll, mm."""
        return float(self.y_mm(FULL_CIRCLE * self.turns))

    def y_mm(self, phi_deg: float | FloatArray) -> FloatArray:
        """Arc length along the roll (mm) at the roll angle ``phi_deg``, of the same shape."""
        phi = np.radians(phi_deg)
        return np.asarray(phi * (self.start_mm + self.rise_mm * phi / (4 * np.pi)))

    def phi_deg(self, y_mm: float | FloatArray) -> FloatArray:
        """Roll angle (deg) at the arc length ``y_mm``, of the same shape: the inverse of y."""
        r = np.sqrt(self.start_mm**2 + self.rise_mm * np.asarray(y_mm) / np.pi)
        # The quadratic's root in the form that also holds where the radius does not grow.
        return np.asarray(np.degrees(2 * np.asarray(y_mm) / (self.start_mm + r)))


def roll_of(tube: Tube, gauze: Gauze, variant: Variant = "gauze") -> Roll:
    """Return how a sheet lies around ``tube``.

    "gauze" is rolled up around it, "sleeve" closes on it as a single layer, "strip" is paper
    around all turns of the gauze.
    """
    radius, thread = tube.outer_diameter_mm / 2, gauze.thread_mm
    if variant == "strip":
        return Roll(radius + gauze.turns * thread + PAPER_MM / 2, 0.0, 1, outside=True)
    if variant == "sleeve":
        return Roll(radius + thread / 2, 0.0, 1, outside=True)
    return Roll(radius + thread / 2, thread, gauze.turns)


def window_intervals(joint: Joint, seam_deg: float, roll: Roll) -> FloatArray:
    """Return the cut sector of a joint as intervals of the roll angle.

    A cut that runs through the seam is one interval from one turn into the next; its first
    piece starts at the start edge and its last one stops at the end edge.

    Returns
    -------
    (N, 2) float
        phi from and to, deg, ascending; empty where nothing is cut.
    """
    start, extent = cut_sector(joint)
    end = FULL_CIRCLE * roll.turns
    if extent >= FULL_CIRCLE:
        return np.array([[0.0, end]])
    ahead = seam_deg - (start + extent) if roll.outside else start - seam_deg
    begins = ahead % FULL_CIRCLE + FULL_CIRCLE * np.arange(-1, roll.turns)
    pieces = np.stack([begins, begins + extent], axis=1).clip(0.0, end)
    return np.asarray(pieces[pieces[:, 1] - pieces[:, 0] > SAME_DEG])
