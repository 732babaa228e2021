"""Printed ArUco markers: found once, used for the scale and kept out of the silhouette."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from profiletool.records.picture import Picture
from profiletool.records.units import FloatArray

DICTIONARY = int(cv2.aruco.DICT_4X4_50)
# The white margin printed round a marker is about two of its six cells wide.
_QUIET_ZONE = 2.5 / 6.0


def find_markers(picture: Picture) -> list[FloatArray]:
    """Corners of every DICT_4X4_50 marker in a picture.

    Returns
    -------
    list of (4, 2) float64
        Corners in the picture frame, sub-pixel, in the marker's own order.
    """
    settings = cv2.aruco.DetectorParameters()
    settings.cornerRefinementMethod = cv2.aruco.CORNER_REFINE_SUBPIX
    dictionary = cv2.aruco.getPredefinedDictionary(DICTIONARY)
    grey = cv2.cvtColor(picture.rgb, cv2.COLOR_RGB2GRAY)
    corners = cv2.aruco.ArucoDetector(dictionary, settings).detectMarkers(grey)[0]
    return [np.asarray(quad, np.float64).reshape(4, 2) for quad in corners]


def with_quiet_zone(corners: FloatArray) -> FloatArray:
    """Move a marker's (4, 2) corners out to take in the white paper round it."""
    middle = corners.mean(axis=0)
    return np.asarray(middle + (corners - middle) * (1.0 + 2.0 * _QUIET_ZONE))


def paint_mask(
    polygons: list[FloatArray], shape: tuple[int, int], reduction: float
) -> NDArray[np.bool_]:
    """Pixels of a picture reduced by a factor that lie in polygons of the full one."""
    mask = np.zeros(shape, np.uint8)
    for polygon in polygons:
        corners = (np.asarray(polygon) + 0.5) / reduction - 0.5
        cv2.fillPoly(mask, [np.round(corners).astype(np.int32)], 1)
    return np.asarray(mask > 0)
