"""The object among the regions of a mask, drawn by hand."""

from __future__ import annotations

import numpy as np
import pytest

from profiletool.errors import NoObject
from profiletool.image.find.region import SeveralAlike, choose_object

SHAPE = (60, 80)


def mask(*boxes: tuple[int, int, int, int]) -> np.ndarray:
    """Boxes (x, y, width, height)."""
    drawn = np.zeros(SHAPE, bool)
    for x, y, width, height in boxes:
        drawn[y : y + height, x : x + width] = True
    return drawn


BIG, SMALL, SPECK = (10, 10, 24, 30), (50, 20, 12, 12), (70, 50, 2, 2)


def test_the_largest_is_taken_and_its_holes_are_filled() -> None:
    drawn = mask(BIG, SMALL, SPECK)
    drawn[20:24, 15:20] = False
    np.testing.assert_array_equal(choose_object(drawn), mask(BIG))


def test_two_alike_are_told_apart_by_nobody_but_a_point() -> None:
    two = (10, 10, 20, 30), (45, 10, 20, 30)
    with pytest.raises(SeveralAlike) as caught:
        choose_object(mask(*two))
    assert len(caught.value.regions) == 2
    for region, box in zip(caught.value.regions, two, strict=True):
        np.testing.assert_array_equal(region, mask(box))
    np.testing.assert_array_equal(choose_object(mask(*two), (50.0, 20.0)), mask(two[1]))


def test_a_point_beside_every_region_finds_nothing() -> None:
    with pytest.raises(NoObject, match="give a point well inside it"):
        choose_object(mask(BIG), (70.0, 5.0))


def test_the_edge_of_a_table_is_ground() -> None:
    table = (0, 50, 80, 10)
    np.testing.assert_array_equal(choose_object(mask(SMALL, table)), mask(SMALL))
    with pytest.raises(NoObject, match="no object found"):
        choose_object(mask(table))


def test_what_touches_no_edge_goes_before_what_does() -> None:
    cut_off = (0, 5, 20, 40)
    np.testing.assert_array_equal(choose_object(mask(cut_off, SMALL)), mask(SMALL))
    # But for a mere speck beside it.
    np.testing.assert_array_equal(choose_object(mask(cut_off, (60, 20, 5, 5))), mask(cut_off))


def test_specks_and_whole_frames_are_no_objects() -> None:
    with pytest.raises(NoObject, match="no object found"):
        choose_object(mask(SPECK))
    with pytest.raises(NoObject, match="covers the whole picture"):
        choose_object(np.ones(SHAPE, bool))
