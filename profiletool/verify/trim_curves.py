"""The trim table of a design as curves: tip and angles over the pressure."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline

from profiletool.errors import UnreadableInput
from profiletool.records.design import Design
from profiletool.records.seal import proven
from profiletool.records.units import BoolArray, FloatArray, IntArray

_SAME_DEG = 0.02  # between the trim table and the joints of one design
_MOST_POWER = 4.0  # of the pressure, that an angle may grow by


@dataclass(frozen=True)
class Curves:
    """A trim table as curves over the pressure, bar.

    Attributes
    ----------
    planned : float, bar
    bars : (n,)
        Pressures of the table.
    tip : CubicSpline
        (2,) mm.
    theta : CubicSpline
        (joints,) deg.
    length_mm : float
        Of the tube.
    away : (joints,)
        Joints that bend away from the object.
    """

    planned: float
    bars: FloatArray
    tip: CubicSpline
    theta: CubicSpline
    length_mm: float
    away: BoolArray

    @property
    def top(self) -> float:
        """The highest pressure that finite elements checked, bar."""
        return float(self.bars[-1])

    def angles(self, bars: FloatArray, joints: IntArray) -> FloatArray:
        """Angles of joints at pressures, bar; beyond the table by the power law at its end."""
        low, high = self.bars[[0, -1]]
        inside = np.clip(bars, low, high)
        rows = np.arange(len(bars))
        at = self.theta(inside)[rows, joints]
        slope = self.theta(inside, 1)[rows, joints]
        steep = np.abs(at) > 0.1
        power = np.where(steep, slope * inside / np.where(steep, at, 1.0), 0.0)
        found: FloatArray = at * (bars / inside) ** np.clip(power, 0.0, _MOST_POWER)
        return found


def curves_of(design: Design) -> Curves:
    """Read the trim table of a design.

    Raises
    ------
    UnreadableInput
        There is none, or finite elements did not verify the design as it is.
    """
    if not proven(design):
        raise UnreadableInput(
            "not verified by finite elements, or changed since: its trim table does not hold; the "
            "command report makes it whole"
        )
    if len(design.trim) < 2:
        raise UnreadableInput(
            "holds no trim table, as those of older versions: the command report makes it whole"
        )
    planned = design.pressure_bar
    bars = np.array([point.pressure_bar for point in design.trim])
    theta = [point.theta_deg for point in design.trim]
    tips = np.array([point.tip_mm for point in design.trim])
    return Curves(
        planned,
        bars,
        CubicSpline(bars, tips),
        CubicSpline(bars, np.array(theta)),
        design.tube.length_mm,
        np.array([joint.away for joint in design.joints]),
    )
