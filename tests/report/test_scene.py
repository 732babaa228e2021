"""The picture behind the lines."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from profiletool.profile.upright import turned
from profiletool.records.picture import Picture
from profiletool.report.scene import backdrop_of


@pytest.mark.parametrize("turn", [90.0, 30.0, -140.0])
def test_the_overlay_turns_its_picture_with_the_outline(turn: float) -> None:
    """A red dot on grey, found again where the turn brings it."""
    rgb = np.full((200, 320, 3), 128, np.uint8)
    dot = np.array([250.0, 40.0])
    cv2.circle(rgb, (250, 40), 4, (255, 0, 0), -1)
    middle = np.array([159.5, 99.5])
    origin = np.array([150.0, 20.0])
    back = backdrop_of(Picture(rgb, None, None, "PNG"), 0.5, (150.0, 20.0), turn)
    red = (back.rgb[..., 0] > 200) & (back.rgb[..., 1] < 80)
    rows, columns = np.nonzero(red)
    left, right, bottom, top = back.extent
    height, width = red.shape
    x = left + (columns.mean() + 0.5) * (right - left) / width
    y = top - (rows.mean() + 0.5) * (top - bottom) / height
    there = turned((dot - middle) * [1.0, -1.0], turn) * [1.0, -1.0] + middle
    np.testing.assert_allclose([x, y], (there - origin) * [0.5, -0.5], atol=0.3)
