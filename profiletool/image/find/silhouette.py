"""The outline of the one object in a picture: found, or refused with what it could be."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from profiletool.errors import NoObject, Unsure, UsageError
from profiletool.image.find.candidates import BELIEVED, Candidate, find_candidates, judged, view_of
from profiletool.image.find.choice import ranked, refuse_another
from profiletool.image.find.contour import largest_region, outline, smoothed
from profiletool.image.find.ground import BoolImage, FloatImage
from profiletool.image.find.hand import is_held
from profiletool.image.find.hint import LEAST_PX, Hint, check_hint
from profiletool.image.find.masks import edges_touched, fill_holes, largest_filled, without_spurs
from profiletool.image.find.matte import edge_field
from profiletool.image.find.region import choose_object, pixel_at
from profiletool.image.marker import paint_mask, with_quiet_zone
from profiletool.records.picture import Picture, Silhouette
from profiletool.records.request import Box, Point
from profiletool.records.units import FloatArray

_FINE_PIXELS = 6_000_000  # the contour is taken at no more than this
_ROUGH_PIXELS = 400_000  # the object is told from the ground at no more than this
_TRIM_PX = 2
_BOX_MARGIN = 0.15  # of a box's size: so much round it tells what the ground looks like
_SHOWN = 4
_SOFT_PX, _STAIR_PX = 1.0, 0.5  # of a mask's staircase: what softens it, what it leaves
_MATTE, _GIVEN = "alpha matte", "mask"


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
    if hint.mask is not None or hint.box is None:
        return _outlined(picture, polygons, hint)
    window = _window(hint.box, shape, _BOX_MARGIN)
    corner = np.array([window[1].start, window[0].start], np.float64)
    try:
        found = _outlined(
            _cut(picture, window), [polygon - corner for polygon in polygons], _moved(hint, corner)
        )
    except Unsure as unsure:
        whole = [(_pasted(mask, window, shape), c, how) for mask, c, how in unsure.candidates]
        raise Unsure(str(unsure), tuple(whole), picture.rgb) from None
    mask = _pasted(found.mask, window, shape)
    touches = found.touches & edges_touched(mask)
    return replace(found, contour_px=found.contour_px + corner, mask=mask, touches=touches)


@dataclass(frozen=True)
class _Found:
    """Share of object in every pixel, (H, W), what found it, how far it is believed, and held."""

    field: FloatImage
    method: str
    confidence: float = 1.0
    held: bool = False


def _outlined(picture: Picture, polygons: list[FloatArray], hint: Hint) -> Silhouette:
    """Find the outline where a box is all but the whole picture."""
    step = math.ceil(math.sqrt(picture.rgb[..., 0].size / _FINE_PIXELS))
    if hint.mask is not None:
        found = _given(picture.rgb, hint, step)
    elif picture.alpha is not None and _informative(picture.alpha):
        found = _Found(_alpha_field(picture.alpha, hint, step), _MATTE)
    else:
        found = _searched(picture.rgb, polygons, hint, step)
    mask = largest_region(found.field)
    if found.method not in (_MATTE, _GIVEN):
        mask = without_spurs(mask)
    if found.method == _GIVEN:
        # A mask's edge is a staircase: softened, its level line is straight again.
        soft = np.asarray(cv2.GaussianBlur(found.field, (0, 0), _SOFT_PX), np.float32)
        contour, noise = smoothed(outline(soft, mask), _STAIR_PX)
    else:
        contour, noise = smoothed(outline(found.field, mask))
    touches = edges_touched(mask)
    if found.method in (_MATTE, _GIVEN) and _trimmed(picture.alpha):
        touches = frozenset()
    if step > 1:
        contour = (contour + 0.5) * step - 0.5
        mask = _resized(mask, picture.rgb.shape[:2])
    return Silhouette(
        contour, mask, found.method, noise * step, touches, found.confidence, found.held
    )


# --- the three ways -------------------------------------------------------------------------


def _given(rgb: NDArray[np.uint8], hint: Hint, step: int) -> _Found:
    """Take one region of the user's mask as it is, and measure how well it fits the picture."""
    mask = np.asarray(hint.mask, bool)
    if hint.box is not None:
        mask = mask & ~_outside(hint.box, mask.shape, 1.0)
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
    field = _reduced(whole.view(np.uint8) * 255, step).astype(np.float32) / np.float32(255)
    small = _reduced(rgb, max(1.0, math.sqrt(mask.size / _ROUGH_PIXELS)))
    shape = small.shape[:2]
    fit = judged(view_of(small, np.zeros(shape, bool)), _resized(whole, shape), _GIVEN)
    return _Found(field, _GIVEN, fit.confidence)


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


