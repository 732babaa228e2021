"""Candidates for the object, by several methods, all judged by the same measure."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from profiletool.errors import NoObject
from profiletool.image.find.ground import BoolImage
from profiletool.image.find.masks import overlap
from profiletool.image.find.mosaic import Mosaic, mosaic_of, polished
from profiletool.image.find.proposals import proposals, regions, within
from profiletool.image.find.quality import Quality, quality_of
from profiletool.image.find.region import SeveralAlike, region_on_ground
from profiletool.image.find.view import View

BELIEVED = 0.5  # a candidate of less confidence is nothing to design from
_SAME = 0.985  # overlap of regions that the polish makes one
_HOST = 0.06  # of the frame: a smaller region is nobody's ground
_ON_HOST = 0.7  # of its host: a larger region is the host itself


@dataclass(frozen=True)
class Candidate:
    """A mask of a view, (H, W), what found it, how good it is, and the chance that it is right."""

    mask: BoolImage
    method: str
    quality: Quality
    confidence: float


@dataclass(frozen=True)
class _Region:
    """A mask, what found it, and the mask that it lies on where that was looked into."""

    mask: BoolImage
    method: str
    host: BoolImage | None = None


def find_candidates(view: View) -> list[Candidate]:
    """Look for the object by every method.

    Returns
    -------
    list of Candidate
        The likeliest first.

    Raises
    ------
    NoObject
        No method found anything.
    """
    mosaic = mosaic_of(view.lab)
    found: list[_Region] = []
    missed: NoObject | None = None
    try:
        _add(found, "plain ground", region_on_ground(view.lab, view.ground, view.point))
    except NoObject as problem:
        missed = problem
        if isinstance(problem, SeveralAlike) and view.plain:
            raise
    for method, mask in proposals(view, mosaic):
        for region in regions(mask, view.point):
            _add(found, method, region)
    _look_into(view, mosaic, found)
    if not found:
        raise missed or NoObject("no object found in the picture")
    return _judged(view, [replace(one, mask=_polished(view, one.mask)) for one in found])


def judged(view: View, mask: BoolImage, method: str) -> Candidate:
    """Judge one region of a view by itself."""
    return _judged(view, [_Region(mask, method)])[0]


def _add(found: list[_Region], method: str, mask: BoolImage, host: BoolImage | None = None) -> None:
    if not any(overlap(mask, other.mask) > _SAME for other in found):
        found.append(_Region(mask, method, host))


def _look_into(view: View, mosaic: Mosaic, found: list[_Region]) -> None:
    """Add what lies on a sheet, a mat or a tray that was taken for the object."""
    for host in [one.mask for one in found if one.mask.mean() > _HOST]:
        for mask in within(view, mosaic, host):
            for region in regions(mask, view.point):
                if region.sum() < _ON_HOST * host.sum():
                    _add(found, "what lies on it", region, host)


def _polished(view: View, mask: BoolImage) -> BoolImage:
    drawn = polished(view.lab, mask) & ~view.barred
    return drawn if drawn.any() else mask


def _judged(view: View, found: Sequence[_Region]) -> list[Candidate]:
    made = []
    for one in found:
        others = [overlap(one.mask, o.mask) for o in found if o is not one]
        agreement = sum(others) / max(len(others), 1)
        quality = quality_of(view, one.mask, agreement, one.host)
        made.append(Candidate(one.mask, one.method, quality, quality.confidence))
    return sorted(made, key=lambda candidate: candidate.confidence, reverse=True)

