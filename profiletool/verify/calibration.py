"""The calibration of a prototype: rubber, gauge, threads and wall, from its measured angles.

Least squares with priors, by finite elements: a run at the design's own numbers tells where the
tube is, and a run there settles it. Where pressures were held, relaxation is fitted as well.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from profiletool.errors import UnreadableInput
from profiletool.records.calibrated import CalibratedTube, FittedNumber, Relaxation
from profiletool.records.design import Design
from profiletool.records.setting import AngleReading
from profiletool.records.units import BoolArray, FloatArray, IntArray
from profiletool.verify.relaxation import History
from profiletool.verify.surrogate import DEAD, Surrogate, surrogate_at, tube_by

NAMES = ("rubber", "dead", "thread", "wall")
PRIOR = np.array([0.15, 0.1, 6.0, 0.1])  # sigmas: of ln stiffness, bar, deg, mm
_LATE = np.array([0.1, 2.0])  # of the share that acts late, and of the ln of its time
_USUAL_S, _TRIED = 30.0, (-2.5, 0.0, 2.5)  # of that time; ln of it over that, that fits start from
_WAYS = ("rubber {:+.0f} %", "dead pressure {:+.2f} bar", "sectors {:+.1f} deg", "wall {:+.2f} mm")
_MODEL_DEG = 0.1  # what finite elements are off by, whatever the tube
_SOFTEST = 1.3  # of the highest pressure: up to it a run goes when nothing is known of the tube
_ROUNDS, _CLOSE = 3, 0.3  # of runs; a step, over the priors' sigmas, after which none follows
_LEAST_SHARE = 0.3  # of a combination, that a number is named for


@dataclass(frozen=True)
class Data:
    """Readings as arrays (N,): bar on the gauge, joints from 0, deg; places in a history."""

    bars: FloatArray
    joints: IntArray
    theta: FloatArray
    sigma: FloatArray
    history: History | None = None
    moments: IntArray | None = None

    @staticmethod
    def of(readings: Sequence[AngleReading], design: Design) -> Data:
        """Take readings apart; those at rest do not count, and magnitudes get their sign.

        Raises
        ------
        UnreadableInput
        """
        count = len(design.joints)
        for one in readings:
            if one.joint > count:
                raise UnreadableInput(f"angles of joint {one.joint}, but the design has {count}")
        taken = [one for one in readings if one.pressure_bar > 0.0]
        if len(taken) < 3:
            raise UnreadableInput(
                f"{len(taken)} angles under pressure: measure three at least, better at five "
                "pressures"
            )
        joints = np.array([one.joint - 1 for one in taken])
        theta = np.array([one.theta_deg for one in taken])
        away = np.array([joint.away for joint in design.joints])[joints]
        history = History.of(readings)
        times = None if history is None else np.array([one.time_s for one in taken], float)
        return Data(
            np.array([one.pressure_bar for one in taken]),
            joints,
            np.where(away, -np.abs(theta), theta),
            np.hypot([one.sigma_deg for one in taken], _MODEL_DEG),
            history,
            None if history is None or times is None else history.moments(times),
        )

    @property
    def prior(self) -> FloatArray:
        """Sigmas of what is fitted: the four numbers, and relaxation where pressures were held."""
        return PRIOR if self.history is None else np.concatenate([PRIOR, _LATE])

    def chosen(self, some: BoolArray) -> Data:
        """Take some of them."""
        parts = (self.bars[some], self.joints[some], self.theta[some], self.sigma[some])
        return Data(*parts, self.history, None if self.moments is None else self.moments[some])

    def predicted(self, known: Surrogate, values: FloatArray) -> FloatArray:
        """Give the angles of a tube of such numbers, deg."""
        bars = self.bars
        if self.history is not None:
            share, log_time = values[4:].tolist()
            acting = self.history.acting(share, _USUAL_S * np.exp(log_time), float(values[DEAD]))
            bars = acting[self.moments]
        return known.angles(values[:4], bars, self.joints)

    def off(self, known: Surrogate, values: FloatArray) -> FloatArray:
        """Measured less predicted angles, deg."""
        return self.theta - self.predicted(known, values)


def calibrate(
    design: Design,
    readings: Sequence[AngleReading],
    *,
    date: str = "",
    cycles: int | None = None,
    progress: Callable[[float], None] | None = None,
) -> CalibratedTube:
    """Find the tube that has these angles.

    Parameters
    ----------
    design : Design
        What it was built from.
    readings : sequence of AngleReading
    date : str
    cycles : int, optional
        How often it had been inflated.
    progress : callable, optional
        Takes the share that is done.

    Raises
    ------
    UnreadableInput, NotVerified
    """
    data = Data.of(readings, design)
    values, most = np.zeros(len(data.prior)), float(data.bars.max())
    top = _SOFTEST * most
    for turn in range(_ROUNDS):

        def told(share: float, turn: int = turn) -> None:
            if progress is not None:
                progress((turn + share) / _ROUNDS)

        known = surrogate_at(design, values[:4], top, told)
        last, values = values, fitted(data, known, values)
        top = 1.05 * max(most - float(values[DEAD]), 0.5 * most)
        if turn and np.abs((values - last) / data.prior)[:4].max() < _CLOSE:
            break
    return _tube(design, data, known, values, date, cycles)


def fitted(
    data: Data, known: Surrogate, start: FloatArray, kept: dict[int, float] | None = None
) -> FloatArray:
    """Fit the numbers; those ``kept`` stay."""
    prior, base = data.prior, start.copy()
    free = np.array([k not in (kept or {}) for k in range(len(base))])
    for k, value in (kept or {}).items():
        base[k] = value

    def residuals(some: FloatArray) -> FloatArray:
        values = base.copy()
        values[free] = prior[free] * some
        return np.concatenate([data.off(known, values) / data.sigma, some])

    starts = [base] if data.history is None else [_starting(base, log) for log in _TRIED]
    found = min(
        (least_squares(residuals, one[free] / prior[free], method="lm") for one in starts),
        key=lambda fit: float(fit.cost),
    )
    base[free] = prior[free] * found.x
    return base


def _starting(values: FloatArray, log_time: float) -> FloatArray:
    return np.concatenate([values[:4], [0.5 * _LATE[0], log_time]])


def slopes(data: Data, known: Surrogate, values: FloatArray) -> FloatArray:
    """Slopes of the angles by every number, over their sigma and times its prior's: (N, V)."""
    columns = []
    for k, sigma in enumerate(data.prior.tolist()):
        step = np.zeros(len(values))
        step[k] = 1e-4 * sigma
        ends = [data.predicted(known, values + s * step) for s in (1.0, -1.0)]
        columns.append((ends[0] - ends[1]) / 2e-4 / data.sigma)
    return np.column_stack(columns)


