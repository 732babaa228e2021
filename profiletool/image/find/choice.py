"""The choice between candidates, which takes more than asking which one looks best."""

from __future__ import annotations

import math
from collections.abc import Sequence

from profiletool.image.find.candidates import BELIEVED, Candidate
from profiletool.image.find.masks import overlap
from profiletool.image.find.region import ALIKE, SeveralAlike

_APART = 0.05  # overlap below which two masks are two things

# A part of an object, a bulb's cap or a print on a jug, has a better edge and purer colours than
# the whole. What tells the whole is that it is large, that several methods find it, and that no
# colours lie round it that are strange to the frame. Ranked on benchmarks/silhouettes.py.
_WEIGHTS = {"edge": 1.0, "peak": 1.0, "separation": -1.5, "ground": 3.0, "solidity": 1.5}
_BY_SIZE, _BY_AGREEMENT = 3.5, 3.0


def ranked(found: Sequence[Candidate], pointed: bool = False) -> list[Candidate]:
    """Put the candidate first that is most likely the whole object.

    Where it was pointed at, one that is believed comes before a larger one that is not.
    """

    def merit(candidate: Candidate) -> tuple[bool, float]:
        quality = candidate.quality
        looks = sum(weight * float(getattr(quality, name)) for name, weight in _WEIGHTS.items())
        others = [overlap(candidate.mask, o.mask) for o in found if o is not candidate]
        agreement = sum(others) / max(len(others), 1)
        whole = looks + _BY_SIZE * math.sqrt(quality.size) + _BY_AGREEMENT * agreement
        return pointed and candidate.confidence >= BELIEVED, whole

    return sorted(found, key=merit, reverse=True)


def refuse_another(best: Candidate, found: Sequence[Candidate]) -> None:
    """Refuse when another object is believed as much as the best candidate.

    Raises
    ------
    SeveralAlike
    """
    for other in found:
        as_large = ALIKE < other.quality.size / best.quality.size < 1.0 / ALIKE
        apart = overlap(best.mask, other.mask) < _APART
        if as_large and apart and other.confidence >= BELIEVED:
            raise SeveralAlike([best.mask, other.mask])
