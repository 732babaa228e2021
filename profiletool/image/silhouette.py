"""The outline of the one object in a picture, by the first method that works."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import cv2
import numpy as np
from numpy.typing import NDArray

from profiletool.errors import NoObject
from profiletool.image.contour import largest_region, outline, smoothed
from profiletool.image.ground import BoolImage, FloatImage, fit_ground, to_lab
from profiletool.image.marker import paint_mask, with_quiet_zone
from profiletool.image.masks import edges_touched, without_spurs
from profiletool.image.matte import edge_field
from profiletool.image.region import choose_object, grabcut_region, region_on_ground
from profiletool.records import FloatArray, Picture, Silhouette

_FINE_PIXELS = 6_000_000  # the contour is taken at no more than this
_ROUGH_PIXELS = 400_000  # the object is told from the ground at no more than this
_GRABCUT_PIXELS = 60_000  # it takes 25 s per megapixel
_MOTTLED_LAB = 8.0  # a ground that scatters more than this may hide an object
_BLUR_PX = 0.8
_TRIM_PX = 2
_SPECK_SHARE = 0.01


def find_silhouette(picture: Picture, ignore: Sequence[FloatArray] = ()) -> Silhouette:
    """Find the outline of the one object in a picture.

    Parameters
    ----------
    picture : Picture
        Of one object, with an alpha matte or on a ground of another colour.
    ignore : sequence of (4, 2)
        Markers, in the picture frame: they and the white paper round them count as ground.

    Returns
    -------
    Silhouette
        ``touches`` names the frame edges that the object runs into; a cut-out trimmed to
        its own size, on three sides at least, runs into none.

    Raises
    ------
    NoObject
        Nothing found, several objects alike, or one that covers the whole picture.
    """
    polygons = [with_quiet_zone(corners) for corners in ignore]
    fine_step = math.ceil(math.sqrt(picture.rgb[..., 0].size / _FINE_PIXELS))
    if picture.alpha is not None and _informative(picture.alpha):
        method, field = "alpha matte", _alpha_field(picture.alpha, fine_step)
    else:
        method, field = _photo_field(_reduced(picture.rgb, fine_step), polygons, fine_step)
    mask = largest_region(field)
    if method != "alpha matte":
        mask = without_spurs(mask)
    contour, noise = smoothed(outline(field, mask))
    touches = edges_touched(mask)
    if method == "alpha matte" and _trimmed(picture.alpha):
        touches = frozenset()
    if fine_step > 1:
        contour = (contour + 0.5) * fine_step - 0.5
        height, width = picture.rgb.shape[:2]
        mask = np.asarray(cv2.resize(mask.view(np.uint8) * 255, (width, height)) > 127)
    return Silhouette(contour, mask, method, noise * fine_step, touches)


def _informative(alpha: NDArray[np.uint8]) -> bool:
    """Whether an alpha channel cuts something out; rounded corners alone do not."""
    share = float((alpha >= 128).mean())
    if share == 0.0:
        raise NoObject("the picture is transparent everywhere; export it with its content")
    return bool(share < 0.98)


def _trimmed(alpha: NDArray[np.uint8] | None) -> bool:
    """Whether a cut-out's canvas is its own bounding box, so that meeting it means nothing."""
    if alpha is None:
        return False
    rows, columns = np.flatnonzero(alpha.any(axis=1)), np.flatnonzero(alpha.any(axis=0))
    margins = (
        rows[0],
        alpha.shape[0] - 1 - rows[-1],
        columns[0],
        alpha.shape[1] - 1 - columns[-1],
    )
    return sum(int(margin) <= _TRIM_PX for margin in margins) >= 3


def _alpha_field(alpha: NDArray[np.uint8], step: int) -> FloatImage:
    field = _reduced(alpha, step).astype(np.float32) / np.float32(255)
    padded = np.pad(field > 0.5, 1)  # a trimmed cut-out may run along the frame
    chosen = choose_object(padded)[1:-1, 1:-1].astype(np.uint8)
    # The soft rim stays, other regions go.
    return field * cv2.dilate(chosen, np.ones((3, 3), np.uint8))


def _reduced(image: NDArray[np.uint8], step: float) -> NDArray[np.uint8]:
    """Reduce by a factor, averaging; a factor of 1 returns the picture itself."""
    if step <= 1:
        return image
    height, width = image.shape[:2]
    size = max(1, round(width / step)), max(1, round(height / step))
    return np.asarray(cv2.resize(image, size, interpolation=cv2.INTER_AREA), np.uint8)


def _photo_field(
    rgb: NDArray[np.uint8], polygons: list[FloatArray], fine_step: int
) -> tuple[str, FloatImage]:
    """Give the method and the soft field of a picture without a matte."""
    step = max(1.0, math.sqrt(rgb[..., 0].size / _ROUGH_PIXELS))
    small = _reduced(rgb, step)
    ignored = paint_mask(polygons, small.shape[:2], step * fine_step)
    lab = _softened_lab(small)
    ground = fit_ground(lab, ~ignored)
    ground = replace(ground, distance=np.where(ignored, np.float32(0), ground.distance))
    mottled = ground.scatter_lab > _MOTTLED_LAB
    try:
        region = region_on_ground(lab, ground)
    except NoObject:
        if not mottled:
            raise
        region = np.zeros(lab.shape[:2], bool)
    method = "plain ground"
    # On a plain ground the first look is the last word; on a mottled one a speck is not.
    if mottled and region.mean() < _SPECK_SHARE:
        method, region = "grabcut", _by_grabcut(small, ground.distance, ignored)
    return method, edge_field(rgb, region, small)


def _softened_lab(rgb: NDArray[np.uint8]) -> FloatImage:
    return np.asarray(cv2.GaussianBlur(to_lab(rgb), (0, 0), _BLUR_PX), np.float32)


def _by_grabcut(rgb: NDArray[np.uint8], distance: FloatImage, ignored: BoolImage) -> BoolImage:
    step = max(1.0, math.sqrt(distance.size / _GRABCUT_PIXELS))
    small = _reduced(rgb, step)
    height, width = small.shape[:2]
    shrunk = np.asarray(
        cv2.resize(distance, (width, height), interpolation=cv2.INTER_AREA), np.float32
    )
    barred = cv2.resize(ignored.view(np.uint8), (width, height)) > 0
    region = grabcut_region(small, _softened_lab(small), shrunk, barred).astype(np.float32)
    return np.asarray(cv2.resize(region, distance.shape[::-1]) > 0.5)
