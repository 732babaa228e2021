"""Fits to uniaxial tests."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq

from fem.arrays import FloatArray
from fem.material import PAPER_RUBBER, MooneyRivlin, kinematics
from profiletool.errors import UnreadableInput
from profiletool.rubber.presets import NUS
from profiletool.rubber.uniaxial import (
    MOST_POINTS,
    WORST_RMS,
    fit_uniaxial,
    read_uniaxial,
    uniaxial_stress,
)

CURVE = np.linspace(0.7, 2.0, 27)


def lateral_free(law: MooneyRivlin, stretch: float) -> float:
    """Axial stress of F = diag(stretch, t, t) by bisection for t, straight from fem.material."""

    def piola(t: float) -> FloatArray:
        k = kinematics(np.diag([stretch, t, t])[:, :, None])
        return law.stress(k, law.volumetric(k.J)[1])[:, :, 0]

    # between a twentieth of the volume and five times: at nu 0.3 the law yields a lot
    low, high = np.sqrt(0.05 / stretch), np.sqrt(5.0 / stretch)
    t = brentq(lambda t: float(piola(t)[1, 1]), low, high, xtol=1e-15)
    assert isinstance(t, float)
    assert abs(piola(t)[2, 2]) < 1e-9
    return float(piola(t)[0, 0])


def noisy(seed: int, law: MooneyRivlin, sigma: float) -> tuple[FloatArray, FloatArray]:
    lam = np.linspace(1.02, 2.2, 200)
    return lam, uniaxial_stress(law, lam) + sigma * np.random.default_rng(seed).normal(
        size=lam.size
    )


@pytest.mark.parametrize("nu", [0.3, 0.46, 0.4995])
@pytest.mark.parametrize(("C10", "C01"), [(0.0694, 0.0628), (0.1, 0.0), (0.0, 0.1)])
def test_the_curve_is_that_of_a_strip_with_free_sides(C10: float, C01: float, nu: float) -> None:
    law = MooneyRivlin.from_poisson(C10, C01, nu)
    lam = np.array([0.4, 0.7, 0.95, 1.0, 1.3, 2.0, 4.0, 8.0])
    expected = [lateral_free(law, x) for x in lam]
    assert uniaxial_stress(law, lam) == pytest.approx(np.array(expected), rel=1e-8, abs=1e-9)


def test_the_curve_of_a_nearly_incompressible_rubber() -> None:
    law = MooneyRivlin.from_poisson(0.0694, 0.0628, 0.49999)
    expected = 2.0 * (CURVE - CURVE**-2) * (0.0694 + 0.0628 / CURVE)
    assert uniaxial_stress(law, CURVE) == pytest.approx(expected, rel=1e-4)


@given(
    st.floats(1e-3, 1.0),
    st.floats(0.0, 1.0),
    st.floats(*NUS),
    st.lists(st.floats(0.6, 3.0), min_size=3, max_size=10),
)
@settings(max_examples=8)
@example(0.1, 0.0, 0.46, [1.1, 1.2, 1.3])
@example(0.1, 1.0, 0.46, [1.1, 1.2, 1.3])
@pytest.mark.slow
def test_the_fit_recovers_the_law_of_exact_data(
    sum_MPa: float, share: float, nu: float, more: list[float]
) -> None:
    C10, C01 = sum_MPa * (1.0 - share), sum_MPa * share
    law = MooneyRivlin.from_poisson(C10, C01, nu)
    lam = np.array([1.9, 1.05, 1.2, 1.4, 1.6, *more])  # in any order
    fit = fit_uniaxial(lam, uniaxial_stress(law, lam), nu)
    assert pytest.approx(C10, abs=1e-6 * sum_MPa) == fit.law.C10
    assert pytest.approx(C01, abs=1e-6 * sum_MPa) == fit.law.C01
    assert pytest.approx(law.K, rel=1e-6) == fit.law.K
    assert fit.rms_MPa < 1e-6 * sum_MPa
    assert fit.r2 == pytest.approx(1.0, abs=1e-9)
    assert fit.points == lam.size
    assert fit.stretch_range == (lam.min(), lam.max())


@pytest.mark.slow
def test_the_fit_to_noisy_data_is_within_its_error_bars() -> None:
    law, sigma, step = PAPER_RUBBER, 0.01, 1e-6
    lam = noisy(0, law, 0.0)[0]
    columns = [
        MooneyRivlin.from_poisson(law.C10 + dC10, law.C01 + dC01, 0.46)
        for dC10, dC01 in ((step, 0.0), (0.0, step))
    ]
    A = np.column_stack(
        [(uniaxial_stress(c, lam) - uniaxial_stress(law, lam)) / step for c in columns]
    )
    covariance = sigma**2 * np.linalg.inv(A.T @ A)
    fits = [fit_uniaxial(*noisy(seed, law, sigma), 0.46) for seed in range(30)]
    off = np.array([(f.law.C10 - law.C10, f.law.C01 - law.C01) for f in fits])
    bars = np.sqrt(np.diag(covariance))
    assert bars == pytest.approx([0.002, 0.0035], rel=0.1)  # the test can tell C10 from C01
    assert np.all(np.abs(off) < 4.0 * bars)
    assert np.all(np.abs(off.mean(axis=0)) < 4.0 * bars / np.sqrt(len(fits)))
    chi2 = np.einsum("ni,ij,nj->n", off, np.linalg.inv(covariance), off)
    assert chi2.mean() == pytest.approx(2.0, abs=4.0 * 2.0 / np.sqrt(len(fits)))
    rms = [f.rms_MPa for f in fits]
    assert np.mean(rms) == pytest.approx(sigma, rel=0.05)


def test_the_fit_is_the_best_of_its_neighbours() -> None:
    lam, measured = noisy(3, PAPER_RUBBER, 0.01)
    fit = fit_uniaxial(lam, measured, 0.46)

    def rms(C10: float, C01: float) -> float:
        off = uniaxial_stress(MooneyRivlin.from_poisson(C10, C01, 0.46), lam) - measured
        return float(np.sqrt(np.mean(off**2)))

    C10, C01 = fit.law.C10, fit.law.C01
    assert rms(C10, C01) == pytest.approx(fit.rms_MPa, rel=1e-9)
    for dC10, dC01 in ((1, 0), (-1, 0), (0, 1), (0, -1), (1, -1), (-1, 1)):
        assert rms(C10 + 1e-4 * dC10, C01 + 1e-4 * dC01) > fit.rms_MPa
    total = np.mean((measured - measured.mean()) ** 2)
    assert fit.r2 == pytest.approx(1.0 - fit.rms_MPa**2 / total, rel=1e-12)


def test_a_curve_that_stiffens_gives_neo_hooke() -> None:
    lam = np.linspace(1.05, 2.0, 30)
    yeoh = 2.0 * (lam - lam**-2) * (0.11 + 0.04 * (lam**2 + 2.0 / lam - 3.0))
    fit = fit_uniaxial(lam, yeoh, 0.46)
    assert fit.law.C01 == 0.0
    assert 0.11 < fit.law.C10 < 0.19
    assert 0.01 < fit.rms_MPa / np.ptp(yeoh) < WORST_RMS


def test_the_fitted_law_reproduces_the_test_in_fem() -> None:
    lam, measured = noisy(1, PAPER_RUBBER, 1e-4)
    fit = fit_uniaxial(lam, measured, 0.46)
    through_fem = np.array([lateral_free(fit.law, x) for x in lam[::20]])
    assert through_fem == pytest.approx(measured[::20], abs=5e-4)


@pytest.mark.parametrize(
    ("lam", "measured", "says"),
    [
        ([1.1, 1.2, 1.3, 1.4], [0.1, 0.2, 0.3, 0.4], "only 4 different stretches"),
        ([1.5] * 9, [0.3] * 9, "only 1 different"),
        ([0.5, 0.6, 0.7, 0.8, 0.9, 1.2], [0.1] * 6, "only 1 different"),
        ([1.01, 1.02, 1.03, 1.04, 1.05], [0.1, 0.2, 0.3, 0.4, 0.5], "to tell C10 from C01"),
        ([0.0, 1.2, 1.3, 1.4, 1.5, 1.6], [0.0] * 6, '"strain,stress"'),
        ([1.0, 5.0, 10.0, 50.0, 90.0, 100.0], [0.1] * 6, "in percent"),
        ([1.1, 1.2, 1.3, 1.4, np.nan], [0.1] * 5, "not finite"),
        ([1.1, 1.2, 1.3, 1.4, 1.5], [0.1, 0.1, 0.1, 0.1, np.inf], "not finite"),
        ([1.1, 1.2, 1.3, 1.4, 1.5], [0.5, 0.4, 0.3, 0.2, 0.1], "no stable Mooney-Rivlin"),
        ([1.1, 1.2, 1.3, 1.4, 1.5], [-0.1, -0.2, -0.3, -0.4, -0.5], "no stable Mooney-Rivlin"),
        ([1.1, 1.2, 1.3, 1.4, 1.5], [0.0] * 5, "no stable Mooney-Rivlin"),
        ([1.1, 1.2, 1.3, 1.4, 1.5], [0.01, 0.02, 0.04, 0.3, 2.0], "no stable Mooney-Rivlin"),
        ([1.1, 1.2, 1.3, 1.4, 1.5], [60.0, 110.0, 150.0, 190.0, 220.0], "check the unit"),
        ([1.1, 1.2, 1.3, 1.4, 1.5], [1e9] * 5, "check its unit"),
        (np.linspace(1.0, 2.0, MOST_POINTS + 1), np.ones(MOST_POINTS + 1), "thin them out"),
    ],
)
def test_a_test_that_gives_no_law_is_refused(
    lam: list[float], measured: list[float], says: str
) -> None:
    with pytest.raises(UnreadableInput) as caught:
        fit_uniaxial(lam, measured, 0.46)
    assert says in str(caught.value)
    assert "\n" not in str(caught.value)


def test_the_limit_of_15_percent_rms() -> None:
    lam = np.linspace(1.05, 2.0, 200)
    clean = uniaxial_stress(PAPER_RUBBER, lam)
    wave = np.where(np.arange(lam.size) % 2, 1.0, -1.0)

    def share(height: float) -> float:
        return height / float(np.ptp(clean + height * wave))

    below, above = (brentq(lambda h, s=s: share(h) - s, 0.01, 0.5) for s in (0.148, 0.152))
    assert fit_uniaxial(lam, clean + below * wave, 0.46).rms_MPa == pytest.approx(below, rel=0.01)
    with pytest.raises(UnreadableInput, match="within 15 %"):
        fit_uniaxial(lam, clean + above * wave, 0.46)


def test_lists_of_different_length_are_a_mistake_of_the_caller() -> None:
    with pytest.raises(ValueError, match="same length"):
        fit_uniaxial([1.0, 2.0], [1.0], 0.46)


def test_true_stress_beside_nominal_stress_is_passed_over() -> None:
    text = "Time (s);True Strain;True Stress (MPa);Engineering Strain;Engineering Stress (MPa)\n"
    lam, measured = read_uniaxial((text + "0,1;0,09531;0,11;0,1;0,1\n").encode())
    assert lam == pytest.approx([1.1])
    assert measured == pytest.approx([0.1])


def test_a_latin_1_header_is_read() -> None:
    lam, measured = read_uniaxial("stretch,stress (N/mm²)\n1.5,2\n".encode("latin-1"))
    assert (lam.tolist(), measured.tolist()) == ([1.5], [2.0])
