"""The bending model by formula (9): joints of constant curvature, independent of each other."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from formula.inverse import alpha_branch_deg, falling_root
from formula.theta import Formula, quadratic_in_alpha, theta_deg
from profiletool.bending.kinematics import Bend, deform, facing_stretch
from profiletool.bending.model import Chain
from profiletool.records.frames import Pose, Shape
from profiletool.records.units import BAR_PER_MPA, FloatArray

_STEP_MM = 0.25  # spacing of a line's points
_SLACK_DEG = 1e-9


class FormulaModel:
    """A `profiletool.bending.model.Model` by a formula: mm, rad, MPa outside, deg and bar inside.

    Attributes
    ----------
    radius : float, mm
    openF, alpha, pressure : (float, float)
        The formula's own ranges: mm, rad, MPa.
    """

    def __init__(self, formula: Formula, radius_mm: float) -> None:
        low, high = formula.alpha_range_deg
        least, most = formula.pressure_range_bar
        self.radius = radius_mm
        self.openF = formula.openF_range_mm
        self.alpha = (float(np.radians(low)), float(np.radians(high)))
        self.pressure = (least / BAR_PER_MPA, most / BAR_PER_MPA)
        self._formula = formula

    def theta(self, openF: ArrayLike, alpha: ArrayLike, pressure: ArrayLike) -> FloatArray:
        """Angle of a joint, rad; arguments broadcast.

        Below the alpha of the largest angle (about 90 deg at 1.9 bar) the formula would fall again,
        which a joint does not do: the largest angle stays there. It is never below zero.
        """
        bar = BAR_PER_MPA * np.asarray(pressure, dtype=float)
        low, _ = alpha_branch_deg(self._formula, openF, bar)
        alpha_deg = np.maximum(np.degrees(alpha), low)
        theta: FloatArray = np.radians(theta_deg(self._formula, alpha_deg, openF, bar))
        return np.maximum(theta, 0.0)

    def alpha_for(self, openF: ArrayLike, theta: ArrayLike, pressure: ArrayLike) -> FloatArray:
        """alpha_closed that gives an angle, rad; NaN where none within the range does."""
        bar = BAR_PER_MPA * np.asarray(pressure, dtype=float)
        wanted: FloatArray = np.degrees(np.asarray(theta, dtype=float))
        low, high = alpha_branch_deg(self._formula, openF, bar)
        alpha = falling_root(*quadratic_in_alpha(self._formula, openF, bar), wanted)
        least, most = (theta_deg(self._formula, end, openF, bar) for end in (high, low))
        within = (wanted >= least - _SLACK_DEG) & (wanted <= most + _SLACK_DEG)
        return np.where(within, np.radians(np.clip(alpha, low, high)), np.nan)

    def line(self, openF: float, alpha: float, pressure: float, sense: float) -> FloatArray:
        """Object-facing line of a joint in a long straight tube: (N, 3) of x, y, heading.

        In the frame of `profiletool.bending.model.Model.line`.
        """
        turn = sense * float(self.theta(openF, alpha, pressure))
        length = openF + float(facing_stretch(turn, self.radius))
        count = max(int(np.ceil(length / _STEP_MM)), 1)
        heading = -turn * np.linspace(0.0, 1.0, count + 1)
        chord = length / count * np.sinc(turn / count / (2.0 * np.pi))
        middle = 0.5 * (heading[1:] + heading[:-1])
        x, y = (
            np.concatenate([[0.0], np.cumsum(chord * part)])
            for part in (np.cos(middle), np.sin(middle))
        )
        return np.column_stack([x, y, heading])

    def shape(self, chain: Chain, pressure: float, pose: Pose, sign: float) -> Shape:
        """Bend the whole tube at a pressure."""
        turns = chain.sense * self.theta(chain.openF, chain.alpha, pressure)
        bends = [
            Bend(float(centre), float(openF), float(turn))
            for centre, openF, turn in zip(chain.centre, chain.openF, turns, strict=True)
        ]
        return deform(bends, chain.length, self.radius, pose, sign)
