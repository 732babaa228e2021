"""The measure of a mask, on masks that are right and masks that are wrong in known ways."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest

from profiletool.image.find.across import rim_of, steps
from profiletool.image.find.candidates import BELIEVED
from profiletool.image.find.colours import cells, histogram, likeness
from profiletool.image.find.judge import Region, judged
from profiletool.image.find.masks import overlap
from profiletool.image.find.mosaic import cut, mosaic_of, polished
from profiletool.image.find.quality import Quality, quality_of
from profiletool.image.find.view import view_of

SHAPE = (240, 320)
Y, X = np.mgrid[: SHAPE[0], : SHAPE[1]]


def disc(x: float = 150, y: float = 110, radius: float = 60) -> np.ndarray:
    return np.hypot(X - x, Y - y) <= radius


def picture(ground: np.ndarray | tuple[int, ...] = (200, 198, 190)) -> np.ndarray:
    """A brown disc on a ground, lightly blurred, with noise."""
    cover = cv2.GaussianBlur(disc().astype(float), (0, 0), 0.7)[..., None]
    rgb = np.asarray(ground) * (1 - cover) + np.array([150, 60, 40]) * cover
    noise = np.random.default_rng(1).normal(0, 3, rgb.shape)
    return np.clip(np.round(rgb + noise), 0, 255).astype(np.uint8)


def checks() -> np.ndarray:
    return np.where((X // 20 + Y // 20) % 2 == 0, 90, 200)[..., None] * np.array([0.5, 0.9, 0.6])


def quality(rgb: np.ndarray, mask: np.ndarray) -> Quality:
    view = view_of(rgb, np.zeros(SHAPE, bool))
    return quality_of(view, mask)


@pytest.mark.parametrize("ground", [np.array((200, 198, 190)), checks()])
def test_the_true_mask_is_believed(ground: np.ndarray) -> None:
    found = quality(picture(ground), disc())
    assert found.confidence > 0.85
    assert found.clear > 0.85
    assert found.edge > 0.99
    assert found.peak > 0.95
    assert found.steady > 0.97
    assert found.separation > 0.9
    assert found.ground > 0.9


WRONG = {
    "beside": disc(x=175),
    "too large": disc(radius=72),
    "too small": disc(radius=48),
    "elsewhere": disc(260, 60, 40),
    "with a shadow's place": disc() | disc(170, 130, 60),
    "half": disc() & (X < 150),
    "with a leak": disc() | ((np.abs(Y - 110) < 25) & (X > 150) & (X < 300)),
}


@pytest.mark.parametrize("name", WRONG)
@pytest.mark.parametrize("ground", [np.array((200, 198, 190)), checks()])
def test_wrong_masks_are_not(ground: np.ndarray, name: str) -> None:
    rgb = picture(ground)
    found, right = quality(rgb, WRONG[name]), quality(rgb, disc())
    assert found.clear < 0.8 * right.clear
    assert found.merit < right.merit


@pytest.mark.parametrize("name", WRONG)
@pytest.mark.parametrize("ground", [np.array((200, 198, 190)), checks()])
def test_beside_the_true_one_wrong_masks_are_not_believed(ground: np.ndarray, name: str) -> None:
    both = [Region(disc(), "right"), Region(WRONG[name], "wrong")]
    right, wrong = judged(view_of(picture(ground), np.zeros(SHAPE, bool)), both, both)
    assert (right.method, wrong.method) == ("right", "wrong")
    assert right.confidence > 0.7
    assert wrong.confidence < min(BELIEVED, 0.6 * right.confidence)


def test_nothing_speaks_for_a_mask_on_a_blank_picture() -> None:
    found = quality(np.full((*SHAPE, 3), 128, np.uint8), disc())
    assert (found.edge, found.separation) == pytest.approx((0.0, 0.0), abs=1e-6)
    assert found.clear < 1e-6
    assert found.confidence < 0.05


def test_shape_size_and_border_are_those_of_geometry() -> None:
    whole = quality(picture(), disc())
    assert whole.size == pytest.approx(np.pi * 60**2 / (240 * 320), rel=0.01)
    assert whole.border == 0.0
    square = (X < 100) & (Y < 100)
    assert quality(picture(), square).border == pytest.approx(0.5, abs=0.03)
    assert quality(picture(), square).four_cornered == 1.0
    assert whole.four_cornered == 0.0


@pytest.mark.parametrize("name", ["share", "drawn_by"])
def test_what_other_candidates_say_counts(name: str) -> None:
    found = quality(picture(checks()), disc())
    chances = [replace(found, **{name: value}).confidence for value in (0.1, 0.5, 1.0)]
    assert chances == sorted(chances)
    assert chances[2] > chances[0] + 0.1


def test_a_learned_opinion_that_differs_is_doubt() -> None:
    found = quality(picture(checks()), disc())
    assert replace(found, learned=0.9).confidence == found.confidence
    assert replace(found, learned=0.425).confidence == pytest.approx(0.5 * found.confidence)


def test_colours_round_it_that_the_frame_does_not_show() -> None:
    """A bright part is cut out of the whole: what lies round it is strange to the frame."""
    rgb = picture()
    rgb[disc(150, 110, 25)] = (250, 220, 60)
    assert quality(rgb, disc(150, 110, 25)).ground < 0.3
    assert quality(rgb, disc()).ground > 0.9


# --- rims -----------------------------------------------------------------------------------


def test_a_rim_looks_outwards() -> None:
    field = np.hypot(X - 150, Y - 110).astype(np.float32)[..., None]
    rim = rim_of(field, disc(), 6)
    outward = (rim.points - (150, 110)) / 60.0
    assert (rim.normals * outward).sum(axis=1).min() > 0.95
    along = rim.colours[..., 0] - rim.colours[:, 6:7, 0]
    np.testing.assert_allclose(along, np.broadcast_to(np.arange(-6, 7), along.shape), atol=0.4)
    np.testing.assert_allclose(steps(rim.colours)[..., 0], 3.0, atol=0.2)


def test_a_tiny_or_cut_off_region_has_a_rim_too() -> None:
    for mask in (disc(150, 110, 1), disc(150, 110, 0.5), (X < 3) & (Y < 3), Y == 5):
        rim = rim_of(np.zeros((*SHAPE, 3), np.float32), mask, 5)
        assert np.isfinite(rim.normals).all()
        quality(picture(), mask)


@pytest.mark.parametrize("ground", [np.array((200, 198, 190)), checks()])
@pytest.mark.parametrize("rough", [disc(radius=57), disc(radius=63), disc(152, 108)])
def test_an_outline_is_drawn_anew_along_the_edge(ground: np.ndarray, rough: np.ndarray) -> None:
    found = polished(view_of(picture(ground), np.zeros(SHAPE, bool)).lab, rough)
    assert overlap(rough, disc()) < 0.96
    assert overlap(found, disc()) > 0.975


def test_colours_are_parted_from_a_rough_guess() -> None:
    mosaic = mosaic_of(view_of(picture(checks()), np.zeros(SHAPE, bool)).lab)
    frame = (X < 8) | (X > 311) | (Y < 8) | (Y > 231)
    assert overlap(cut(mosaic, disc(165, 120, 45), frame), disc()) > 0.9


# --- sets of colours ------------------------------------------------------------------------


def test_histograms_are_alike_or_not() -> None:
    lab = np.zeros((4, 4, 3), np.float32)
    lab[:2] = (30, 20, 20)
    lab[2:] = (80, -40, 10)
    cell = cells(lab)
    upper, lower = (np.indices((4, 4))[0] < 2), (np.indices((4, 4))[0] >= 2)
    one, other = histogram(cell, upper), histogram(cell, lower)
    assert one.sum() == pytest.approx(1.0)
    assert likeness(one, one) == pytest.approx(1.0)
    assert likeness(one, other) == 0.0


def test_extreme_colours_have_a_cell() -> None:
    extreme = np.array([[[0, -200, 200], [100, 200, -200], [120, 0, 0]]], np.float32)
    cell = cells(extreme)
    assert cell.min() >= 0
    assert cell.max() < 16**3
