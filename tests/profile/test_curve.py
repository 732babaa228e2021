from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from profiletool.profile.curve import arc_length, make_curve, resample, smoothing_width

FINE = np.linspace(0.0, 1.0, 2001)


def arc(radius: float, turn: float) -> np.ndarray:
    t = turn * FINE
    return radius * np.column_stack([np.sin(t), 1.0 - np.cos(t)])


def test_arc_length_of_a_3_4_5_step() -> None:
    assert arc_length(np.array([[0.0, 0.0], [3.0, 4.0], [3.0, 5.0]])).tolist() == [0.0, 5.0, 6.0]


def test_resample_keeps_the_ends_and_drops_repeated_points() -> None:
    line = resample(np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 0.0], [3.0, 0.0]]), 1.0)
    np.testing.assert_allclose(line, [[0, 0], [1, 0], [2, 0], [3, 0]], atol=1e-12)


@pytest.mark.parametrize("radius", [10.0, 30.0, 200.0])
@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_curvature_of_a_circle(radius: float, sense: float) -> None:
    curve = make_curve(arc(radius, 2.0) * [1.0, sense], 0.1, 1.0)
    np.testing.assert_allclose(curve.curvature * radius * sense, 1.0, atol=0.02)
    assert curve.s[-1] == pytest.approx(2.0 * radius, rel=1e-4)
    assert (curve.heading[-1] - curve.heading[0]) * sense == pytest.approx(2.0, abs=1e-3)


def test_curvature_of_an_ellipse_at_its_vertices() -> None:
    t = np.pi * (FINE - 0.5)
    a, b = 40.0, 25.0
    curve = make_curve(np.column_stack([a * np.cos(t), b * np.sin(t)]), 0.1, 1.0)
    assert curve.curvature.max() == pytest.approx(a / b**2, rel=0.01)
    assert curve.curvature[[0, -1]] == pytest.approx([b / a**2] * 2, rel=0.03)


def test_a_straight_line_has_none() -> None:
    curve = make_curve(np.array([[0.0, 0.0], [30.0, 40.0]]), 0.5, 2.0)
    np.testing.assert_allclose(curve.curvature, 0.0, atol=1e-12)
    np.testing.assert_allclose(curve.heading, np.arctan2(4, 3), atol=1e-12)


def test_heading_is_unwrapped() -> None:
    curve = make_curve(arc(20.0, 7.0), 0.1, 1.0)
    assert np.ptp(curve.heading) == pytest.approx(7.0, abs=1e-3)


@given(st.integers(0, 2**32 - 1), st.sampled_from([0.05, 0.2, 0.5]))
def test_the_window_keeps_the_noise_of_the_heading_below_a_degree(seed: int, px: float) -> None:
    noise = 0.2 * px
    line = np.column_stack([np.arange(0.0, 100.0, px), np.zeros(int(np.ceil(100.0 / px)))])
    line[:, 1] += noise * np.random.default_rng(seed).standard_normal(len(line))
    curve = make_curve(line, px, 2.0 * smoothing_width(noise, px))
    assert np.degrees(np.std(curve.heading)) < 1.0


def test_no_noise_asks_for_no_smoothing() -> None:
    assert smoothing_width(0.0, 0.1) == 0.0
