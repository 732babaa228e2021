from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest

from formula.data import Data
from formula.errors import BadFormula
from formula.files import load_formula
from formula.fit import best, candidates, errors_of, fit_paper
from formula.theta import Formula, Terms, theta_deg

ALPHA = np.array([84.0, 108.0, 120.0, 132.0, 156.0])
OPENF = np.array([6.0, 8.0, 10.0, 12.0, 14.0])
PRESSURE = 0.2 * np.arange(1.0, 11.0)
PAPER = load_formula()


def made_by(terms: Terms, noise: float = 0.0) -> Data:
    theta = value(terms, ALPHA[:, None, None], OPENF[:, None], PRESSURE)
    theta = theta + noise * np.random.default_rng(3).normal(size=theta.shape)
    return Data(ALPHA, OPENF, PRESSURE, theta)


def value(terms: Terms, alpha: np.ndarray, openF: np.ndarray, P: np.ndarray) -> np.ndarray:
    formula = Formula("", "", "", terms, 20.0, 2.0, (84.0, 156.0), (6.0, 14.0), (0.0, 2.0))
    return theta_deg(formula, alpha, openF, P)


def reference(shared: Path, file: str) -> Data:
    with (shared / "reference" / file).open() as stream:
        rows = np.array([[float(v) for v in row.values()] for row in csv.DictReader(stream)])
    theta = np.full((5, 5, 10), np.nan)
    for a, o, P, t in rows:
        theta[np.searchsorted(ALPHA, a), np.searchsorted(OPENF, o), round(5 * P) - 1] = t
    return Data(ALPHA, OPENF, PRESSURE, theta)


def test_the_papers_steps_give_back_its_own_coefficients() -> None:
    fit = fit_paper(made_by(PAPER.terms))
    # P is the paper's Table 3 by hand here: a1 at alpha 84.
    assert fit.a1[0] == pytest.approx(-0.000166 * 84**2 + 0.031915 * 84 - 0.856229, rel=1e-9)
    assert fit.slope[0, 4] == pytest.approx(fit.a1[0] + fit.a2[0], rel=1e-9)
    np.testing.assert_allclose(np.array(fit.terms), np.array(PAPER.terms), rtol=1e-6, atol=1e-12)
    assert min(fit.line_R2.min(), fit.slope_R2.min(), fit.a1_R2, fit.a3_R2) > 1.0 - 1e-9


def test_R2_is_the_share_that_is_explained() -> None:
    theta = np.zeros((3, 3, 1))
    theta[:, :, 0] = [0.0, 1.0, 5.0]  # the line through 0, 1, 5 leaves 1.5 of 14
    fit = fit_paper(Data(ALPHA[:3], OPENF[:3], PRESSURE[:2], np.repeat(theta, 2, axis=2)))
    assert fit.line_R2[0, 0] == pytest.approx(1.0 - 1.5 / 14.0)


def test_a_cubic_is_found_by_cross_validation_and_nothing_larger() -> None:
    cubic = (
        ((4.0, -0.01, 1e-5), (0.3, 0.001, -1e-5), (0.2, -0.002, 1e-5)),
        ((0.9, -0.002, 1e-6), (-0.2, 0.01, -5e-5), (0.4, -0.004, 1e-5)),
    )
    data = made_by(cubic, noise=0.02)
    chosen = best(candidates(data))
    assert chosen.powers == (1, 3, 2)
    assert chosen.errors.rms == pytest.approx(0.02, rel=0.15)
    assert 0.02 < chosen.validated.rms < 0.025
    alpha, openF, P, _ = data.points
    np.testing.assert_allclose(
        value(chosen.terms, alpha, openF, P), value(cubic, alpha, openF, P), atol=0.05
    )


def test_cross_validation_leaves_the_run_itself_out() -> None:
    data = made_by(PAPER.terms)
    theta = data.theta_deg.copy()
    theta[2, 2] += 5.0  # one run is wrong
    wrong = Data(ALPHA, OPENF, PRESSURE, theta)
    smallest = min(candidates(wrong), key=lambda c: c.size)
    # Predicted from the others it is off by nearly all of it, fitted with them by less.
    assert smallest.validated.largest > 5.0
    assert smallest.errors.largest < 4.9


def test_runs_that_ended_early_are_left_out() -> None:
    data = made_by(PAPER.terms)
    theta = data.theta_deg.copy()
    theta[0, 4, 6:] = np.nan
    theta[3, 1] = np.nan
    holes = Data(ALPHA, OPENF, PRESSURE, theta)
    np.testing.assert_allclose(
        np.array(fit_paper(holes).terms), np.array(PAPER.terms), rtol=1e-6, atol=1e-12
    )
    chosen = best(candidates(holes))
    assert chosen.errors.largest < 1e-9
    assert len(holes.points[0]) == len(holes.run) == 250 - 4 - 10


def test_errors_are_told_by_pressure() -> None:
    data = made_by(PAPER.terms)
    errors = errors_of(data, lambda a, o, P: value(PAPER.terms, a, o, P) + (P > 1.9))
    assert errors.by_pressure[-1] == pytest.approx((1.0, 1.0))
    assert errors.by_pressure[0] == pytest.approx((0.0, 0.0))
    assert errors.rms == pytest.approx(np.sqrt(0.1))


def test_too_few_runs() -> None:
    few = Data(ALPHA[:2], OPENF[:1], PRESSURE, np.ones((2, 1, 10)))
    with pytest.raises(BadFormula, match="two openF"):
        candidates(few)
    with pytest.raises(BadFormula, match="three alphas"):
        fit_paper(few)


def test_the_measured_campaign(shared: Path) -> None:
    """On the converged reference: the figures that are known of both forms."""
    data = reference(shared, "joint_campaign.csv")
    chosen = best(candidates(data))
    assert chosen.size == 18
    assert chosen.errors.rms < 0.09
    assert chosen.validated.rms < 0.15
    fit = fit_paper(data)
    assert fit.line_R2.min() >= 0.9997
    paper = errors_of(data, lambda a, o, P: value(fit.terms, a, o, P))
    assert 0.45 <= paper.rms <= 0.55
    against = errors_of(data, lambda a, o, P: theta_deg(PAPER, a, o, P))
    known = {0.2: 0.13, 0.6: 0.34, 1.0: 0.8, 1.4: 2.0, 2.0: 7.1}
    for P, rms in known.items():
        assert against.by_pressure[round(5 * P) - 1][0] == pytest.approx(rms, rel=0.1)
