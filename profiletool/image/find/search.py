"""The search in a picture that does not show its object outright."""

from __future__ import annotations

import contextlib
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from profiletool.errors import NoObject, Unsure, UsageError
from profiletool.image.find.candidates import BELIEVED, find_candidates
from profiletool.image.find.choice import (
    different,
    doubt_of,
    fitting,
    of_one_thing,
    refuse_another,
    round_point,
)
from profiletool.image.find.ground import BoolImage, FloatImage
from profiletool.image.find.hand import Hand, hand_at
from profiletool.image.find.hint import Hint
from profiletool.image.find.judge import PLAIN, Candidate
from profiletool.image.find.masks import overlap
from profiletool.image.find.matte import edge_field
from profiletool.image.find.mosaic import polished
from profiletool.image.find.quality import quality_of
from profiletool.image.find.region import region_on_ground
from profiletool.image.find.sizes import outside_of, reduced, resized, scaled
from profiletool.image.find.view import View, soft_lab, view_of
from profiletool.image.marker import paint_mask
from profiletool.records.units import FloatArray

_MIDDLING_PIXELS = 400_000  # an outline is drawn anew at no more than this
_VIEW_PIXELS = 40_000  # candidates are found and judged at no more than this
_RING_SHARE = 0.015  # of the region's size: what the smaller view may have missed
_SAME = 0.95  # overlap of one region found at two sizes
_SHOWN = 4
_INSTEAD = 0.4  # confidence of another outline of the best candidate that is taken for it


@dataclass(frozen=True)
class Found:
    """Share of object in every pixel, (H, W), what found it, how far it is believed, and doubts."""

    field: FloatImage
    method: str
    confidence: float = 1.0
    held: bool = False
    doubt: str = ""


def searched(
    rgb: NDArray[np.uint8], polygons: list[FloatArray], hint: Hint, fine_step: int
) -> Found:
    """Search a picture (H, W, 3), markers in it being ground.

    Parameters
    ----------
    rgb, polygons, hint : as `find_silhouette` takes them
    fine_step : int
        By which the picture is reduced for the field.

    Raises
    ------
    NoObject
    Unsure
        It carries the candidates.
    UsageError
        There is no such candidate.
    """
    fine = reduced(rgb, fine_step)
    middling = reduced(fine, math.sqrt(fine[..., 0].size / _MIDDLING_PIXELS))
    small = reduced(middling, math.sqrt(middling[..., 0].size / _VIEW_PIXELS))
    step = rgb.shape[0] / small.shape[0]
    shape = small.shape[:2]
    outside = None if hint.box is None else outside_of(hint.box, shape, step)
    point = None if hint.point is None else scaled(hint.point, step)
    view = view_of(small, paint_mask(polygons, shape, step), outside, point)
    best, hand, doubt = _chosen(view, rgb, hint)
    mask = _finer(middling, best, polygons, rgb.shape[0] / middling.shape[0])
    field = edge_field(fine, mask, middling)
    if hint.box is not None:
        field[outside_of(hint.box, field.shape, fine_step)] = 0.0
    return Found(field, best.method, best.confidence, hand is not Hand.NONE, doubt)


def _finer(
    rgb: NDArray[np.uint8], best: Candidate, polygons: list[FloatArray], step: float
) -> BoolImage:
    """Find a candidate's outline again in a larger picture (H, W, 3)."""
    mask = resized(best.mask, rgb.shape[:2])
    if best.method == PLAIN:
        view = view_of(rgb, paint_mask(polygons, mask.shape, step))
        with contextlib.suppress(NoObject):
            stands = region_on_ground(view.lab, view.ground)
            if overlap(stands, mask) > _SAME:
                mask = stands
                if view.clean:
                    return mask
    elif mask.shape == best.mask.shape:
        return mask
    return polished(soft_lab(rgb), mask, _RING_SHARE)


def fit_of(rgb: NDArray[np.uint8], mask: BoolImage) -> float:
    """Say how clear a mask is that somebody else has made, 0 to 1."""
    small = reduced(rgb, max(1.0, math.sqrt(mask.size / _VIEW_PIXELS)))
    view = view_of(small, np.zeros(small.shape[:2], bool))
    return quality_of(view, resized(mask, small.shape)).clear


def _chosen(view: View, rgb: NDArray[np.uint8], hint: Hint) -> tuple[Candidate, Hand, str]:
    found = find_candidates(view)
    if hint.box is not None:
        filling = fitting(found, view.barred)
        if not filling:
            raise _unsure(found, rgb, "nothing in `box` fills it; draw it close round the object")
        found = filling
    elif hint.point is not None:
        found = round_point(found)
    all_, found = found, different(found)
    if hint.candidate is not None:
        if hint.candidate > min(len(found), _SHOWN):
            raise UsageError(f"`candidate` {hint.candidate}: only {len(found)} were found")
        return found[hint.candidate - 1], Hand.NONE, ""
    best = found[0]
    if hint.point is None:
        refuse_another(best, found)
    if best.confidence < BELIEVED:
        surer = max(
            (one for one in all_ if of_one_thing(best, one)), key=lambda one: one.confidence
        )
        best = surer if surer.confidence > _INSTEAD else best
    if best.confidence < BELIEVED:
        raise _unsure(
            found,
            rgb,
            "the object cannot be told from the ground for certain "
            f"({100 * best.confidence:.0f} %); take one of these with `candidate`, say where it is "
            "with `box`, `point` or `mask`, or photograph it on a plain ground of another colour",
        )
    hand = hand_at(view, best.mask)
    if hand is Hand.COVERS and hint.box is None and hint.point is None:
        raise _unsure(
            found,
            rgb,
            "a hand seems to hold the object and hide part of it; lay it down, or say with `box`, "
            "`point` or `mask` what to take",
        )
    return best, hand, doubt_of([best, *(one for one in all_ if one is not best)])


def _unsure(found: list[Candidate], rgb: NDArray[np.uint8], why: str) -> Unsure:
    shown = tuple(
        (resized(one.mask, rgb.shape[:2]), one.confidence, one.method) for one in found[:_SHOWN]
    )
    return Unsure(why, shown, rgb)