def held_out(data: Data, known: Surrogate, values: FloatArray) -> float | None:
    """RMS, deg, of every other pressure predicted from the others, both ways; None for one."""
    levels = np.unique(data.bars)
    if len(levels) < 2:
        return None
    even = np.isin(data.bars, levels[::2])
    off = []
    for part in (even, ~even):
        guess = fitted(data.chosen(part), known, values)
        off.append(data.chosen(~part).off(known, guess))
    return float(np.sqrt(np.mean(np.concatenate(off) ** 2)))


def _tube(
    design: Design, data: Data, known: Surrogate, values: FloatArray, date: str, cycles: int | None
) -> CalibratedTube:
    A = slopes(data, known, values)
    off = data.off(known, values)
    excess = float(np.sum((off / data.sigma) ** 2)) / max(len(off) - 2, 1)
    inverse = np.linalg.inv(A.T @ A / max(1.0, excess) + np.eye(len(values)))
    sigma = data.prior * np.sqrt(np.diag(inverse))
    _, singular, ways = np.linalg.svd(A[:, :4], full_matrices=False)
    built = tube_by(design, values[:4])
    rubber = built.tube.rubber
    assert rubber is not None
    return CalibratedTube(
        design=design.source.file,
        date=date,
        cycles=cycles,
        outer_diameter_mm=design.tube.outer_diameter_mm,
        wall_mm=built.tube.wall_mm,
        rubber=rubber,
        nu=None,
        dead_bar=float(values[DEAD]),
        sector_extra_deg=built.model.sector_extra_deg,
        fitted=tuple(
            FittedNumber(name, float(values[k]), float(sigma[k]), float(PRIOR[k]))
            for k, name in enumerate(NAMES)
        ),
        readings=len(off),
        pressures_bar=tuple(np.unique(data.bars).tolist()),
        rmse_deg=float(np.sqrt(np.mean(off**2))),
        expected_deg=float(np.sqrt(np.mean(data.sigma**2))),
        held_out_deg=held_out(data, known, values),
        singular_values=tuple(singular.tolist()),
        untold=tuple(_combination(way) for way, s in zip(ways, singular, strict=True) if s < 1.0),
        relaxation=None if data.history is None else _relaxation(values[4:], sigma[4:]),
    )


def _relaxation(values: FloatArray, sigma: FloatArray) -> Relaxation:
    time_s = _USUAL_S * float(np.exp(values[1]))
    return Relaxation(float(values[0]), float(sigma[0]), time_s, time_s * float(sigma[1]))


def _combination(way: FloatArray) -> str:
    """Name a combination of the numbers, one prior's sigma of it."""
    way = way * np.sign(way[int(np.abs(way).argmax())])
    shown = PRIOR * way * np.array([100.0, 1.0, 1.0, 1.0])
    parts = [text.format(shown[k]) for k, text in enumerate(_WAYS) if abs(way[k]) > _LEAST_SHARE]
    return " with ".join(parts)
