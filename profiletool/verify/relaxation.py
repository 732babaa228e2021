"""Rubber that relaxes: a part of the pressure acts late, by an exponential.

Under a share s and a time constant T the tube stands where the relaxed one does at the pressure
(1 - s) p + s q; q runs after the pressure p inside: T dq/dt = p - q, from rest. So does a standard
linear solid, whose stiffness is 1 / (1 - s) of the relaxed one at first.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby

import numpy as np

from profiletool.errors import UnreadableInput
from profiletool.records.setting import AngleReading
from profiletool.records.units import FloatArray, IntArray

_LEAST = 3  # times at one pressure that make a hold


@dataclass(frozen=True)
class History:
    """Pressures over time; each is set at its time and stays until the next.

    Attributes
    ----------
    times, bars : (M,) s, bar on the gauge
    """

    times: FloatArray
    bars: FloatArray

    @staticmethod
    def of(readings: Sequence[AngleReading]) -> History | None:
        """Take the times of readings; None where no pressure was held at three of them.

        Raises
        ------
        UnreadableInput
            A time has two pressures.
        """
        set_at: dict[float, float] = {}
        for one in readings:
            if one.time_s is None:
                return None
            if set_at.setdefault(one.time_s, one.pressure_bar) != one.pressure_bar:
                raise UnreadableInput(f"two pressures at {one.time_s:g} s")
        times, bars = np.array(sorted(set_at.items())).T
        longest = max(
            [len(list(run)) for bar, run in groupby(bars.tolist()) if bar > 0.0], default=0
        )
        return History(times, bars) if longest >= _LEAST else None

    def moments(self, times_s: FloatArray) -> IntArray:
        """Give the places of times in it."""
        return np.searchsorted(self.times, times_s).astype(np.int64)

    def acting(self, share: float, time_s: float, dead_bar: float) -> FloatArray:
        """Pressures (M,) on the gauge, at which the relaxed tube stands as this one does."""
        inside = np.maximum(self.bars - dead_bar, 0.0)
        late = np.zeros(len(inside))
        left = np.exp(-np.diff(self.times) / time_s)
        for k, kept in enumerate(left.tolist()):
            late[k + 1] = inside[k] + (late[k] - inside[k]) * kept
        return np.asarray(dead_bar + (1.0 - share) * inside + share * late)
