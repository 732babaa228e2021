"""Judgement of regions: by themselves, by what finds them, and by each other."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from profiletool.image.find.ground import BoolImage, frame_of
from profiletool.image.find.masks import edges_touched, overlap
from profiletool.image.find.mosaic import cut, mosaic_of
from profiletool.image.find.quality import Quality, quality_of
from profiletool.image.find.view import View
from profiletool.records.units import FloatArray

PLAIN, LEARNED = "plain ground", "learned"
_SAME = 0.9  # overlap from which on two have one outline
_CORNERED, _FIRM = 0.5, 0.9  # four corners may be a sheet; share of a firm edge that is enough
_MOSTLY, _SMALLER = 0.9, 0.7  # of a region: what lies in a larger one, and how much smaller it is
_UNCLEAR, _CLEAR = 0.05, 0.35  # how clear nothing is, and a sheet or what lies on it


@dataclass(frozen=True)
class Region:
    """A mask, what found it, and the number of the region that it was found on."""

    mask: BoolImage
    method: str
    host: int | None = None


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


def outright(view: View, region: Region) -> Candidate | None:
    """Judge the one thing on a clean ground; None for a sheet or one without a firm edge."""
    if not view.clean or view.told:
        return None
    quality = quality_of(view, region.mask)
    thing = len(edges_touched(region.mask)) <= 1 and quality.four_cornered < _CORNERED
    return Candidate(region.mask, PLAIN, quality) if thing and quality.edge > _FIRM else None


def judged(view: View, votes: Sequence[Region], found: Sequence[Region]) -> list[Candidate]:
    """Judge what was found in a view.

    Parameters
    ----------
    view : View
    votes : sequence of Region
        What each method found.
    found : sequence of Region

    Returns
    -------
    list of Candidate
        The likeliest first.
    """
    made = _found_by(_by_themselves(view, found), votes, found)
    size = np.array([one.mask.sum() for one in found], float)
    common = np.array([[(one.mask & two.mask).sum() for two in found] for one in found], float)
    alike = common / (size[:, None] + size - common)
    around = (common > _MOSTLY * size[:, None]) & (size[:, None] < _SMALLER * size)
    made = _on_each_other(view, found, made, around)
    merits = np.array([quality.merit for quality in made])
    candidates = [
        Candidate(one.mask, one.method, ahead(quality, merits[number] - merits, alike[number]))
        for number, (one, quality) in enumerate(zip(found, made, strict=True))
    ]
    return sorted(candidates, key=lambda candidate: candidate.quality.merit, reverse=True)


def ahead(quality: Quality, gains: FloatArray, alike: FloatArray) -> Quality:
    """Tell a quality its share of belief: leads on all, (N,), and overlaps with them, (N,)."""
    belief = np.exp(-gains - np.max(-gains))
    return replace(quality, share=float(belief[alike > _SAME].sum() / belief.sum()))


def _by_themselves(view: View, found: Sequence[Region]) -> list[Quality]:
    mosaic = mosaic_of(view.lab)
    ground = frame_of(view.barred.shape, 0.01) | view.barred
    made = []
    for one in found:
        home = None if one.host is None else found[one.host].mask
        regained = overlap(one.mask, cut(mosaic, one.mask, ground, rounds=1))
        made.append(replace(quality_of(view, one.mask, home), regained=regained))
    return made


def _found_by(
    made: Sequence[Quality], votes: Sequence[Region], found: Sequence[Region]
) -> list[Quality]:
    """Count the methods that find much the same, and look up what the learned one says."""
    cast = np.stack([one.mask.ravel() for one in votes]).astype(np.float32)
    learned = [number for number, one in enumerate(votes) if one.method == LEARNED]
    told = []
    for one, quality in zip(found, made, strict=True):
        common = cast @ one.mask.ravel().astype(np.float32)
        alike = common / (cast.sum(axis=1) + float(one.mask.sum()) - common)
        told.append(
            replace(
                quality,
                drawn_by=float((alike > _SAME).mean()),
                agreement=float(alike.mean()),
                learned=max((float(alike[number]) for number in learned), default=1.0),
            )
        )
    return told


def _on_each_other(
    view: View, found: Sequence[Region], made: Sequence[Quality], around: BoolImage
) -> list[Quality]:
    """Tell sheets from what lies on them, and a whole from its parts.

    ``around`` (N, N) says of each whether another lies round it.
    """
    told = []
    for number, quality in enumerate(made):
        round_it = [one for one, holds in zip(made, around[number], strict=True) if holds]
        in_it = [one for one, held in zip(made, around[:, number], strict=True) if held]
        sheets = [one.four_cornered * min(1.0, one.clear / _CLEAR) for one in round_it]
        wholes = [one.clear * (1.0 - one.four_cornered) for one in round_it]
        # A point means the innermost region round it: to be a part is no fault there.
        whole = 0.0 if view.point is not None else max(wholes, default=0.0)
        borne = [min(1.0, one.clear / _CLEAR) for one in in_it]
        stands = found[number].method == PLAIN and view.plain
        told.append(
            replace(
                quality,
                on_sheet=max(sheets, default=0.0),
                within=min(1.0, whole / max(quality.clear, _UNCLEAR)),
                sheet=max(borne, default=0.0) * quality.four_cornered,
                plain=quality.edge if stands else 0.0,
            )
        )
    return told
