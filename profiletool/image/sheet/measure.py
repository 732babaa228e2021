"""Size of an object on the printed sheet: outline, scale and their error."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from profiletool.errors import NoScale, UsageError
from profiletool.image.find.masks import thickness
from profiletool.image.sheet.parallax import (
    DISTANCE_SHARE,
    LARGEST_SHARE,
    Camera,
    Remaining,
    axis_height,
    remaining,
    shrinkage,
)
from profiletool.image.sheet.rectify import Rectified
from profiletool.image.sheet.section import lying_section
from profiletool.records.picture import Scale, Silhouette

_FAR_OFF = 2.0  # factor by which a measured distance may differ from what the sheet shows
_EDGE_PX = 0.15  # by which blur and light move an edge as a whole, one standard deviation


@dataclass(frozen=True)
class Measured:
    """An object on the sheet.

    Attributes
    ----------
    silhouette : Silhouette
        In the frontal picture. Where the object can be a body of revolution, the contour is that
        of the section through its axis, as the camera sees it there.
    scale : Scale
        At the height of the axis; its ``error_share`` holds all that follows.
    height_mm : float
        The axis's height above the sheet.
    round : bool
        Whether the contour is that of a section.
    measured_share : float
        What the print, the corners, the lens, the contour and the camera's distance may do.
    shape_share : float
        What an object that is no body of revolution, or does not lie on the sheet, may do.
    """

    silhouette: Silhouette
    scale: Scale
    height_mm: float
    round: bool
    measured_share: float
    shape_share: float


def measure(
    made: Rectified,
    silhouette: Silhouette,
    camera_distance_mm: float | None = None,
    revolved: bool = True,
    flat: bool = False,
) -> Measured:
    """Give an object's outline and scale at the height of its axis.

    Parameters
    ----------
    made : Rectified
    silhouette : Silhouette
        Found in ``made.plain``; the axis of a body of revolution within 30 degrees of upright.
    camera_distance_mm : float or None
        From the lens to the sheet, where it was measured; else the picture tells it.
    revolved : bool
        Whether the object may be a body of revolution; if not, its outline stays as it is seen.
    flat : bool
        Whether it is flat and lies on the sheet: its outline and the sheet's scale are its own.

    Raises
    ------
    UsageError
        The sheet shows the camera somewhere else.
    NoScale
        The camera would have been inside the object.
    """
    k = made.picture.mm_per_px
    assert k is not None  # `rectify` always knows it
    camera = _camera(made.camera, camera_distance_mm)
    foot, high = np.array(camera.foot_px), camera.height_mm
    contour = silhouette.contour_px
    size = np.ptp(contour, axis=0)
    around = revolved and not flat
    section = lying_section(contour * k, np.append(foot * k, high)) if around else None
    t = 0.0 if flat else axis_height(0.5 * thickness(contour) * k, high)
    t = t if section is None else section.height_mm
    if t > LARGEST_SHARE * high:
        raise NoScale(
            f"a camera {high:.0f} mm above the sheet is too near for an object so thick; "
            "photograph it from farther off"
        )
    near = shrinkage(t, high)
    if section is not None:
        contour = foot + (section.points / k - foot) / near
    aside = float(np.hypot(*(contour.mean(axis=0) - foot))) * k
    left = Remaining(0.0, 0.0) if flat else remaining(t, camera, aside, section is not None)
    edges = math.hypot(silhouette.noise_px, _EDGE_PX)
    noise = 2.0 * math.sqrt(2.0) * edges / float(size.min())
    measured = math.hypot(2.0 * made.error_share, left.distance, noise)
    share = math.hypot(measured, left.shape)
    return Measured(
        silhouette=replace(silhouette, contour_px=contour),
        scale=Scale(k * near, "sheet", share, None if flat else 2.0 * t, 1.0 / near - 1.0),
        height_mm=t,
        round=section is not None,
        measured_share=measured,
        shape_share=left.shape,
    )


def _camera(seen: Camera, given_mm: float | None) -> Camera:
    """Give the camera at the distance that was measured, else where the sheet shows it."""
    if given_mm is None:
        return seen
    _check_distance(given_mm, seen.height_mm)
    return replace(seen, height_mm=given_mm, height_share=DISTANCE_SHARE)


def _check_distance(given_mm: float, seen_mm: float) -> None:
    if not seen_mm / _FAR_OFF < given_mm < seen_mm * _FAR_OFF:
        raise UsageError(
            f"`camera_distance_mm` is {given_mm:g} mm, but the sheet shows the camera about "
            f"{seen_mm:.0f} mm above it; give millimetres from the lens to the sheet"
        )
