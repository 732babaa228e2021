from __future__ import annotations

import numpy as np
import pytest

from formula.data import Data
from formula.similar import CORRECTIONS, carried, corrected, correction_runs

ALPHA = np.array([84.0, 108.0, 120.0, 132.0, 156.0])
OPENF = np.array([6.0, 8.0, 10.0, 12.0, 14.0])
PRESSURE = 0.2 * np.arange(1.0, 11.0)


def theta(alpha: np.ndarray, openF: np.ndarray, P: np.ndarray) -> np.ndarray:
    """Some smooth law of the dimensionless numbers, as a tube of 20 mm has it."""
    shape = np.sin(0.01 * (200.0 - alpha)) + 0.2
    return (0.9 * openF + 3.0) * shape * (P + 0.3 * P**2 + 0.1 * P**3)


def grid(alpha: np.ndarray, openF: np.ndarray, P: np.ndarray) -> np.ndarray:
    return theta(alpha[:, None, None], openF[:, None], P)


KNOWN = Data(ALPHA, OPENF, PRESSURE, grid(ALPHA, OPENF, PRESSURE))


def test_the_same_tube_is_known_already() -> None:
    found = carried(KNOWN, ALPHA, OPENF, PRESSURE, 1.0, 1.0)
    np.testing.assert_allclose(found, KNOWN.theta_deg, rtol=1e-12)


def test_lengths_go_with_the_diameter_and_pressures_with_the_rubber() -> None:
    openF, P = np.array([5.0, 6.4, 9.0]), np.array([0.3, 1.0, 3.9])
    found = carried(KNOWN, ALPHA, openF, P, 0.8, 2.0)
    np.testing.assert_allclose(found, grid(ALPHA, openF / 0.8, P / 2.0), rtol=2e-3)


def test_longer_cuts_go_on_along_the_line() -> None:
    openF = np.array([4.0, 10.0, 20.0])
    found = carried(KNOWN, ALPHA, openF, PRESSURE, 1.0, 1.0)
    np.testing.assert_allclose(found, grid(ALPHA, openF, PRESSURE), rtol=1e-9)


def test_what_is_not_known_is_not_made_up() -> None:
    found = carried(KNOWN, np.array([60.0, 100.0]), OPENF, np.array([1.0, 2.5]), 1.0, 1.0)
    assert np.isnan(found[0]).all()
    assert np.isnan(found[1, :, 1]).all()
    assert np.isfinite(found[1, :, 0]).all()


def test_a_campaign_with_gaps() -> None:
    holes = KNOWN.theta_deg.copy()
    holes[0, 4, 7:] = np.nan
    known = Data(ALPHA, OPENF, PRESSURE, holes)
    found = carried(known, ALPHA, OPENF, PRESSURE, 1.0, 1.0)
    assert np.isnan(found[0, 4, 7:]).all()
    np.testing.assert_allclose(found[1:], KNOWN.theta_deg[1:], rtol=1e-9)


def test_five_runs_or_fewer() -> None:
    assert len(correction_runs(ALPHA, OPENF)) == CORRECTIONS
    assert correction_runs(ALPHA, OPENF[:1]) == [(0, 0), (2, 0), (4, 0)]
    assert (2, 2) in correction_runs(ALPHA, OPENF)


def test_a_few_runs_correct_what_differs() -> None:
    # The new tube bends more, the more so the wider its sector and the longer its cut.
    factor = 1.1 + 0.001 * (ALPHA[:, None] - 100.0) + 0.004 * (OPENF - 8.0)
    truth = KNOWN.theta_deg * factor[..., None] * (1.0 + 0.02 * PRESSURE)
    made = np.full_like(truth, np.nan)
    for i, j in correction_runs(ALPHA, OPENF):
        made[i, j] = truth[i, j]
    few = Data(ALPHA, OPENF, PRESSURE, made)
    found = corrected(KNOWN.theta_deg, few, few)
    np.testing.assert_allclose(found.theta_deg, truth, rtol=1e-9)


def test_runs_that_were_made_stay_as_they_are() -> None:
    made = np.full_like(KNOWN.theta_deg, np.nan)
    rng = np.random.default_rng(1)
    for i, j in correction_runs(ALPHA, OPENF):
        made[i, j] = KNOWN.theta_deg[i, j] * rng.uniform(0.9, 1.1)
    few = Data(ALPHA, OPENF, PRESSURE, made)
    found = corrected(KNOWN.theta_deg, few, few)
    known = np.isfinite(made)
    assert np.array_equal(found.theta_deg[known], made[known])


def test_pressures_that_no_run_reached_are_left_out() -> None:
    made = np.full_like(KNOWN.theta_deg, np.nan)
    for i, j in correction_runs(ALPHA, OPENF):
        made[i, j, :8] = KNOWN.theta_deg[i, j, :8]
    few = Data(ALPHA, OPENF, PRESSURE, made)
    found = corrected(KNOWN.theta_deg, few, few)
    assert np.isnan(found.theta_deg[..., 8:]).all()
    assert found.theta_deg[..., :8] == pytest.approx(KNOWN.theta_deg[..., :8])