def _alpha_field(alpha: NDArray[np.uint8], hint: Hint, step: int) -> FloatImage:
    if hint.box is not None:
        alpha = np.where(_outside(hint.box, alpha.shape, 1.0), np.uint8(0), alpha)
    field = _reduced(alpha, step).astype(np.float32) / np.float32(255)
    padded = np.pad(field > 0.5, 1)  # a trimmed cut-out may run along the frame
    point = None if hint.point is None else _scaled(hint.point, step)
    if point is not None:
        point = point[0] + 1.0, point[1] + 1.0
    chosen = choose_object(padded, point)[1:-1, 1:-1].astype(np.uint8)
    # The soft rim stays, other regions go.
    return field * cv2.dilate(chosen, np.ones((3, 3), np.uint8))


def _searched(
    rgb: NDArray[np.uint8], polygons: list[FloatArray], hint: Hint, fine_step: int
) -> _Found:
    """Search a picture without a matte."""
    fine = _reduced(rgb, fine_step)
    step = max(1.0, math.sqrt(fine[..., 0].size / _ROUGH_PIXELS))
    small = _reduced(fine, step)
    shape = small.shape[:2]
    ignored = paint_mask(polygons, shape, step * fine_step)
    outside = None if hint.box is None else _outside(hint.box, shape, step * fine_step)
    point = None if hint.point is None else _scaled(hint.point, step * fine_step)
    view = view_of(small, ignored, outside, point)
    found = ranked(find_candidates(view), pointed=point is not None)
    best = found[0]
    if best.confidence < BELIEVED:
        raise _unsure(
            found,
            rgb,
            "the object cannot be told from the ground for certain "
            f"({100 * best.confidence:.0f} %); say where it is with `box`, `point` or `mask`, or "
            "photograph it on a plain ground of another colour",
        )
    held = is_held(view, best.mask)
    if held and hint.box is None and hint.point is None:
        raise _unsure(
            found,
            rgb,
            "a hand seems to hold the object and hide part of it; lay it down, or say with `box`, "
            "`point` or `mask` what to take",
        )
    if point is None:
        refuse_another(best, found)
    field = edge_field(fine, best.mask, small)
    if hint.box is not None:
        field[_outside(hint.box, field.shape, fine_step)] = 0.0
    return _Found(field, best.method, best.confidence, held)


def _unsure(found: list[Candidate], rgb: NDArray[np.uint8], why: str) -> Unsure:
    shown = tuple((_resized(c.mask, rgb.shape[:2]), c.confidence, c.method) for c in found[:_SHOWN])
    return Unsure(why, shown, rgb)


# --- boxes, points and sizes ----------------------------------------------------------------


def _window(box: Box, shape: tuple[int, ...], margin: float) -> tuple[slice, slice]:
    """Rows and columns of a box and of a margin round it, a share of its size."""
    x, y, w, h = box
    left, top = max(0, math.floor(x - margin * w)), max(0, math.floor(y - margin * h))
    right, bottom = math.ceil(x + (1 + margin) * w), math.ceil(y + (1 + margin) * h)
    return slice(top, min(bottom, shape[0])), slice(left, min(right, shape[1]))


def _cut(picture: Picture, window: tuple[slice, slice]) -> Picture:
    alpha = None if picture.alpha is None else np.ascontiguousarray(picture.alpha[window])
    return replace(picture, rgb=np.ascontiguousarray(picture.rgb[window]), alpha=alpha)


def _moved(hint: Hint, corner: FloatArray) -> Hint:
    """Give a hint as it is seen from a corner of its picture."""
    left, top = (float(value) for value in corner)
    box = None if hint.box is None else (hint.box[0] - left, hint.box[1] - top, *hint.box[2:])
    point = None if hint.point is None else (hint.point[0] - left, hint.point[1] - top)
    return Hint(box, point)


def _pasted(mask: BoolImage, window: tuple[slice, slice], shape: tuple[int, ...]) -> BoolImage:
    whole = np.zeros(shape, bool)
    whole[window] = mask
    return whole


def _outside(box: Box, shape: tuple[int, ...], step: float) -> BoolImage:
    """Pixels of a picture reduced by a factor that lie outside a box of the full one."""
    outside = np.ones(shape, bool)
    x, y, w, h = (value / step for value in box)
    outside[round(y) : round(y + h), round(x) : round(x + w)] = False
    return outside


def _scaled(point: Point, step: float) -> Point:
    return (point[0] + 0.5) / step - 0.5, (point[1] + 0.5) / step - 0.5


def _reduced(image: NDArray[np.uint8], step: float) -> NDArray[np.uint8]:
    """Reduce by a factor, averaging; a factor of 1 returns the picture itself."""
    if step <= 1:
        return image
    height, width = image.shape[:2]
    size = max(1, round(width / step)), max(1, round(height / step))
    return np.asarray(cv2.resize(image, size, interpolation=cv2.INTER_AREA), np.uint8)


def _resized(mask: BoolImage, shape: tuple[int, ...]) -> BoolImage:
    """Bring a mask to another size."""
    if mask.shape == tuple(shape[:2]):
        return mask
    return np.asarray(cv2.resize(mask.view(np.uint8) * 255, (shape[1], shape[0])) > 127)
