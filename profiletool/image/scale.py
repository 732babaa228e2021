"""Millimetres per pixel: from what the user knows, a marker, or the file; never guessed."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from profiletool.errors import NoScale, UsageError
from profiletool.image.marker import find_markers
from profiletool.records import Picture, Scale, Silhouette

_AGREEMENT = 0.02  # markers, and the sides of one, differ by less or are not trusted
_SQUARENESS = 0.1


@dataclass(frozen=True)
class ScaleRequest:
    """What the user said about the scale; the first given wins, in this order.

    Attributes
    ----------
    height_mm, width_mm : float or None
        The object's full extent.
    mm_per_px : float or None
        The scale itself.
    marker_mm : float or None
        Side of the ArUco DICT_4X4_50 marker in the picture.
    """

    height_mm: float | None = None
    width_mm: float | None = None
    mm_per_px: float | None = None
    marker_mm: float | None = None


def scale_of(picture: Picture, silhouette: Silhouette, request: ScaleRequest) -> Scale:
    """Settle the scale of a picture.

    Parameters
    ----------
    picture : Picture
        Searched for markers, or asked for its stored resolution.
    silhouette : Silhouette
        Its contour's extent is the object's height and width.
    request : ScaleRequest
        What the user gave.

    Raises
    ------
    UsageError
        A length is not a positive number.
    NoScale
        Nothing is given or stored, or the marker is not found or not trusted.
    """
    _check(request)
    width_px, height_px = np.ptp(silhouette.contour_px, axis=0)
    if request.height_mm is not None:
        return Scale(request.height_mm / float(height_px), "height")
    if request.width_mm is not None:
        return Scale(request.width_mm / float(width_px), "width")
    if request.mm_per_px is not None:
        return Scale(request.mm_per_px, "mm-per-px")
    if request.marker_mm is not None:
        return Scale(request.marker_mm / _marker_side_px(picture), "marker")
    if picture.mm_per_px is not None:
        return Scale(picture.mm_per_px, "resolution")
    raise NoScale(
        "nothing says how large the object is; give --height, --width, --mm-per-px or --marker-mm"
    )


def _check(request: ScaleRequest) -> None:
    for name in ("height_mm", "width_mm", "mm_per_px", "marker_mm"):
        value = getattr(request, name)
        if value is not None and not (math.isfinite(value) and value > 0.0):
            option = name.replace("_", "-").removesuffix("-mm") if name != "marker_mm" else ""
            option = f"--{option or 'marker-mm'}"
            raise UsageError(f"{option} is {value:g}; give a positive number of millimetres")


def _marker_side_px(picture: Picture) -> float:
    markers = find_markers(picture)
    if not markers:
        raise NoScale(
            "no ArUco DICT_4X4_50 marker found; show it whole, sharp and with its white margin, "
            "or give --height or --width"
        )
    sides = np.array([np.hypot(*(np.roll(quad, -1, axis=0) - quad).T) for quad in markers])
    if (np.ptp(sides, axis=1) > _SQUARENESS * sides.mean(axis=1)).any():
        raise NoScale(
            "the marker is seen at a slant; photograph it from straight above, "
            "or give --height or --width"
        )
    means = sides.mean(axis=1)
    if np.ptp(means) > _AGREEMENT * means.mean():
        raise NoScale(
            f"the {len(means)} markers differ in size by more than 2 %; lay them level with the "
            "object and photograph from straight above, or give --height or --width"
        )
    return float(means.mean())
