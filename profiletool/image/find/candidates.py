"""Candidates for the object, by several methods, all judged by the same measure."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from profiletool.errors import NoObject
from profiletool.image.find.judge import PLAIN, Candidate, Region, judged, outright
from profiletool.image.find.masks import overlap
from profiletool.image.find.mosaic import polished
from profiletool.image.find.proposals import maps_of, proposals, regions, within
from profiletool.image.find.region import SeveralAlike, region_on_ground
from profiletool.image.find.rough import Rough, rough_of
from profiletool.image.find.view import View

BELIEVED = 0.3  # a candidate of less confidence is nothing to design from
_DOUBTED = "plain ground, doubted"
_SAME = 0.94  # overlap of regions that the polish makes one
_MOST_FIND = 0.5  # of the methods that agree most
_HOST = 0.06  # of the frame: a smaller region is nobody's ground
_CHANGED = 0.95  # overlap below which the polish made another mask
_ON_HOST = 0.7  # of its host: a larger region is the host itself


def find_candidates(view: View) -> list[Candidate]:
    """Look for the object by every method, unless a clean ground shows it outright.

    Returns
    -------
    list of Candidate
        The likeliest first.

    Raises
    ------
    NoObject
        No method found anything.
    """
    votes: list[Region] = []
    missed: NoObject | None = None
    try:
        votes.append(Region(region_on_ground(view.lab, view.ground, view.point), PLAIN))
        if (clear := outright(view, votes[0])) is not None:
            return [clear]
    except NoObject as problem:
        missed = problem
        if isinstance(problem, SeveralAlike) and view.plain:
            raise
    rough = rough_of(view)
    for method, mask in proposals(view, rough, maps_of(view)):
        votes += [Region(region, method) for region in regions(mask, view.point)]
    if not votes:
        raise missed or NoObject("no object found in the picture")
    found = _unlike(votes + _agreed(view, rough, votes))
    found += _looked_into(view, found)
    return judged(view, votes, _with_polished(view, found))


def _unlike(regions_: Sequence[Region]) -> list[Region]:
    """Keep one of those that the polish makes one, and no more than are worth a look."""
    kept: list[Region] = []
    for one in regions_:
        if not any(overlap(one.mask, other.mask) > _SAME for other in kept):
            kept.append(one)
    return kept


def _agreed(view: View, rough: Rough, votes: Sequence[Region]) -> list[Region]:
    """Add what most methods find, and what its colours cut out."""
    share = np.mean([one.mask for one in votes], axis=0)
    guess = np.asarray(share > _MOST_FIND * share.max())
    masks = {"what most find": guess, "what most find, cut": rough.cut(guess)}
    return [
        Region(region, method)
        for method, mask in masks.items()
        for region in regions(mask, view.point)
    ]


def _looked_into(view: View, found: Sequence[Region]) -> list[Region]:
    """Find what lies on a sheet, a mat or a tray that was taken for the object."""
    inside: list[Region] = []
    for number, host in enumerate(found):
        if host.mask.mean() < _HOST:
            continue
        for mask in within(view, host.mask):
            for region in regions(mask, view.point):
                known = any(overlap(region, one.mask) > _SAME for one in (*found, *inside))
                if region.sum() < _ON_HOST * host.mask.sum() and not known:
                    inside.append(Region(region, "what lies on it", number))
    return inside


def _with_polished(view: View, found: Sequence[Region]) -> list[Region]:
    """Draw every outline anew; one that comes out much different counts as it was, too."""
    drawn, kept = [], []
    for region in found:
        one = region
        mask = polished(view.lab, one.mask) & ~view.barred
        if one.method == PLAIN and overlap(mask, one.mask) < _CHANGED:
            one = replace(one, method=_DOUBTED)
        elif one.method == PLAIN and view.plain:
            drawn.append(one)  # as fine as it gets
            continue
        drawn.append(replace(one, mask=mask if mask.any() else one.mask))
        if overlap(mask, one.mask) < _CHANGED:
            kept.append(one)
    return drawn + kept
