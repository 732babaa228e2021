"""Relaxation from holds: on the surrogate that tests of the calibration know."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from profiletool.errors import UnreadableInput
from profiletool.files.tube_json import load_tube, tube_json
from profiletool.records.calibrated import CalibratedTube
from profiletool.records.setting import AngleReading
from profiletool.report.calibrated import tube_text
from profiletool.verify.calibration import Data, _tube, fitted
from profiletool.verify.relaxation import History
from tests.verify.test_calibration import JOINTS, drawn, known, the_design

SHARE, TIME_S = 0.05, 30.0
HELD = tuple(  # from rest to a pressure, which is held; then at rest again
    (400.0 * k + t, bar if t >= 0.0 else 0.0)
    for k, bar in enumerate((0.7, 1.1, 1.5))
    for t in (-200.0, 0.0, 5.0, 10.0, 20.0, 40.0, 80.0, 120.0)
)
RISING = tuple((10.0 * k, 0.1 * k) for k in range(1, 16))


def read(
    table: tuple[tuple[float, float], ...], values: np.ndarray, seed: int
) -> list[AngleReading]:
    """Read angles of a tube that relaxes as SHARE and TIME_S say, with noise of 0.3 deg."""
    times, bars = np.array(table).T
    acting = History(times, bars).acting(SHARE, TIME_S, values[1])
    noise = np.random.default_rng(seed).normal(0.0, 0.3, (len(bars), JOINTS))
    theta = [known().angles(values, acting, np.full(len(bars), k)) for k in range(JOINTS)]
    return [
        AngleReading(bar, k + 1, float(theta[k][n] + noise[n, k]), 0.3, time)
        for n, (time, bar) in enumerate(table)
        for k in range(JOINTS)
    ]


def calibrated(readings: list[AngleReading], samples: Path) -> CalibratedTube:
    design = the_design(samples)
    data = Data.of(readings, design)
    values = fitted(data, known(), np.zeros(len(data.prior)))
    return _tube(design, data, known(), values, "", None)


def test_a_hold_is_an_exponential() -> None:
    times = np.array([2.0, 3.0, 12.0, 42.0])
    acting = History(times, np.full(4, 1.04)).acting(0.2, 10.0, 0.04)
    assert acting == pytest.approx(0.04 + 1.0 - 0.2 * np.exp(-(times - 2.0) / 10.0))
    # What acted late before goes on acting, however finely the table tells it.
    coarse = History(np.array([0.0, 5.0, 9.0]), np.array([0.5, 1.0, 1.0]))
    fine = History(np.array([0.0, 2.0, 5.0, 6.0, 9.0]), np.array([0.5, 0.5, 1.0, 1.0, 1.0]))
    assert coarse.acting(0.3, 4.0, 0.0)[-1] == pytest.approx(fine.acting(0.3, 4.0, 0.0)[-1])


@pytest.mark.parametrize(
    ("table", "held"),
    [
        (((0.0, 0.4), (1.0, 0.4), (2.0, 0.4)), True),
        (((0.0, 0.2), (1.0, 0.4), (2.0, 0.4), (3.0, 0.4), (4.0, 0.6)), True),
        (((0.0, 0.2), (1.0, 0.4), (2.0, 0.4), (3.0, 0.6), (4.0, 0.4)), False),
        (((0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (3.0, 0.4)), False),
        (((0.0, 0.0), (1.0, 0.0), (2.0, 0.0)), False),
    ],
)
def test_a_hold_is_three_times_at_one_pressure(
    table: tuple[tuple[float, float], ...], held: bool
) -> None:
    readings = [AngleReading(bar, 1, 5.0, 1.0, time) for time, bar in table]
    assert (History.of(readings) is not None) == held
    assert History.of([AngleReading(bar, 1, 5.0) for _, bar in table]) is None


def test_share_and_time_lie_within_two_sigma(samples: Path) -> None:
    inside = []
    for seed in range(5):
        true = drawn(seed)
        tube = calibrated(read(HELD, true, seed), samples)
        found = tube.relaxation
        assert found is not None
        assert found.told
        assert found.share_sigma < 0.2 * SHARE
        assert found.time_sigma_s < 0.4 * TIME_S
        inside += [
            abs(found.share - SHARE) < 2.0 * found.share_sigma,
            abs(found.time_s - TIME_S) < 2.0 * found.time_sigma_s,
            *(abs(one.value - t) < 2.0 * one.sigma
              for one, t in zip(tube.fitted, true, strict=True) if one.told),
        ]  # fmt: skip
        assert tube.rmse_deg < 1.15 * 0.3
    assert np.mean(inside) >= 0.93


def test_nothing_is_fitted_where_nothing_was_held(samples: Path) -> None:
    timed = read(RISING, drawn(1), 1)
    tube = calibrated(timed, samples)
    assert tube.relaxation is None
    assert "relaxes" not in tube_text(tube)
    untimed = [AngleReading(r.pressure_bar, r.joint, r.theta_deg, r.sigma_deg) for r in timed]
    assert tube_json(calibrated(untimed, samples)) == tube_json(tube)


def test_a_tube_that_relaxes_is_said_and_comes_back(samples: Path, tmp_path: Path) -> None:
    tube = calibrated(read(HELD, drawn(2), 2), samples)
    assert "all else is of the relaxed tube" in tube_text(tube)
    (tmp_path / "tube.json").write_bytes(tube_json(tube))
    again = load_tube(tmp_path / "tube.json")
    assert again.relaxation is not None
    assert again.relaxation.told
    assert tube_json(again) == tube_json(tube)


def test_one_time_has_one_pressure() -> None:
    readings = [AngleReading(bar, 1, 5.0, 1.0, 2.0) for bar in (0.4, 0.6)]
    with pytest.raises(UnreadableInput, match="two pressures at 2 s"):
        History.of(readings)
