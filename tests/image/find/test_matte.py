"""The soft edge of a disc whose place is known."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from profiletool.image.find.matte import edge_field
from tests.image.find.discs import disc

GROUND, OBJECT = np.array([210.0, 205.0, 190.0]), np.array([90.0, 60.0, 40.0])


def disc_on_ground(colour: np.ndarray = OBJECT) -> np.ndarray:
    cover = disc(150, 110, 60)[..., None]
    return np.asarray(np.round(GROUND * (1 - cover) + colour * cover), np.uint8)


def radius_of(field: np.ndarray) -> float:
    return float(np.sqrt(field.sum() / np.pi))


@pytest.mark.parametrize("off", [-2, 0, 2])
def test_a_region_that_is_off_by_two_pixels_is_set_right(off: int) -> None:
    picture = disc_on_ground()
    field = edge_field(picture, disc(150, 110, 60 + off) > 0.5, picture)
    assert radius_of(field) == pytest.approx(60.0, abs=0.15)
    np.testing.assert_allclose(field, disc(150, 110, 60), atol=0.25)
    assert (field.min(), field.max()) == (0.0, 1.0)


def test_the_edge_is_found_in_the_finer_picture() -> None:
    picture = disc_on_ground()
    small = cv2.resize(picture, None, fx=0.5, fy=0.5, interpolation=cv2.INTER_AREA)
    field = edge_field(picture, disc(150, 110, 60)[::2, ::2] > 0.5, np.asarray(small, np.uint8))
    assert field.shape == picture.shape[:2]
    assert radius_of(field) == pytest.approx(60.0, abs=0.15)


def test_without_contrast_the_rough_region_stands() -> None:
    noise = np.random.default_rng(0).normal(0.0, 3.0, (240, 320, 3))
    picture = np.asarray(np.round(GROUND + noise), np.uint8)
    rough = disc(150, 110, 50) > 0.5
    field = edge_field(picture, rough, picture)
    assert ((field > 0.5) != rough).mean() < 1e-3
