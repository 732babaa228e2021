"""Least squares within bounds, against scipy's and against closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import least_squares, lsq_linear

from profiletool.joints.optimal.descent import bounded_step, descend
from profiletool.records.units import FloatArray

SCALE = np.array([0.5, 2.0, 10.0])


def problem(seed: int) -> tuple[FloatArray, FloatArray]:
    rng = np.random.default_rng(seed)
    return rng.normal(size=(20, 3)) / SCALE, rng.normal(size=20)


@pytest.mark.parametrize("seed", range(4))
def test_a_linear_step_is_the_bounded_least_squares_one(seed: int) -> None:
    A, r = problem(seed)
    room = -0.05 * SCALE, 0.1 * SCALE
    found = bounded_step(A, r, room, SCALE, 0.0)
    expected = lsq_linear(A, -r, room, method="bvls").x
    np.testing.assert_allclose(found, expected, rtol=1e-5, atol=1e-7)
    free = bounded_step(A, r, (np.full(3, -1e9), np.full(3, 1e9)), SCALE, 0.0)
    np.testing.assert_allclose(free, np.linalg.lstsq(A, -r, rcond=None)[0], rtol=1e-6)


def test_damping_shortens_a_step_and_no_room_means_no_step() -> None:
    A, r = problem(5)
    wide = np.full(3, -1e9), np.full(3, 1e9)
    lengths = [
        np.linalg.norm(bounded_step(A, r, wide, SCALE, damping) / SCALE)
        for damping in (0.0, 0.1, 10.0)
    ]
    assert lengths == sorted(lengths, reverse=True)
    held = bounded_step(A, r, (np.array([-1.0, 0.0, -9.0]), np.array([1.0, 0.0, 9.0])), SCALE, 0.0)
    assert held[1] == 0.0
    assert np.abs(held[[0, 2]]).min() > 0.0
    np.testing.assert_array_equal(bounded_step(A, r, (np.zeros(3), np.zeros(3)), SCALE, 0.0), 0.0)


def test_a_curved_valley_is_followed_to_its_bottom_within_the_bounds() -> None:
    """Rosenbrock's, whose least is at (1, 1)."""

    def residuals(x: FloatArray) -> FloatArray:
        return np.array([10.0 * (x[1] - x[0] ** 2), 1.0 - x[0]])

    def jacobian(x: FloatArray) -> FloatArray:
        return np.array([[-20.0 * x[0], 10.0], [-1.0, 0.0]])

    start, scale = np.array([-1.2, 1.0]), np.ones(2)
    for high in (2.0, 0.8):
        bounds = np.full(2, -2.0), np.full(2, high)
        found = descend(residuals, jacobian, start, bounds, scale, 200)
        known = least_squares(residuals, np.zeros(2), jacobian, bounds).x
        np.testing.assert_allclose(found, known, atol=0.02)
        assert (found <= high).all()


def test_it_never_gets_worse_and_asks_for_few_slopes() -> None:
    A, r = problem(7)
    asked: list[FloatArray] = []

    def jacobian(x: FloatArray) -> FloatArray:
        asked.append(x)
        return A

    wide = np.full(3, -1e9), np.full(3, 1e9)
    found = descend(lambda x: A @ x + r, jacobian, np.zeros(3), wide, SCALE, 1)
    assert len(asked) == 1
    assert np.linalg.norm(A @ found + r) < np.linalg.norm(r)
    # At the least already, nothing is gained.
    least = np.linalg.lstsq(A, -r, rcond=None)[0]
    again = descend(lambda x: A @ x + r, jacobian, least, wide, SCALE, 5)
    np.testing.assert_allclose(again, least, rtol=1e-6)
    assert len(asked) <= 3
