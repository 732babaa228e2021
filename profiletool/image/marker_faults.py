"""Faults of markers: why none was read, and whether one stands clear of everything else."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from profiletool.image.marker import DICTIONARY
from profiletool.records.picture import Picture
from profiletool.records.units import FloatArray

_CELLS = 6  # across a marker of 4 x 4, its black border with it
_INSIDE, _OUTSIDE = 0.5, (0.25, 0.5)  # cells from the edge at which the border is looked at
_ALONG = 48  # places on each side
_UNLIKE = 0.12  # of the places on a side that may be of the wrong shade: paper's folds, dust
_OTHERS = ("5X5_1000", "6X6_1000", "7X7_1000", "ARUCO_ORIGINAL", "APRILTAG_36h11",
           "APRILTAG_25h9", "4X4_1000", "APRILTAG_16h5")  # fmt: skip


def is_clear(grey: NDArray[np.uint8], quad: FloatArray) -> bool:
    """Whether a marker's border is black and the paper round it white, on all four sides.

    What is dark and touches its edge, or bright and lies on it, moves the corners that are found.

    Parameters
    ----------
    grey : (H, W) uint8
    quad : (4, 2)
        Its corners, px.
    """
    square = np.array([[0, 0], [_CELLS, 0], [_CELLS, _CELLS], [0, _CELLS]], np.float32)
    to_picture = cv2.getPerspectiveTransform(square, quad.astype(np.float32))

    def shades(depth: float) -> FloatArray:
        """Shades (4, N) along the four sides at a depth in cells, below 0 outside."""
        t = np.linspace(0.25, _CELLS - 0.25, _ALONG)
        far = np.full(_ALONG, _CELLS - depth)
        near = np.full(_ALONG, depth)
        places = np.array([[t, near], [far, t], [t, far], [near, t]], np.float32)
        px = cv2.perspectiveTransform(places.transpose(0, 2, 1).reshape(1, -1, 2), to_picture)[0]
        found = cv2.remap(
            grey, px[None, :, 0], px[None, :, 1], cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE
        )
        return np.asarray(found, np.float64).reshape(4, _ALONG)

    border, *paper = (shades(depth) for depth in (_INSIDE, *(-out for out in _OUTSIDE)))
    middle = 0.5 * (float(np.median(border)) + float(np.percentile(paper, 75)))
    black = np.mean(border > middle, axis=1)
    white = np.mean(np.array(paper) < middle, axis=2)
    return bool(black.max() <= _UNLIKE and white.max() <= _UNLIKE)


def why_unread(picture: Picture) -> str:
    """Say why no marker of the dictionary was read, as far as the picture tells."""
    grey = np.asarray(cv2.cvtColor(picture.rgb, cv2.COLOR_RGB2GRAY), np.uint8)
    if _numbers(grey[:, ::-1], DICTIONARY):
        return "one is seen mirrored: do not mirror the picture, or print it unmirrored"
    if _numbers(grey, DICTIONARY, inverted=True):
        return "one is seen white on black: print it black on white"
    for name in _OTHERS:
        numbers = _numbers(grey, int(getattr(cv2.aruco, f"DICT_{name}")))
        if numbers:
            return f"one of another dictionary is seen (DICT_{name}, number {numbers[0]})"
    if _squares(grey):
        return "a square like one is seen, but its cells cannot be read: glare, blur or a cover"
    return ""


def _numbers(grey: NDArray[np.uint8], dictionary: int, inverted: bool = False) -> list[int]:
    settings = cv2.aruco.DetectorParameters()
    settings.detectInvertedMarker = inverted
    detector = cv2.aruco.ArucoDetector(cv2.aruco.getPredefinedDictionary(dictionary), settings)
    numbers = detector.detectMarkers(np.ascontiguousarray(grey))[1]
    return [] if numbers is None else [int(n) for n in np.ravel(numbers)]


def _squares(grey: NDArray[np.uint8]) -> bool:
    """Whether anything square with something in it is seen that was not read."""
    detector = cv2.aruco.ArucoDetector(cv2.aruco.getPredefinedDictionary(DICTIONARY))
    rejected = detector.detectMarkers(grey)[2]
    quads = [np.asarray(quad, np.float64).reshape(4, 2) for quad in rejected]
    return any(is_clear(grey, quad) for quad in quads)
