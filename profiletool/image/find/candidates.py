"""Candidates for the object, by several methods, each judged by the same measure."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TypeVar

import cv2
import numpy as np
from numpy.typing import NDArray

from profiletool.errors import NoObject
from profiletool.image.find.across import snapped
from profiletool.image.find.colours import cells, histogram, likelier
from profiletool.image.find.ground import (
    BoolImage,
    FloatImage,
    Ground,
    fit_ground,
    frame_of,
    to_lab,
)
from profiletool.image.find.masks import largest_filled, overlap, window_of
from profiletool.image.find.quality import Quality, quality_of
from profiletool.image.find.region import SeveralAlike, choose_object, grabcut, region_on_ground
from profiletool.image.find.saliency import barrier, strangeness
from profiletool.image.find.shadow import faded
from profiletool.records.request import Point

BELIEVED = 0.5  # a candidate of less confidence is nothing to design from
_CLEAR = 0.75  # on a mottled ground, the first look is the last if it is as good as this
# Logarithms of odds: what a plain ground shows is to be trusted, and on a mottled one there is
# more that looks like an object.
_PLAIN_PRIOR, _MOTTLED_PRIOR = 1.5, -0.7
_ROUGH_PIXELS = 30_000
_MOTTLED_LAB = 3.0  # a ground that scatters more than this is not told by a smooth surface
_BLUR_PX = 0.8
_AT_POINT = "grabcut round the point"
_SIZES = 0.004, 0.85  # of the frame
_SNAP_PX = 4
_SAME = 0.985  # overlap of regions that the snapping makes one
_Value = TypeVar("_Value", np.uint8, np.float32)
_FLAT = 0.05  # a map that does not rise above this shows rounding only
_MOST = 3  # regions of one map that are looked at


@dataclass(frozen=True)
class View:
    """A picture as small as the search needs.

    Attributes
    ----------
    rgb : (H, W, 3) uint8
    lab : (H, W, 3)
        The same in CIE Lab, lightly blurred.
    cell : (H, W) int32
        The cell of every pixel's colour, as `colours.cells` numbers them.
    ground : Ground
        Fitted to all of it but the markers; its distance is 0 where there is no object for certain.
    barred : (H, W) bool
        Where there is no object for certain.
    point : (x, y), or None
        Pixels of this view; inside the object for certain.
    boxed : bool
        Whether all but a box is barred.
    """

    rgb: NDArray[np.uint8]
    lab: FloatImage
    cell: NDArray[np.int32]
    ground: Ground
    barred: BoolImage
    point: Point | None = None
    boxed: bool = False

    @property
    def plain(self) -> bool:
        """Whether a smooth colour surface tells all of the ground."""
        return self.ground.scatter_lab < _MOTTLED_LAB


@dataclass(frozen=True)
class Candidate:
    """A mask of a view, (H, W), what found it, and how good it is."""

    mask: BoolImage
    method: str
    quality: Quality
    prior: float = 0.0

    @property
    def confidence(self) -> float:
        """Chance that the mask is right, 0 to 1."""
        return self.quality.confidence(self.prior)


def view_of(
    rgb: NDArray[np.uint8],
    ignored: BoolImage,
    outside: BoolImage | None = None,
    point: Point | None = None,
) -> View:
    """Make a view of an (H, W, 3) picture, ``outside`` being ground for certain too."""
    barred = ignored if outside is None else ignored | outside
    lab = _soft_lab(rgb)
    ground = fit_ground(lab, ~ignored)
    ground = replace(ground, distance=np.where(barred, np.float32(0), ground.distance))
    return View(rgb, lab, cells(lab), ground, barred, point, outside is not None)


def _soft_lab(rgb: NDArray[np.uint8]) -> FloatImage:
    return np.asarray(cv2.GaussianBlur(to_lab(rgb), (0, 0), _BLUR_PX), np.float32)


def find_candidates(view: View) -> list[Candidate]:
    """Look for the object by one method after the other, until one has found it clearly.

    Returns
    -------
    list of Candidate
        In the order of the methods.

    Raises
    ------
    NoObject
        No method found anything, or the first one clearly found several objects alike.
    """
    found: list[Candidate] = []
    missed: NoObject | None = None
    try:
        found.append(_first_look(view))
    except NoObject as problem:
        if isinstance(problem, SeveralAlike) and view.plain:
            raise
        missed = problem
    if not found or found[0].confidence < (BELIEVED if view.plain else _CLEAR):
        found += [judged(view, mask, method) for method, mask in _second_looks(view, found)]
    if not found:
        assert missed is not None
        raise missed
    return found


def _first_look(view: View) -> Candidate:
    """Look for what stands out from a plain ground; if it is one, that is to be trusted."""
    region = region_on_ground(view.lab, view.ground, view.point)
    found = judged(view, region, "plain ground")
    trusted = view.plain and not faded(region, view.lab)
    return replace(found, prior=_PLAIN_PRIOR) if trusted else found


def judged(view: View, mask: BoolImage, method: str) -> Candidate:
    """Judge one region of a view."""
    told = view.plain or view.boxed or method == _AT_POINT
    prior = 0.0 if told else _MOTTLED_PRIOR
    return Candidate(mask, method, quality_of(view.lab, view.cell, mask), prior)


def _second_looks(view: View, found: list[Candidate]) -> Iterator[tuple[str, BoolImage]]:
    """Give masks by every other method, their outlines moved to the edges nearby."""
    for first in found:
        yield first.method, _snapped(view, first.mask)
    step = max(1.0, math.sqrt(view.barred.size / _ROUGH_PIXELS))
    rough = _rough(view, step)
    seen: list[BoolImage] = []
    for method, mask in _rough_masks(rough):
        for region in _regions(mask, rough.point):
            if any(overlap(region, other) > _SAME for other in seen):
                continue
            seen.append(region)
            fine = _resized(region.astype(np.float32), view.barred.shape) > 0.5
            yield method, _snapped(view, largest_filled(fine))


@dataclass(frozen=True)
class _Rough:
    """A view made smaller still, for methods that take their time."""

    rgb: NDArray[np.uint8]
    lab: FloatImage
    distance: FloatImage
    barred: BoolImage
    point: Point | None
    boxed: bool


def _rough(view: View, step: float) -> _Rough:
    height, width = view.barred.shape
    shape = max(8, round(height / step)), max(8, round(width / step))
    rgb = _resized(view.rgb, shape)
    barred = _resized(view.barred.astype(np.float32), shape) > 0.5
    point = None if view.point is None else (view.point[0] / step, view.point[1] / step)
    distance = _resized(view.ground.distance, shape)
    return _Rough(rgb, _soft_lab(rgb), distance, barred, point, view.boxed)


def _resized(image: NDArray[_Value], shape: tuple[int, ...]) -> NDArray[_Value]:
    shrinks = shape[0] < image.shape[0]
    way = cv2.INTER_AREA if shrinks else cv2.INTER_LINEAR
    return np.asarray(cv2.resize(image, shape[1::-1], interpolation=way))


def _rough_masks(view: _Rough) -> Iterator[tuple[str, BoolImage]]:
    """Masks at low resolution, from maps of what is unlike the ground."""
    maps = {
        "grabcut": view.distance,
        "grabcut on texture": strangeness(view.lab),
        "grabcut on barriers": barrier(view.lab),
    }
    for method, strange in maps.items():
        yield method, grabcut(view.rgb, _labels(view, _standing_out(strange)))
    yield "barriers", _standing_out(maps["grabcut on barriers"])
    for method, guess in _guesses(view):
        yield method, grabcut(view.rgb, _labels(view, guess))


def _standing_out(strange: FloatImage) -> BoolImage:
    """Split a map by Otsu's threshold."""
    top = float(np.quantile(strange, 0.99))
    if top < _FLAT:
        return np.zeros(strange.shape, bool)
    grey = np.clip(strange * (255.0 / top), 0, 255).astype(np.uint8)
    level, _ = cv2.threshold(grey, 0, 255, cv2.THRESH_BINARY | cv2.THRESH_OTSU)
    return np.asarray(grey > level)


