"""Angles that were read at a finished actuator, and the stiffness that fits them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize_scalar

from profiletool.errors import UnreadableInput, UsageError
from profiletool.records.setting import AngleReading
from profiletool.records.units import BoolArray, FloatArray, IntArray
from profiletool.verify.trim_curves import Curves

_OFF_DEG, _OFF_SIGMAS = 2.0, 3.0  # of a joint's mean, before it is off by itself
_STIFFNESSES, _TRIALS = (0.4, 2.5), 121  # that are looked through


@dataclass(frozen=True)
class Readings:
    """Readings as arrays (n,): bar, joints from 0, deg."""

    bars: FloatArray
    joints: IntArray
    theta: FloatArray
    sigma: FloatArray

    @staticmethod
    def of(readings: Sequence[AngleReading], curves: Curves) -> Readings:
        """Take readings apart; a joint that bends away may have been read as a magnitude."""
        count = len(curves.away)
        for one in readings:
            if not 1 <= one.joint <= count:
                raise UnreadableInput(f"angles of joint {one.joint}, but the design has {count}")
            if not (one.sigma_deg > 0.0 and np.isfinite(one.theta_deg) and one.pressure_bar >= 0):
                raise UsageError(f"no reading of an angle: {one}")
        taken = [one for one in readings if one.pressure_bar > 0.0]
        if not taken:
            raise UsageError("all angles were read at rest: measure near the planned pressure")
        joints = np.array([one.joint - 1 for one in taken])
        theta = np.array([one.theta_deg for one in taken])
        theta = np.where(curves.away[joints], -np.abs(theta), theta)
        bars, sigma = (
            np.array([getattr(one, name) for one in taken])
            for name in ("pressure_bar", "sigma_deg")
        )
        return Readings(bars, joints, theta, sigma)

    def chosen(self, some: BoolArray) -> Readings:
        """Take some of them."""
        return Readings(self.bars[some], self.joints[some], self.theta[some], self.sigma[some])

    def inside(self, curves: Curves, stiffness: float) -> BoolArray:
        """Whether the nominal actuator's pressure is one of the table's."""
        nominal = self.bars / stiffness
        found: BoolArray = (nominal >= curves.bars[0] - 1e-9) & (nominal <= curves.top + 1e-9)
        return found

    def off(self, curves: Curves, stiffness: float) -> FloatArray:
        """Read angles less those of an actuator of a stiffness, deg."""
        found: FloatArray = self.theta - curves.angles(self.bars / stiffness, self.joints)
        return found

    def cost(self, curves: Curves, stiffness: float) -> float:
        """Sum the squares of what a stiffness leaves, over the standard deviations."""
        return float(((self.off(curves, stiffness) / self.sigma) ** 2).sum())

    def mean_off(self, curves: Curves, stiffness: float, joint: int) -> tuple[float, bool]:
        """Mean by which a joint is off, deg, and whether that is more than chance."""
        mine = self.chosen(self.joints == joint)
        weight = mine.sigma**-2
        mean = float((mine.off(curves, stiffness) * weight).sum() / weight.sum())
        return mean, abs(mean) > max(_OFF_DEG, _OFF_SIGMAS * float(weight.sum()) ** -0.5)

    def stiffness(self, curves: Curves) -> float:
        """Fit it by least squares."""

        def cost(log: float) -> float:
            return self.cost(curves, float(np.exp(log)))

        low, high = np.log(_STIFFNESSES)
        trials = np.linspace(low, high, _TRIALS)
        k = int(np.argmin([cost(trial) for trial in trials]))
        found = minimize_scalar(
            cost,
            bounds=(trials[max(k - 1, 0)], trials[min(k + 1, len(trials) - 1)]),
            method="bounded",
            options={"xatol": 1e-9},
        )
        return float(np.exp(found.x))


def joints_off(used: Readings, curves: Curves) -> dict[int, float]:
    """Find joints that bend otherwise than the others let expect: number, and by how much, deg.

    The worst is left out, and the stiffness fitted to the others, until these agree.
    """
    found: dict[int, float] = {}
    left = used
    while len(joints := np.unique(left.joints)) > 1:
        trials = [left.chosen(left.joints != joint) for joint in joints]
        stiffness = left.stiffness(curves)
        if not any(left.mean_off(curves, stiffness, joint)[1] for joint in joints):
            break
        # The worst is the one without which the others agree best.
        costs = [trial.cost(curves, trial.stiffness(curves)) for trial in trials]
        k = int(np.argmin(costs))
        mean, beyond = left.mean_off(curves, trials[k].stiffness(curves), joints[k])
        if not beyond:
            break
        found[int(joints[k]) + 1] = mean
        left = trials[k]
    return dict(sorted(found.items()))
