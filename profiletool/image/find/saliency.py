"""Maps of what does not belong to the ground, for grounds that are anything but plain."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from profiletool.image.find.ground import FloatImage, frame_of

_SHADES = 10  # colours that a picture is reduced to
_WINDOW_SHARE = 0.045  # half the width of a texture's window, of the shorter side
_PATTERNS = 8  # of a ground, along the frame
_FRAME_SHARE = 0.06


def barrier(lab: FloatImage) -> FloatImage:
    """How high the wall of colour round every pixel is that no path from the frame avoids.

    Along each axis of Lab it is the height of a pixel above the level at which a flood from the
    frame reaches it, or the depth below.

    Returns
    -------
    (H, W) float32
        In Lab units.
    """
    calm = cv2.medianBlur(np.clip(lab + np.float32(128), 0, 255).astype(np.uint8), 5)
    walls = [
        np.maximum(plane - _flooded(plane), (255 - plane) - _flooded(255 - plane))
        for plane in np.moveaxis(calm, 2, 0)
    ]
    return np.asarray(np.linalg.norm(np.stack(walls).astype(np.float32), axis=0), np.float32)


def _flooded(plane: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Raise a flood from the frame as far as it gets without rising above any pixel."""
    plane = np.ascontiguousarray(plane)
    flood = np.full_like(plane, plane.min())
    for side in (np.s_[0], np.s_[-1], np.s_[:, 0], np.s_[:, -1]):
        flood[side] = plane[side]
    square = np.ones((3, 3), np.uint8)
    for _ in range(plane.size):
        risen = np.minimum(cv2.dilate(flood, square), plane)
        if np.array_equal(risen, flood):
            break
        flood = risen
    return flood


def strangeness(lab: FloatImage) -> FloatImage:
    """How little the mixture of colours round a pixel is like any along the frame.

    Returns
    -------
    (H, W) float32
        0 for a pattern of the frame's, sqrt(2) for one that shares no colour with any.
    """
    shade = _clustered(lab.reshape(-1, 3), _SHADES)[0].reshape(lab.shape[:2])
    half = max(2, round(_WINDOW_SHARE * min(lab.shape[:2])))
    wide = (2 * half + 1, 2 * half + 1)
    mixture = np.sqrt(
        np.dstack([cv2.blur((shade == k).astype(np.float32), wide) for k in range(_SHADES)])
    )
    patterns = _clustered(mixture[frame_of(lab.shape[:2], _FRAME_SHARE)], _PATTERNS)[1]
    off = [np.linalg.norm(mixture - pattern, axis=2) for pattern in patterns]
    return np.asarray(np.min(off, axis=0), np.float32)


def _clustered(points: FloatImage, count: int) -> tuple[NDArray[np.int32], FloatImage]:
    """Label (N, C) points by k-means, the same for the same points; give the centres too."""
    cv2.setRNGSeed(0)
    stop = cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_MAX_ITER, 12, 0.05
    points = np.ascontiguousarray(points)
    unused = np.zeros(len(points), np.int32)  # for labels to start from
    _, labels, centres = cv2.kmeans(points, count, unused, stop, 1, cv2.KMEANS_PP_CENTERS)
    return np.asarray(labels.ravel(), np.int32), np.asarray(centres, np.float32)
