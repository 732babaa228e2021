"""The picture of the candidates, read back."""

from __future__ import annotations

import io

import numpy as np
from PIL import Image

from profiletool.report.candidates import draw_candidates

Y, X = np.mgrid[:240, :320]
DISC = np.hypot(X - 150, Y - 110) <= 60
RED = np.array([0xD5, 0x5E, 0x00])


def drawn(*masks: np.ndarray, picture: np.ndarray | None = None) -> np.ndarray:
    rgb = np.full((*masks[0].shape, 3), 90, np.uint8) if picture is None else picture
    made = draw_candidates(rgb, [(mask, 0.4, "barriers") for mask in masks])
    return np.asarray(Image.open(io.BytesIO(made)).convert("RGB"))


def red(image: np.ndarray) -> np.ndarray:
    return np.abs(image.astype(int) - RED).max(axis=2) < 40


def test_every_candidate_has_a_panel_and_at_most_four() -> None:
    one = drawn(DISC)
    assert drawn(DISC, DISC, DISC).shape[1] == 3 * one.shape[1]
    assert drawn(*[DISC] * 6).shape[1] == 4 * one.shape[1]
    assert one.shape[0] < 800


def test_the_outline_is_that_of_the_mask() -> None:
    oval = np.hypot((X - 150) / 2.0, Y - 110) <= 40
    rows, columns = np.nonzero(red(drawn(oval)))
    assert len(rows) > 200
    # Twice as wide as high: the panel keeps the picture's shape.
    assert abs(np.ptp(columns) / np.ptp(rows) - 2.0) < 0.05
    empty = drawn(np.zeros_like(DISC))
    assert not red(empty).any()


def test_masks_of_the_whole_picture_and_large_ones() -> None:
    assert red(drawn(np.ones((240, 320), bool))).sum() > 500
    large = np.zeros((3000, 1200), bool)
    large[500:2500, 300:900] = True
    image = drawn(large)
    assert red(image).any()
    assert image.shape[0] < 1200


def test_the_same_bytes_again() -> None:
    rgb = np.full((240, 320, 3), 90, np.uint8)
    found = [(DISC, 0.312, "a_method $with signs$")]
    assert draw_candidates(rgb, found) == draw_candidates(rgb, found)
