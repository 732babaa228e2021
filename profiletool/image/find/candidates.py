"""Candidates for the object, by several methods, all judged by the same measure."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from profiletool.errors import NoObject
from profiletool.image.find.ground import BoolImage, frame_of
from profiletool.image.find.masks import overlap
from profiletool.image.find.mosaic import Mosaic, cut, mosaic_of, polished
from profiletool.image.find.proposals import proposals, regions, within
from profiletool.image.find.quality import Quality, quality_of
from profiletool.image.find.region import SeveralAlike, region_on_ground
from profiletool.image.find.view import View

BELIEVED = 0.4  # a candidate of less confidence is nothing to design from
PLAIN, _DOUBTED = "plain ground", "plain ground, doubted"
_SAME = 0.97  # overlap of regions that the polish makes one
_HOST = 0.06  # of the frame: a smaller region is nobody's ground
SAME_POLISHED = 0.95
_MOSTLY, _SMALLER = 0.9, 0.85  # of a region: what lies in a larger one, and how much smaller it is
ANOTHER, FAR = 0.8, 3.0  # overlap below which two are not one thing, and a lead that is enough
_UNCLEAR, _CLEAR_SHEET = 0.05, 0.4  # how clear nothing is, and a sheet at least
_ON_HOST = 0.7  # of its host: a larger region is the host itself


@dataclass(frozen=True)
class Candidate:
    """A mask of a view, (H, W), what found it, how good it is, and the chance that it is right."""

    mask: BoolImage
    method: str
    quality: Quality

    @property
    def confidence(self) -> float:
        """Chance that the mask is right, 0 to 1."""
        return self.quality.confidence


@dataclass(frozen=True)
class _Region:
    """A mask, what found it, and the number of the region that it was found on."""

    mask: BoolImage
    method: str
    host: int | None = None


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
        _add(found, PLAIN, region_on_ground(view.lab, view.ground, view.point))
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
    return _judged(view, mosaic, _with_polished(view, found))


def _add(found: list[_Region], method: str, mask: BoolImage, host: int | None = None) -> None:
    if not any(overlap(mask, other.mask) > _SAME for other in found):
        found.append(_Region(mask, method, host))


def _look_into(view: View, mosaic: Mosaic, found: list[_Region]) -> None:
    """Add what lies on a sheet, a mat or a tray that was taken for the object."""
    for number, host in enumerate(found[:]):
        if host.mask.mean() < _HOST:
            continue
        for mask in within(view, mosaic, host.mask):
            for region in regions(mask, view.point):
                if region.sum() < _ON_HOST * host.mask.sum():
                    _add(found, "what lies on it", region, number)


def _with_polished(view: View, found: Sequence[_Region]) -> list[_Region]:
    """Draw every outline anew; one that comes out much different counts as it was, too."""
    drawn, kept = [], []
    for region in found:
        one = region
        mask = polished(view.lab, one.mask) & ~view.barred
        if one.method == PLAIN and overlap(mask, one.mask) < SAME_POLISHED:
            one = replace(one, method=_DOUBTED)
        elif one.method == PLAIN and view.plain:
            drawn.append(one)  # as fine as it gets
            continue
        drawn.append(replace(one, mask=mask if mask.any() else one.mask))
        if overlap(mask, one.mask) < SAME_POLISHED:
            kept.append(one)
    return drawn + kept


def _judged(view: View, mosaic: Mosaic, found: Sequence[_Region]) -> list[Candidate]:
    """Judge regions by themselves, then by each other; the best first."""
    ground = frame_of(view.barred.shape, 0.01) | view.barred
    made = []
    for one in found:
        home = None if one.host is None else found[one.host].mask
        regained = overlap(one.mask, cut(mosaic, one.mask, ground, rounds=1))
        made.append(replace(quality_of(view, one.mask, home), regained=regained))
    size = np.array([one.mask.sum() for one in found], float)
    common = np.array([[(one.mask & two.mask).sum() for two in found] for one in found], float)
    alike = common / (size[:, None] + size - common)
    beyond = (common > _MOSTLY * size[:, None]) & (size[:, None] < _SMALLER * size)
    stands = [k for k, one in enumerate(found) if one.method == PLAIN and view.plain]
    related = []
    for number, quality in enumerate(made):
        others = np.delete(alike[number], number)
        whole = [made[k].clear * (1.0 - made[k].four_cornered)
                 for k in np.flatnonzero(beyond[number])]  # fmt: skip
        host = found[number].host
        sheet_clear = 1.0 if host is None else min(1.0, made[host].clear / _CLEAR_SHEET)
        borne = [q.clear for one, q in zip(found, made, strict=True) if one.host == number]
        related.append(
            replace(
                quality,
                on_sheet=quality.on_sheet * sheet_clear,
                agreement=float(others.mean()) if len(others) else 1.0,
                within=min(1.0, max(whole, default=0.0) / max(quality.clear, _UNCLEAR)),
                plain=quality.edge if number in stands else 0.0,
                sheet=max(borne, default=0.0) * quality.four_cornered,
            )
        )
    merits = np.array([quality.merit for quality in related])
    candidates = []
    for number, (one, quality) in enumerate(zip(found, related, strict=True)):
        lead, fine = (
            min((*(merits[number] - merits[alike[number] < share]), FAR))
            for share in (ANOTHER, SAME_POLISHED)
        )
        ahead = replace(quality, lead=max(lead, -FAR), fine_lead=max(fine, -FAR))
        candidates.append(Candidate(one.mask, one.method, ahead))
    return sorted(candidates, key=lambda candidate: candidate.quality.merit, reverse=True)
