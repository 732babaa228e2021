"""Proposals for the object: masks by several methods that do not know what it looks like."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

import cv2
import numpy as np

from profiletool.errors import NoObject
from profiletool.image.find.background import unconnected
from profiletool.image.find.ground import BoolImage, FloatImage, Ground, fit_ground
from profiletool.image.find.judge import LEARNED
from profiletool.image.find.learned import learned_share
from profiletool.image.find.masks import window_of
from profiletool.image.find.region import SeveralAlike, choose_object, region_on_ground
from profiletool.image.find.rough import Rough, disc, rough_of
from profiletool.image.find.saliency import barrier, strangeness
from profiletool.image.find.view import View
from profiletool.records.request import Point

AT_POINT = "colours round the point"
_SIZES = 0.004, 0.85  # of the frame
_ROUGH_PIXELS = 20_000  # of maps that take their time
_FLAT = 0.05  # a map that does not rise above this shows rounding only
_MOST = 3  # regions of one map that are looked at
_ROUND_POINT = 0.08, 0.16, 0.3  # of the shorter side: radii in which its colours are the object's
_RECTANGLES = 0.9, 0.8, 0.65  # of the picture, where the object may lie
_INWARD = 0.03  # of a region's size: what lies within its rim may lie on it


def proposals(
    view: View, rough: Rough, maps: Mapping[str, FloatImage]
) -> Iterator[tuple[str, BoolImage]]:
    """Give masks, each with the name of its method."""
    shape = view.barred.shape
    for method, strange in maps.items():
        guess = standing_out(strange) & ~view.barred
        yield method, guess
        yield f"{method}, cut", rough.cut(guess)
    for method, guess in _guesses(view):
        yield f"{method}, cut", rough.cut(guess)
    yield from _round_point(view, rough)
    for share in () if view.boxed else _RECTANGLES:
        guess = _rectangle(shape, share)
        yield f"a rectangle of {100 * share:.0f} %", rough.cut(guess, elsewhere=False)
    learned = learned_share(view.rgb)
    if learned is not None:
        yield LEARNED, (learned > 0.5) & ~view.barred


def maps_of(view: View) -> dict[str, FloatImage]:
    """Give maps of what stands out, (H, W)."""
    shape = view.barred.shape
    step = max(1.0, float(np.sqrt(view.barred.size / _ROUGH_PIXELS)))
    small = _resized(view.lab, (round(shape[0] / step), round(shape[1] / step)))
    return {
        "colours": view.ground.distance,
        "texture": _resized(strangeness(small), shape),
        "barriers": _resized(barrier(small), shape),
        "background": unconnected(view.lab),
    }


def _resized(image: FloatImage, shape: tuple[int, ...]) -> FloatImage:
    way = cv2.INTER_AREA if shape[0] < image.shape[0] else cv2.INTER_LINEAR
    return np.asarray(cv2.resize(image, shape[1::-1], interpolation=way), np.float32)


def standing_out(strange: FloatImage) -> BoolImage:
    """Split a map by Otsu's threshold."""
    top = float(np.quantile(strange, 0.99))
    if top < _FLAT:
        return np.zeros(strange.shape, bool)
    grey = np.clip(strange * (255.0 / top), 0, 255).astype(np.uint8)
    level, _ = cv2.threshold(grey, 0, 255, cv2.THRESH_BINARY | cv2.THRESH_OTSU)
    return np.asarray(grey > level)


def _guesses(view: View) -> Iterator[tuple[str, BoolImage]]:
    """Where the object is likely to be whatever it looks like."""
    shape = height, width = view.barred.shape
    if view.boxed:
        yield "the box", _inscribed(~view.barred)
        yield "all of the box", ~view.barred
        return
    middle = (width - 1) / 2.0, (height - 1) / 2.0
    yield "the middle", disc(shape, middle, 0.3 * min(shape))


def _round_point(view: View, rough: Rough) -> Iterator[tuple[str, BoolImage]]:
    """Cut out what has the colours near the point, and again from that."""
    if view.point is None:
        return
    shape = view.barred.shape
    for share in _ROUND_POINT:
        found = rough.cut(disc(shape, view.point, share * min(shape)))
        for region in regions(found, view.point):
            yield f"{AT_POINT}, cut again", rough.cut(region)
        yield f"{AT_POINT}, cut", found


def _rectangle(shape: tuple[int, ...], share: float) -> BoolImage:
    """Mask the middle of a picture, a share of its height and width."""
    inner = np.zeros(shape, bool)
    high, wide = (round(side * (1.0 - share) / 2.0) for side in shape)
    inner[high : shape[0] - high, wide : shape[1] - wide] = True
    return inner


def _inscribed(box: BoolImage) -> BoolImage:
    """Mask the ellipse that touches a box from inside."""
    rows, columns = window_of(box, 0)
    middle = (columns.start + columns.stop - 1) / 2.0, (rows.start + rows.stop - 1) / 2.0
    half = (columns.stop - columns.start) / 2.0, (rows.stop - rows.start) / 2.0
    v, u = np.ogrid[: box.shape[0], : box.shape[1]]
    return np.asarray(np.hypot((u - middle[0]) / half[0], (v - middle[1]) / half[1]) <= 1.0)


def regions(mask: BoolImage, point: Point | None) -> list[BoolImage]:
    """Give the regions of a mask that may be the object, their holes filled."""
    try:
        found = [choose_object(mask, point)]
    except SeveralAlike as several:
        found = several.regions[:_MOST]
    except NoObject:
        found = []
    return [region for region in found if _SIZES[0] < region.mean() < _SIZES[1]]


def within(view: View, host: BoolImage) -> Iterator[BoolImage]:
    """Look into a region as if it were the ground of what lies on it; give masks of that."""
    window = window_of(host, 0)
    padded = np.pad(host, 1)
    deep = cv2.distanceTransform(padded.view(np.uint8), cv2.DIST_L2, 3)[1:-1, 1:-1]
    inner = deep > 1.0 + _INWARD * float(np.sqrt(host.sum()))
    ground = fit_ground(view.lab[window], ~view.barred[window], host[window])
    off = np.where((inner & ~view.barred)[window], ground.distance, np.float32(0))
    ground = replace(ground, distance=off)
    for found in _on_plain(view.lab[window], ground, view.point, window):
        yield _whole(found, host, window)
    guess = standing_out(off) & ground.standing
    yield _whole(rough_of(view, window, ~inner).cut(guess), host, window)


def _on_plain(
    lab: FloatImage, ground: Ground, point: Point | None, window: tuple[slice, slice]
) -> Iterator[BoolImage]:
    if point is not None:
        point = point[0] - window[1].start, point[1] - window[0].start
    try:
        yield region_on_ground(lab, ground, point)
    except SeveralAlike as several:
        yield from several.regions[:_MOST]
    except NoObject:
        return


def _whole(mask: BoolImage, host: BoolImage, window: tuple[slice, slice]) -> BoolImage:
    whole = np.zeros(host.shape, bool)
    whole[window] = mask
    return whole
