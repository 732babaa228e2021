"""Markers that are not read, or not to be trusted, and why."""

from __future__ import annotations

from collections.abc import Callable

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from profiletool.errors import NoScale
from profiletool.image.scale import marker_scale, markers_for
from profiletool.records.picture import Picture
from profiletool.records.request import ScaleRequest

Pixels = NDArray[np.uint8]
AT, SIDE = 100, 120  # px


def scene(dictionary: int = cv2.aruco.DICT_4X4_50, number: int = 7) -> Pixels:
    grey = np.full((320, 420), 225, np.uint8)
    grey[AT - 25 : AT + SIDE + 25, AT - 25 : AT + SIDE + 25] = 255
    made = cv2.aruco.generateImageMarker(
        cv2.aruco.getPredefinedDictionary(dictionary), number, SIDE
    )
    grey[AT : AT + SIDE, AT : AT + SIDE] = made
    return grey


def picture(grey: Pixels) -> Picture:
    return Picture(np.repeat(grey[:, :, None], 3, axis=2), None, None, "array")


def negative(grey: Pixels) -> Pixels:
    return np.asarray(255 - grey, np.uint8)


def glaring(grey: Pixels) -> Pixels:
    return np.asarray(cv2.circle(grey, (AT + 45, AT + 45), 26, 255, -1), np.uint8)


@pytest.mark.parametrize(
    ("grey", "says"),
    [
        (scene()[:, ::-1], "one is seen mirrored"),
        (negative(scene()), "one is seen white on black"),
        (scene(cv2.aruco.DICT_6X6_250), r"another dictionary is seen \(DICT_6X6_1000, number 7\)"),
        (scene(cv2.aruco.DICT_5X5_50), r"another dictionary is seen \(DICT_5X5_1000, number 7\)"),
        (scene(cv2.aruco.DICT_APRILTAG_36h11), r"another dictionary is seen \(DICT_APRILTAG"),
        (glaring(scene()), "its cells cannot be read"),
        (np.full((300, 300), 230, np.uint8), "no ArUco DICT_4X4_50 marker was read; show"),
    ],
)
def test_why_none_was_read(grey: Pixels, says: str) -> None:
    with pytest.raises(NoScale, match=says):
        markers_for(picture(grey), ScaleRequest(marker_mm=30.0))
    assert markers_for(picture(grey), ScaleRequest(marker_mm=30.0, height_mm=90.0)) == []
    assert markers_for(picture(grey), ScaleRequest()) == []


def disc_beside(shade: int, x: int) -> Callable[[Pixels], Pixels]:
    def drawn(grey: Pixels) -> Pixels:
        return np.asarray(cv2.circle(grey, (x, AT + 60), 70, shade, -1), np.uint8)

    return drawn


@pytest.mark.parametrize("turn", [0, 1, 2, 3])
@pytest.mark.parametrize("x", [AT - 66, AT - 71])
def test_what_touches_or_covers_the_edge(turn: int, x: int) -> None:
    touched = np.ascontiguousarray(np.rot90(disc_beside(40, x)(scene()), turn))
    with pytest.raises(NoScale, match=r"touches or covers the marker's edge|was read"):
        marker_scale(picture(touched), 30.0)


@pytest.mark.parametrize("shade", [40, 120, 255])
def test_a_scale_beside_something_is_right_or_refused(shade: int) -> None:
    for x in range(AT - 100, AT - 40, 4):
        try:
            found = marker_scale(picture(disc_beside(shade, x)(scene())), 30.0).mm_per_px
        except NoScale:
            continue
        assert found == pytest.approx(30.0 / SIDE, rel=0.01), x


def test_an_object_farther_off_is_no_fault() -> None:
    clear = disc_beside(40, AT - 90)(scene())
    assert marker_scale(picture(clear), 30.0).mm_per_px == pytest.approx(30.0 / SIDE, rel=5e-3)
    beside = np.hstack([disc_beside(40, AT - 66)(scene()), scene()])  # the clear one of two counts
    assert marker_scale(picture(beside), 30.0).mm_per_px == pytest.approx(30.0 / SIDE, rel=5e-3)
