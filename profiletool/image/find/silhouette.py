"""The outline of the one object in a picture: found, or refused with what it could be."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import cv2
import numpy as np
from numpy.typing import NDArray

from profiletool.errors import Unsure, UsageError
from profiletool.image.find.contour import largest_region, outline, smoothed
from profiletool.image.find.cut_out import cuts_out, opaque_part, page_in, without_alpha
from profiletool.image.find.ground import FloatImage
from profiletool.image.find.hint import LEAST_PX, Hint, check_hint
from profiletool.image.find.masks import (
    edges_touched,
    fill_holes,
    largest_filled,
    without_spurs,
)
from profiletool.image.find.region import choose_object, pixel_at
from profiletool.image.find.search import Found, fit_of, searched
from profiletool.image.find.sizes import outside_of, pasted, reduced, resized, scaled, window_round
from profiletool.image.find.two_tone import trimmed, two_tones
from profiletool.image.marker import with_quiet_zone
from profiletool.records.picture import Picture, Silhouette
from profiletool.records.units import FloatArray

_FINE_PIXELS = 6_000_000  # the contour is taken at no more than this
_BOX_MARGIN = 0.15  # of a box's size: so much round it tells what the ground looks like
_SOFT_PX, _STAIR_PX = 1.0, 0.5  # of a mask's staircase: what softens it, what it leaves
_MATTE, _GIVEN, _TONES = "alpha matte", "mask", "two tones"
_OUTRIGHT = _MATTE, _GIVEN, _TONES


def find_silhouette(
    picture: Picture, ignore: Sequence[FloatArray] = (), hint: Hint | None = None
) -> Silhouette:
    """Find the outline of the one object in a picture.

    Parameters
    ----------
    picture : Picture
        Of one object, with an alpha matte or on a ground that looks different.
    ignore : sequence of (4, 2)
        Markers, in the picture frame: they and the white paper round them count as ground.
    hint : Hint, or None
        What the user says about where the object is.

    Returns
    -------
    Silhouette
        ``touches`` names the frame edges that the object runs into; a cut-out trimmed to
        its own size, on three sides at least, runs into none.

    Raises
    ------
    NoObject
        Nothing found, several objects alike, or one that covers the whole picture.
    Unsure
        Nothing found for certain, or a hand holds it; it carries the candidates.
    UsageError
        The hint does not fit the picture.
    """
    hint = hint or Hint()
    shape = picture.rgb.shape[:2]
    check_hint(hint, shape)
    polygons = [with_quiet_zone(corners) for corners in ignore]
    page = None if hint.mask is not None or hint.box is not None else page_in(picture)
    if page is not None:
        picture, window = without_alpha(picture), page
    elif hint.mask is None and hint.box is not None:
        window = window_round(hint.box, shape, _BOX_MARGIN)
    else:
        return _outlined(picture, polygons, hint)
    corner = np.array([window[1].start, window[0].start], np.float64)
    try:
        found = _outlined(
            _cut(picture, window), [polygon - corner for polygon in polygons], _moved(hint, corner)
        )
    except Unsure as unsure:
        whole = [(pasted(mask, window, shape), c, how) for mask, c, how in unsure.candidates]
        raise Unsure(str(unsure), tuple(whole), picture.rgb) from None
    mask = pasted(found.mask, window, shape)
    touches = found.touches & edges_touched(mask)
    return replace(found, contour_px=found.contour_px + corner, mask=mask, touches=touches)


def _outlined(picture: Picture, polygons: list[FloatArray], hint: Hint) -> Silhouette:
    """Find the outline where a box is all but the whole picture."""
    step = math.ceil(math.sqrt(picture.rgb[..., 0].size / _FINE_PIXELS))
    if hint.mask is not None:
        found = _given(picture.rgb, hint, step)
    elif picture.alpha is not None and cuts_out(picture.alpha):
        share = reduced(picture.alpha, step).astype(np.float32) / np.float32(255)
        share, confidence = opaque_part(share)
        found = Found(_one_region(share, hint, step), _MATTE, confidence)
    elif not polygons and (tones := two_tones(reduced(picture.rgb, step))) is not None:
        found = Found(_one_region(tones, hint, step), _TONES)
    else:
        found = searched(picture.rgb, polygons, hint, step)
    mask = largest_region(found.field)
    if found.method not in _OUTRIGHT:
        mask = without_spurs(mask)
    if found.method == _GIVEN:
        # A mask's edge is a staircase: softened, its level line is straight again.
        soft = np.asarray(cv2.GaussianBlur(found.field, (0, 0), _SOFT_PX), np.float32)
        contour, noise = smoothed(outline(soft, mask), _STAIR_PX)
    else:
        contour, noise = smoothed(outline(found.field, mask))
    touches = edges_touched(mask)
    shown = found.field if picture.alpha is None else picture.alpha
    if found.method in _OUTRIGHT and trimmed(shown > 0):
        touches = frozenset()
    if step > 1:
        contour = (contour + 0.5) * step - 0.5
        mask = resized(mask, picture.rgb.shape[:2])
    return Silhouette(
        contour,
        mask,
        found.method,
        noise * step,
        touches,
        found.confidence,
        found.held,
        found.doubt,
    )


# --- the three ways -------------------------------------------------------------------------


def _given(rgb: NDArray[np.uint8], hint: Hint, step: int) -> Found:
    """Take one region of the user's mask as it is, and measure how well it fits the picture."""
    mask = np.asarray(hint.mask, bool)
    if hint.box is not None:
        mask = mask & ~outside_of(hint.box, mask.shape, 1.0)
    if hint.point is not None:
        if not fill_holes(mask)[pixel_at(hint.point, mask.shape)]:
            raise UsageError("`point` lies outside what `mask` holds; give one of them")
        whole = choose_object(mask, hint.point)
    else:
        whole = largest_filled(mask)
    rows, columns = np.flatnonzero(whole.any(axis=1)), np.flatnonzero(whole.any(axis=0))
    if min(len(rows), len(columns)) < LEAST_PX:
        raise UsageError(
            f"the mask holds nothing {LEAST_PX} pixels wide and high; paint the object white on "
            "black"
        )
    field = reduced(whole.view(np.uint8) * 255, step).astype(np.float32) / np.float32(255)
    return Found(field, _GIVEN, fit_of(rgb, whole))


def _one_region(share: FloatImage, hint: Hint, step: int) -> FloatImage:
    """Keep the one object of a share of object (H, W), its soft rim too."""
    if hint.box is not None:
        share = np.where(outside_of(hint.box, share.shape, step), np.float32(0), share)
    padded = np.pad(share > 0.5, 1)  # a trimmed cut-out may run along the frame
    point = None if hint.point is None else scaled(hint.point, step)
    if point is not None:
        point = point[0] + 1.0, point[1] + 1.0
    chosen = choose_object(padded, point)[1:-1, 1:-1].astype(np.uint8)
    return share * cv2.dilate(chosen, np.ones((3, 3), np.uint8))


def _cut(picture: Picture, window: tuple[slice, slice]) -> Picture:
    alpha = None if picture.alpha is None else np.ascontiguousarray(picture.alpha[window])
    return replace(picture, rgb=np.ascontiguousarray(picture.rgb[window]), alpha=alpha)


def _moved(hint: Hint, corner: FloatArray) -> Hint:
    """Give a hint as it is seen from a corner of its picture."""
    left, top = (float(value) for value in corner)
    box = None if hint.box is None else (hint.box[0] - left, hint.box[1] - top, *hint.box[2:])
    point = None if hint.point is None else (hint.point[0] - left, hint.point[1] - top)
    return replace(hint, box=box, point=point)