def _labels(view: _Rough, guess: BoolImage) -> NDArray[np.uint8]:
    """Labels for cv2.grabCut: the frame is ground, the rest a guess, a point is certain."""
    labels = np.where(guess, cv2.GC_PR_FGD, cv2.GC_PR_BGD).astype(np.uint8)
    labels[frame_of(guess.shape, 0.03) | view.barred] = cv2.GC_BGD
    if view.point is not None:
        labels[_disc(guess.shape, view.point, 0.03 * min(guess.shape))] = cv2.GC_FGD
    return labels


def _guesses(view: _Rough) -> Iterator[tuple[str, BoolImage]]:
    """Where the object is likely to be whatever it looks like."""
    height, width = view.barred.shape
    if view.point is not None:
        for share in (0.12, 0.25):
            radius = share * min(height, width)
            yield _AT_POINT, _disc((height, width), view.point, radius)
        return
    if view.boxed:
        yield "grabcut in the box", _inscribed(~view.barred)
        return
    middle = (width - 1) / 2.0, (height - 1) / 2.0
    yield "grabcut from the middle", _disc((height, width), middle, 0.3 * min(height, width))


def _inscribed(box: BoolImage) -> BoolImage:
    """Mask the ellipse that touches a box from inside."""
    rows, columns = window_of(box, 0)
    middle = (columns.start + columns.stop - 1) / 2.0, (rows.start + rows.stop - 1) / 2.0
    half = (columns.stop - columns.start) / 2.0, (rows.stop - rows.start) / 2.0
    v, u = np.ogrid[: box.shape[0], : box.shape[1]]
    return np.asarray(np.hypot((u - middle[0]) / half[0], (v - middle[1]) / half[1]) <= 1.0)


def _disc(shape: tuple[int, ...], centre: Point, radius: float) -> BoolImage:
    v, u = np.ogrid[: shape[0], : shape[1]]
    return np.asarray(np.hypot(u - centre[0], v - centre[1]) <= radius)


def _regions(mask: BoolImage, point: Point | None) -> list[BoolImage]:
    try:
        regions = [choose_object(mask, point)]
    except SeveralAlike as several:
        regions = several.regions[:_MOST]
    except NoObject:
        regions = []
    return [region for region in regions if _SIZES[0] < region.mean() < _SIZES[1]]


def _snapped(view: View, mask: BoolImage) -> BoolImage:
    """Move an outline to the edge nearby between the colours inside and those just outside."""
    wide = max(6, round(0.15 * math.sqrt(float(mask.sum()))))
    off = cv2.distanceTransform((~mask).view(np.uint8), cv2.DIST_L2, 3)
    cell = view.cell
    inside, near = histogram(cell, mask), histogram(cell, (off > 1) & (off < wide))
    return snapped(view.lab, likelier(cell, inside, near), mask, _SNAP_PX) & ~view.barred
