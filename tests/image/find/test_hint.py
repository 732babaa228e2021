"""Hints: points, boxes and masks, given and read from files."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from profiletool.errors import NoObject, UnreadableInput, Unsure, UsageError
from profiletool.image.find.candidates import BELIEVED
from profiletool.image.find.hint import Hint
from profiletool.image.find.masks import overlap
from profiletool.image.find.silhouette import find_silhouette
from profiletool.image.load import load_mask, load_picture
from tests.image.find.discs import SHAPE, X, Y, disc, laid, picture_of

TWO = laid(disc(90, 110, 45) + disc(230, 110, 40))


LEFT, RIGHT = disc(90, 110, 45) >= 0.5, disc(230, 110, 40) >= 0.5


@pytest.mark.parametrize(
    ("hint", "truth"),
    [
        (Hint(point=(90, 110)), LEFT),
        (Hint(point=(230, 110)), RIGHT),
        (Hint(box=(40, 60, 100, 100)), LEFT),
        (Hint(box=(180, 60, 100, 100)), RIGHT),
        (Hint(box=(180, 60, 100, 100), point=(230, 110)), RIGHT),
    ],
)
def test_a_hint_settles_which(hint: Hint, truth: np.ndarray) -> None:
    found = find_silhouette(TWO, hint=hint)
    assert overlap(found.mask, truth) > 0.98
    middle = np.argwhere(truth).mean(axis=0)[::-1]
    np.testing.assert_allclose(found.contour_px.mean(axis=0), middle, atol=1.0)
    assert found.touches == frozenset()


def test_a_hint_settles_which_in_a_matte_too() -> None:
    alpha = np.round(255 * (disc(90, 110, 45) + disc(230, 110, 40))).astype(np.uint8)
    picture = replace(TWO, alpha=alpha)
    with pytest.raises(NoObject, match="alike"):
        find_silhouette(picture)
    for hint in (Hint(point=(230, 110)), Hint(box=(180, 60, 100, 100))):
        assert overlap(find_silhouette(picture, hint=hint).mask, RIGHT) > 0.999


def test_outside_a_box_all_is_ground() -> None:
    found = find_silhouette(laid(disc(150, 110, 60)), hint=Hint(box=(80, 40, 100, 140)))
    rows, columns = np.nonzero(found.mask)
    assert columns.max() == 179
    assert rows.min() >= 49


def test_a_box_on_the_frame_reports_what_it_touches() -> None:
    found = find_silhouette(laid(disc(20, 110, 60)), hint=Hint(box=(0, 40, 120, 140)))
    assert found.touches == {"left"}


def test_a_mask_is_taken_as_it_is() -> None:
    drawn = (X >= 100) & (X < 140) & (Y >= 50) & (Y < 200)
    specks = drawn | ((X > 300) & (Y < 5))
    found = find_silhouette(TWO, hint=Hint(mask=specks))
    assert np.array_equal(found.mask, drawn)
    assert found.method == "mask"
    assert found.confidence < BELIEVED
    true = find_silhouette(TWO, hint=Hint(mask=LEFT))
    assert overlap(true.mask, LEFT) > 0.999
    assert true.confidence > 0.8


def test_a_mask_settles_it_on_a_blank_picture() -> None:
    blank = picture_of(np.full((*SHAPE, 3), 255.0))
    assert find_silhouette(blank, hint=Hint(mask=LEFT)).confidence < 0.1


@pytest.mark.parametrize(
    ("hint", "words"),
    [
        (Hint(box=(300, 60, 100, 100)), "does not fit"),
        (Hint(box=(-5, 60, 100, 100)), "does not fit"),
        (Hint(box=(50, 60, 5, 100)), "at least"),
        (Hint(box=(float("nan"), 0, 50, 50)), "does not fit"),
        (Hint(point=(320, 10)), "outside the picture"),
        (Hint(point=(10, -1)), "outside the picture"),
        (Hint(point=(float("inf"), 1)), "outside the picture"),
        (Hint(box=(180, 60, 100, 100), point=(90, 110)), "outside `box`"),
        (Hint(mask=np.zeros((10, 10), bool)), "picture's size"),
        (Hint(mask=np.zeros(SHAPE, bool)), "empty"),
    ],
)
def test_hints_that_do_not_fit(hint: Hint, words: str) -> None:
    with pytest.raises(UsageError, match=words) as caught:
        find_silhouette(TWO, hint=hint)
    assert "\n" not in str(caught.value)


@pytest.mark.slow
def test_a_point_beside_the_object_finds_nothing() -> None:
    with pytest.raises(NoObject):
        find_silhouette(laid(disc(230, 110, 40)), hint=Hint(point=(40, 200)))


@pytest.mark.slow
def test_one_of_a_pile_by_a_point_or_a_box(shared: Path) -> None:
    picture = load_picture(shared / "photos" / "pear_in_hand.jpg")
    rows, columns = np.indices(picture.rgb.shape[:2])
    pear = np.hypot((columns - 248) / 46, (rows - 71) / 38) <= 1.0  # the brown one, roughly
    with pytest.raises(Unsure) as unsure:  # pears all round it have its colours
        find_silhouette(picture, hint=Hint(point=(247, 70)))
    assert overlap(unsure.value.candidates[0][0], pear) > 0.85
    found = find_silhouette(picture, hint=Hint(point=(247, 70), candidate=1))
    assert overlap(found.mask, pear) > 0.85
    round_one = np.hypot(columns - 103, rows - 69) <= 42
    found = find_silhouette(picture, hint=Hint(box=(58, 25, 90, 90)))
    assert overlap(found.mask, round_one) > 0.85


def test_masks_are_read_from_shade_or_alpha(tmp_path: Path) -> None:
    shade = np.where(LEFT, 128, 127).astype(np.uint8)
    Image.fromarray(shade).save(tmp_path / "shade.png")
    assert np.array_equal(load_mask(tmp_path / "shade.png", SHAPE), LEFT)
    rgba = np.zeros((*SHAPE, 4), np.uint8)
    rgba[..., 3] = shade
    Image.fromarray(rgba).save(tmp_path / "alpha.png")
    assert np.array_equal(load_mask(tmp_path / "alpha.png", SHAPE), LEFT)
    Image.fromarray(np.where(LEFT, 255, 0).astype(np.uint8)).save(tmp_path / "m.jpg", quality=95)
    assert overlap(load_mask(tmp_path / "m.jpg", SHAPE), LEFT) > 0.99


def test_masks_that_do_not_fit(tmp_path: Path) -> None:
    Image.new("L", (64, 48), 255).save(tmp_path / "small.png")
    with pytest.raises(UsageError, match=r"64 x 48 pixels and the picture 320 x 240; save"):
        load_mask(tmp_path / "small.png", SHAPE)
    Image.new("L", (320, 240), 0).save(tmp_path / "empty.png")
    with pytest.raises(UsageError, match="empty"):
        load_mask(tmp_path / "empty.png", SHAPE)
    (tmp_path / "text.png").write_text("no picture")
    with pytest.raises(UnreadableInput):
        load_mask(tmp_path / "text.png", SHAPE)
