"""Pictures that show their object outright: masks, drawings, cut-outs with a shadow."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from profiletool.errors import UsageError
from profiletool.image.find.hint import Hint
from profiletool.image.find.masks import overlap
from profiletool.image.find.silhouette import find_silhouette
from profiletool.records.picture import Picture
from tests.image.find.discs import SHAPE, disc, picture_of

EGG = np.zeros(SHAPE, np.uint8)
cv2.ellipse(EGG, (160, 120), (50, 80), 0, 0, 360, 1, -1)


def two_tone(mask: np.ndarray, object_: int, ground: int) -> Picture:
    return picture_of((mask * object_ + (1.0 - mask) * ground)[..., None] * np.ones(3))


@pytest.mark.parametrize(("object_", "ground"), [(255, 0), (0, 255), (90, 200)])
def test_a_mask_is_read_as_it_is(object_: int, ground: int) -> None:
    found = find_silhouette(two_tone(EGG.astype(float), object_, ground))
    assert found.method == "two tones"
    assert overlap(found.mask, EGG > 0) > 0.995


def test_a_spur_of_a_mask_is_part_of_it() -> None:
    handle = EGG.copy()
    handle[20:60, 158:162] = 1
    found = find_silhouette(two_tone(handle.astype(float), 255, 0))
    assert overlap(found.mask, handle > 0) > 0.995


def test_a_mask_trimmed_to_its_object_runs_into_nothing() -> None:
    rows, columns = np.flatnonzero(EGG.any(axis=1)), np.flatnonzero(EGG.any(axis=0))
    cut = EGG[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1].astype(float)
    shown = (255 * cut)[..., None].astype(np.uint8) * np.ones(3, np.uint8)
    assert find_silhouette(Picture(shown, None, None, "PNG")).touches == frozenset()


def test_a_line_drawing_is_its_outline() -> None:
    drawn = np.full(SHAPE, 255, np.uint8)
    cv2.ellipse(drawn, (160, 120), (50, 80), 0, 0, 360, 0, 2)
    found = find_silhouette(picture_of(drawn[..., None] * np.ones(3)))
    assert np.ptp(found.contour_px, axis=0) == pytest.approx((102, 162), abs=2)


def cut_out(alpha: np.ndarray) -> Picture:
    rgb = np.full((*SHAPE, 3), (150, 60, 40), np.uint8)
    return Picture(rgb, np.round(255 * alpha).astype(np.uint8), None, "PNG")


def test_a_cut_out_leaves_its_shadow_and_is_doubted() -> None:
    shadow = np.zeros(SHAPE)
    cv2.ellipse(shadow, (165, 205), (55, 12), 0, 0, 360, 0.65, -1)
    found = find_silhouette(cut_out(np.maximum(EGG, cv2.GaussianBlur(shadow, (0, 0), 3))))
    assert overlap(found.mask, EGG > 0) > 0.98
    assert found.confidence < 0.8
    assert find_silhouette(cut_out(EGG.astype(float))).confidence == 1.0


def test_a_window_with_its_shadow_is_looked_into() -> None:
    window = np.zeros(SHAPE)
    window[20:220, 40:280] = 1.0
    glow = cv2.GaussianBlur(window, (0, 0), 8)
    rgb = np.where(EGG[..., None] > 0, (150, 60, 40), (236, 235, 230)).astype(np.uint8)
    alpha = np.round(255 * np.maximum(window, 0.45 * glow)).astype(np.uint8)
    found = find_silhouette(Picture(rgb, alpha, None, "PNG"))
    assert overlap(found.mask, EGG > 0) > 0.98


def test_a_candidate_is_taken_by_its_number() -> None:
    soft = disc(160, 120, 50)[..., None]
    rng = np.random.default_rng(0)
    ground = np.kron(rng.integers(60, 200, (12, 16, 3)), np.ones((20, 20, 1)))
    picture = picture_of(ground * (1 - soft) + np.array([200.0, 40.0, 40.0]) * soft)
    assert find_silhouette(picture, hint=Hint(candidate=1)).mask.any()
    with pytest.raises(UsageError, match="`candidate` 9: only"):
        find_silhouette(picture, hint=Hint(candidate=9))
