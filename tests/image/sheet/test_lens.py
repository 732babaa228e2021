"""Cameras that are known, found back from the corners that they see."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest

from profiletool.image.sheet.lens import View, fit_view
from profiletool.records.units import FloatArray

SIZE = (1200, 900)
FOCAL = 1300.0
BOARD = np.stack(np.meshgrid(np.arange(0.0, 181.0, 20.0), np.arange(0.0, 261.0, 20.0)), -1)
CORNERS = BOARD.reshape(-1, 2)


def seen(
    tilt_deg: float, height: float = 600.0, k: tuple[float, float] = (0.0, 0.0)
) -> tuple[FloatArray, FloatArray]:
    """Corners as OpenCV projects them, and the camera's place on the board."""
    turn = np.radians([tilt_deg, 0.0, 10.0])
    rotation = cv2.Rodrigues(turn)[0]
    middle = np.array([90.0, 130.0, 0.0])
    shift = np.array([0.0, 0.0, height]) - rotation @ middle
    matrix = np.array([[FOCAL, 0.0, 599.5], [0.0, FOCAL, 449.5], [0.0, 0.0, 1.0]])
    points = np.column_stack([CORNERS, np.zeros(len(CORNERS))])
    px, _ = cv2.projectPoints(points, turn, shift, matrix, np.array([*k, 0.0, 0.0]))
    return np.asarray(px).reshape(-1, 2), (-rotation.T @ shift) * [1.0, 1.0, -1.0]


@pytest.mark.parametrize("tilt", [8.0, 30.0])
@pytest.mark.parametrize("k", [(0.0, 0.0), (-0.12, 0.0)])
def test_a_camera_is_found_back(tilt: float, k: tuple[float, float]) -> None:
    px, place = seen(tilt, k=k)
    view = fit_view(px, CORNERS, SIZE, FOCAL)
    assert view.rms_px < 0.01
    assert view.tilt_deg == pytest.approx(np.degrees(np.arccos(cv2.Rodrigues(
        np.radians([tilt, 0.0, 10.0]))[0][2, 2])), abs=0.1)  # fmt: skip
    np.testing.assert_allclose(view.camera_mm, place, rtol=0.01, atol=2.0)
    assert view.terms == (0 if k == (0.0, 0.0) else 1)
    assert view.values[1] == pytest.approx(k[0], abs=2e-3)  # k1
    assert view.kept.all()


def test_picture_and_sheet_are_brought_onto_each_other() -> None:
    px, _ = seen(25.0, k=(-0.12, 0.0))
    view = fit_view(px, CORNERS, SIZE, FOCAL)
    np.testing.assert_allclose(view.picture_of(CORNERS), px, atol=0.03)
    np.testing.assert_allclose(view.sheet_of(px), CORNERS, atol=0.01)
    places = np.array([[[3.0, 5.0], [100.0, 200.0]]])
    np.testing.assert_allclose(view.sheet_of(view.picture_of(places)), places, atol=1e-6)


def test_a_misread_corner_is_left_out() -> None:
    px, place = seen(25.0)
    px[17] += [40.0, -25.0]
    view = fit_view(px, CORNERS, SIZE, FOCAL)
    assert np.flatnonzero(~view.kept).tolist() == [17]
    np.testing.assert_allclose(view.camera_mm, place, rtol=0.01, atol=2.0)


def test_a_sheet_seen_squarely_leaves_the_height_to_the_stored_focal_length() -> None:
    px, _ = seen(0.0)
    stored, unknown = (fit_view(px, CORNERS, SIZE, focal) for focal in (FOCAL, None))
    tilted = fit_view(seen(30.0)[0], CORNERS, SIZE, None)
    assert stored.height_share == pytest.approx(0.04, rel=0.2)
    assert unknown.height_share > 0.3
    assert tilted.height_share < 0.02


def test_more_scatter_means_less_sure_sizes() -> None:
    px, _ = seen(20.0)
    noise = np.random.default_rng(0).normal(size=px.shape)
    shares = [
        fit_view(px + sigma * noise, CORNERS, SIZE, FOCAL).size_share(CORNERS)
        for sigma in (0.05, 0.5)
    ]
    assert 5.0 < shares[1] / shares[0] < 20.0


def test_covariance_scales_the_shares() -> None:
    view = fit_view(seen(20.0)[0], CORNERS, SIZE, FOCAL)
    doubled: View = replace(view, covariance=4.0 * view.covariance)
    assert doubled.height_share == pytest.approx(2.0 * view.height_share)
    assert doubled.size_share(CORNERS) == pytest.approx(2.0 * view.size_share(CORNERS))
