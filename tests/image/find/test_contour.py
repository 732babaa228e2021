"""The contour against shapes whose edge is known exactly."""

from __future__ import annotations

import numpy as np
import pytest

from profiletool.image.find.contour import (
    largest_region,
    outline,
    position_noise,
    signed_area,
    smoothed,
)

CENTRE = np.array([60.3, 58.7])


def distances(size: int = 120) -> np.ndarray:
    y, x = np.mgrid[:size, :size]
    return np.hypot(x - CENTRE[0], y - CENTRE[1])


def traced(field: np.ndarray) -> tuple[np.ndarray, float]:
    field = field.astype(np.float32)
    return smoothed(outline(field, largest_region(field)))


@pytest.mark.parametrize(
    ("field", "limit"),
    [(np.clip(40.5 - distances(), 0, 1), 0.05), (distances() < 40, 0.3)],
    ids=["anti-aliased", "binary"],
)
def test_disc_is_traced_to_a_fraction_of_a_pixel(field: np.ndarray, limit: float) -> None:
    contour, noise = traced(field)
    error = np.hypot(*(contour - CENTRE).T) - 40
    assert np.sqrt(np.mean(error**2)) < limit
    assert abs(error.mean()) < 0.03
    assert noise < limit


@pytest.mark.parametrize(
    ("rows", "columns"),
    [((3, 9), (5, 14)), ((0, 20), (4, 7)), ((0, 20), (0, 30)), ((7, 8), (7, 8))],
)
def test_binary_rectangle_lies_on_pixel_boundaries(
    rows: tuple[int, int], columns: tuple[int, int]
) -> None:
    field = np.zeros((20, 30))
    field[slice(*rows), slice(*columns)] = 1
    contour, _ = traced(field)
    np.testing.assert_allclose(contour.min(axis=0), [columns[0] - 0.5, rows[0] - 0.5])
    np.testing.assert_allclose(contour.max(axis=0), [columns[1] - 0.5, rows[1] - 0.5])


def test_contour_runs_down_the_left_side() -> None:
    contour, _ = traced(distances() < 40)
    assert signed_area(contour) < 0
    step = np.roll(contour, -1, axis=0) - contour
    assert step[contour[:, 0] < CENTRE[0] - 35, 1].mean() > 0


def test_holes_and_specks_do_not_count() -> None:
    field = np.zeros((40, 40))
    field[5:30, 5:30] = 1
    field[10:15, 10:15] = 0
    field[35:37, 35:37] = 1
    mask = largest_region(field.astype(np.float32))
    assert mask.sum() == 25 * 25
    contour, _ = traced(field)
    np.testing.assert_allclose(np.ptp(contour, axis=0), [25, 25])


@pytest.mark.parametrize("sigma", [0.05, 0.2, 0.5])
def test_noise_is_measured(sigma: float) -> None:
    angle = np.linspace(0, 2 * np.pi, 3000, endpoint=False)
    knots = np.random.default_rng(1).normal(0, sigma, 3000 // 5)
    radius = 480 / (2 * np.pi) * 1.25 + np.interp(np.arange(3000), np.arange(600) * 5, knots)
    polygon = np.stack([radius * np.cos(angle), -radius * np.sin(angle)], axis=1)
    assert position_noise(polygon) == pytest.approx(sigma, rel=0.3)


def test_corners_and_curvature_are_no_noise() -> None:
    square = np.array([[0.0, 0], [0, 50], [50, 50], [50, 0]])
    assert position_noise(square) < 1e-6
    angle = np.linspace(0, 2 * np.pi, 500, endpoint=False)
    assert position_noise(15 * np.stack([np.cos(angle), np.sin(angle)], axis=1)) < 0.02


def test_smoothing_removes_noise_and_keeps_size() -> None:
    rng = np.random.default_rng(2)
    field = np.clip(40.5 - distances() + rng.normal(0, 0.25, (120, 120)), 0, 1).astype(np.float32)
    raw = outline(field, largest_region(field))
    calm, _ = smoothed(raw)
    before, after = (np.hypot(*(points - CENTRE).T) - 40 for points in (raw, calm))
    assert after.std() < 0.8 * before.std()
    assert abs(after.mean()) < 0.05
