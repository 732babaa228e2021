"""Millimetres per pixel: from what the user knows, a marker, or the file; never guessed."""

from __future__ import annotations

import math

import cv2
import numpy as np

from profiletool.errors import NoScale, UsageError
from profiletool.image.find.masks import thickness
from profiletool.image.marker import find_markers
from profiletool.image.marker_faults import is_clear, why_unread
from profiletool.image.sheet.parallax import (
    LARGEST_SHARE,
    PRINT_SHARE,
    USUAL_FOCAL,
    Camera,
    axis_height,
    remaining,
    shrinkage,
)
from profiletool.records.making import check_scale
from profiletool.records.picture import Picture, Scale, Silhouette
from profiletool.records.request import ScaleRequest
from profiletool.records.units import FloatArray

_AGREEMENT = 0.02  # markers, and the sides of one, differ by less or are not trusted
_SQUARENESS = 0.1
_CORNER_PX = 0.2  # scatter of a marker's corner
_SCANNER_SHARE = 0.005
_FAR_OFF = 4.0  # factor that unknown lenses and cropped pictures may make of a distance


def scale_of(
    picture: Picture, silhouette: Silhouette, request: ScaleRequest, flat: bool = False
) -> Scale:
    """Settle the scale of a picture.

    Parameters
    ----------
    picture : Picture
        Searched for markers, or asked for its stored resolution and focal length.
    silhouette : Silhouette
        Its contour's extent is the object's height and width.
    request : ScaleRequest
        What the user gave.
    flat : bool
        Whether the object is flat and lies in a marker's plane.

    Returns
    -------
    Scale
        Its ``error_share`` holds the contour's scatter for a length that was given, the
        marker's corners and its height's parallax for a marker, 0.5 % for a scanner; None for a
        scale that was given, which nobody here can judge. A marker's scale is one at the height
        of the object's middle only where the camera's distance was given.

    Raises
    ------
    UsageError
        A length is not a positive number, or no camera's distance.
    NoScale
        Nothing is given or stored, or the marker is not found or not trusted.
    """
    check_scale(request)
    width_px, height_px = (float(side) for side in np.ptp(silhouette.contour_px, axis=0))
    noise_px = 2.0 * math.sqrt(2.0) * silhouette.noise_px  # of an extent, two deviations
    if request.height_mm is not None:
        return Scale(request.height_mm / height_px, "height", noise_px / height_px)
    if request.width_mm is not None:
        return Scale(request.width_mm / width_px, "width", noise_px / width_px)
    if request.mm_per_px is not None:
        return Scale(request.mm_per_px, "mm-per-px")
    if request.marker_mm is not None:
        if flat:
            return marker_scale(picture, request.marker_mm)
        thin_px = thickness(silhouette.contour_px)
        return _marker_scale(picture, thin_px, request.marker_mm, request.camera_distance_mm)
    if picture.mm_per_px is not None:
        return Scale(picture.mm_per_px, "resolution", _SCANNER_SHARE)
    raise NoScale(
        "nothing says how large the object is; give `height_mm`, `width_mm`, `mm_per_px` or "
        "`marker_mm`, or photograph it on a printed profiletool sheet"
    )


def marker_scale(picture: Picture, marker_mm: float) -> Scale:
    """Give the scale in a marker's own plane, with what its print and corners may do.

    Raises
    ------
    NoScale
        It is not found or not trusted.
    """
    side_px, scatter = _marker_side_px(picture)
    share = math.hypot(scatter, 2.0 * _CORNER_PX / side_px, 2.0 * PRINT_SHARE)
    return Scale(marker_mm / side_px, "marker", share)


def _marker_scale(
    picture: Picture, thin_px: float, marker_mm: float, distance_mm: float | None
) -> Scale:
    """Give a marker's scale, at the height of a lying body's axis where the distance is known.

    Without it the object may lie level with the marker or on its plane: its parallax is an error.
    """
    flat = marker_scale(picture, marker_mm)
    k, corners = flat.mm_per_px, flat.error_share or 0.0
    focal_px = picture.focal_px or USUAL_FOCAL * max(picture.rgb.shape[:2])
    distance = distance_mm or focal_px * k
    t = axis_height(0.5 * thin_px * k, distance)
    if t > LARGEST_SHARE * distance:
        raise NoScale(
            f"a camera {distance:.0f} mm away is too near for an object so thick; photograph it "
            "from farther off, or give `height_mm` or `width_mm`"
        )
    if not focal_px * k / _FAR_OFF < distance < focal_px * k * _FAR_OFF:
        raise UsageError(
            f"`camera_distance_mm` is {distance:g} mm, but the marker shows a camera some "
            f"{focal_px * k:.0f} mm away; give millimetres from the lens to the marker"
        )
    left = remaining(t, Camera((0.0, 0.0), distance), 0.0, section=False)
    if distance_mm is None:
        parallax = 1.0 / shrinkage(t, distance) - 1.0 + left.shape
        return Scale(k, "marker", math.hypot(corners, parallax))
    share = math.hypot(corners, left.distance, left.shape)
    near = shrinkage(t, distance)
    return Scale(k * near, "marker", share, 2.0 * t, 1.0 / near - 1.0)


def markers_for(picture: Picture, asked: ScaleRequest) -> list[FloatArray]:
    """Find the markers of a picture whose scale may be a marker's, (4, 2) px each.

    Raises
    ------
    NoScale
        The scale hangs on a marker, and none is read or none is clear.
    """
    if asked.marker_mm is None:
        return []
    if asked.height_mm is None and asked.width_mm is None and asked.mm_per_px is None:
        _clear_markers(picture)
    return find_markers(picture)


def _clear_markers(picture: Picture) -> list[FloatArray]:
    markers = find_markers(picture)
    if not markers:
        why = why_unread(picture)
        raise NoScale(
            f"no ArUco DICT_4X4_50 marker was read{f': {why}' if why else ''}; show it whole, "
            "sharp and with its white margin, or give `height_mm` or `width_mm`"
        )
    grey = np.asarray(cv2.cvtColor(picture.rgb, cv2.COLOR_RGB2GRAY), np.uint8)
    clear = [quad for quad in markers if is_clear(grey, quad)]
    if not clear:
        raise NoScale(
            "something touches or covers the marker's edge, which makes its size wrong; leave its "
            "white margin free, or give `height_mm` or `width_mm`"
        )
    return clear


def _marker_side_px(picture: Picture) -> tuple[float, float]:
    """Mean side of the markers, px, and by how much of it the sides scatter."""
    markers = _clear_markers(picture)
    sides = np.array([np.hypot(*(np.roll(quad, -1, axis=0) - quad).T) for quad in markers])
    if (np.ptp(sides, axis=1) > _SQUARENESS * sides.mean(axis=1)).any():
        raise NoScale(
            "the marker is seen at a slant; photograph it from straight above, "
            "or give `height_mm` or `width_mm`"
        )
    means = sides.mean(axis=1)
    if np.ptp(means) > _AGREEMENT * means.mean():
        raise NoScale(
            f"the {len(means)} markers differ in size by more than 2 %; lay them level with the "
            "object and photograph from straight above, or give `height_mm` or `width_mm`"
        )
    return float(means.mean()), float(sides.std() / sides.mean())
