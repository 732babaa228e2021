"""Changes of options that may lead out of an infeasible design, the least change first.

Every family changes one thing, by more and more. A rough search says how much of it is enough.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from formula.errors import OutOfRange
from formula.theta import Formula
from profiletool.errors import ProfiletoolError
from profiletool.joints.optimal.scout import scout
from profiletool.joints.optimal_method import model_of
from profiletool.joints.plan import GOOD_SHARE
from profiletool.records.making import changed_request
from profiletool.records.profile import Profile
from profiletool.records.request import Request
from profiletool.records.units import BAR_PER_MPA, FloatArray
from profiletool.subject.find import Subject, subject_again

Changes = Mapping[str, Any]

_CUT_PCT = (4, 8, 12, 16, 24, 32, 48)  # of the stretch, from one end or from either
_BOTH_PCT = (8, 16, 24)
_SLIMMER = ((0.8, 1.0), (0.6, 0.5), (0.5, 0.5))  # diameter and wall; pitch
_LEAST_DIAMETER_MM, _LEAST_WALL_MM = 8.0, 0.8  # that are made by hand
_ROOM_MM = 20.0  # of tube beyond the length of a profile
_MOST_LENGTH_MM = 500.0
_NEAR = 1.3  # times what will do, by a rough search: worth a choice of joints
_SIDE = 0.3  # what the other side counts among changes, which are shares of a number


@dataclass(frozen=True)
class Trial:
    """Options to change, by field name, and by how much that changes what was asked for."""

    changes: Changes
    much: float


@dataclass(frozen=True)
class Family:
    """Trials of one kind, by more and more.

    Attributes
    ----------
    what : str
        In words.
    trials : tuple of Trial
    """

    what: str
    trials: tuple[Trial, ...]


@dataclass(frozen=True)
class Situation:
    """What trials start from: the request that came to nothing, and what was found for it.

    Attributes
    ----------
    request : Request
    subject : Subject
    formula : Formula
    reached_mm : float or None
        RMS of the best attempt; None where there is none.
    """

    request: Request
    subject: Subject
    formula: Formula
    reached_mm: float | None

    def changed(self, changes: Changes) -> tuple[Request, Subject]:
        """Give the request with some changes, and its subject.

        Raises
        ------
        ProfiletoolError
        """
        request = changed_request(self.request, changes)
        return request, subject_again(self.subject, request)

    def promising(self, trial: Trial) -> bool:
        """Whether a rough search comes near the profile with a trial's changes."""
        try:
            request, subject = self.changed(trial.changes)
            rough = scout(subject.profile, model_of(request, self.formula), request.tube)
        except (ProfiletoolError, OutOfRange):
            return False
        return _of_count(rough, request.joints) <= _NEAR * limit_mm(request, subject.profile)


def limit_mm(request: Request, profile: Profile) -> float:
    """RMS of a shape that is called good."""
    return request.tolerance_mm or GOOD_SHARE * profile.length_mm


def _of_count(rms: FloatArray, count: int | None) -> float:
    return float(rms.min() if count is None else rms[min(count, len(rms)) - 1])


def alone(at: Situation) -> Iterator[Family]:
    """Families that change one thing."""
    request, spec = at.request, at.request.tube
    if request.method == "paper":
        yield Family("the optimal method", (Trial({"method": "optimal"}, 0.0),))
    if request.joints is not None:
        more = range(request.joints + 1, request.joints + 9)
        yield Family("more joints", _each("joints", request.joints, more))
        yield Family(
            "fewer joints", _each("joints", request.joints, range(request.joints - 1, 0, -1))
        )
    if request.tolerance_mm is not None and at.reached_mm is not None:
        enough = math.ceil(20.0 * at.reached_mm + 0.5) / 20.0
        much = min(enough / request.tolerance_mm - 1.0, 1.0)
        yield Family("what is reached as the tolerance", (Trial({"tolerance_mm": enough}, much),))
    length = math.ceil((at.subject.profile.length_mm + _ROOM_MM) / 10.0) * 10.0
    if spec.max_length_mm < length <= _MOST_LENGTH_MM:
        longer = _each("max_length_mm", spec.max_length_mm, [length])
        yield Family(f"a tube of up to {length:g} mm", longer)
    yield from stretches(at)
    yield from _others(at)


def _others(at: Situation) -> Iterator[Family]:
    request, spec = at.request, at.request.tube
    if at.subject.profile.outline is not None:
        other = "right" if request.side == "left" else "left"
        yield Family(f"the {other} side", (Trial({"side": other}, _SIDE),))
    yield slimmer(at)
    given, most_bar = spec.pressure_bar, spec.max_pressure_bar
    if given is not None:
        steps = [round(0.1 * k, 1) for k in range(1, 20)]
        higher = [p for p in (round(given + step, 2) for step in steps) if p <= most_bar]
        lower = [p for p in (round(given - step, 2) for step in steps) if p >= 0.5 * given]
        yield Family("higher pressures", _each("pressure_bar", given, higher))
        yield Family("lower pressures", _each("pressure_bar", given, lower))
        return
    most = math.floor(20.0 * BAR_PER_MPA * model_of(request, at.formula).pressure[1]) / 20.0
    if most > most_bar + 1e-6:
        yield Family(f"pressures up to {most:g} bar", _each("max_pressure_bar", most_bar, [most]))


def _each(field: str, now: float, values: Iterable[float]) -> tuple[Trial, ...]:
    return tuple(Trial({field: value}, abs(value / now - 1.0)) for value in values)


def stretches(at: Situation) -> Iterator[Family]:
    """Give stretches that begin later, or end sooner; a profile that is given has no others."""
    request = at.request
    if isinstance(request.given, Profile):
        return
    a, b = request.start_pct, request.end_pct
    cuts = [(round((b - a) * cut / 100.0), cut / 100.0) for cut in _CUT_PCT]
    yield Family(
        f"stretches from up to {_CUT_PCT[-1]} % later",
        tuple(Trial({"start_pct": round(a) + cut}, share) for cut, share in cuts),
    )
    yield Family(
        f"stretches to up to {_CUT_PCT[-1]} % sooner",
        tuple(Trial({"end_pct": round(b) - cut}, share) for cut, share in cuts),
    )


def slimmer(at: Situation) -> Family:
    """Give tubes that are slimmer, their wall and gauze with them."""
    spec, trials = at.request.tube, list[Trial]()
    if at.request.formula is not None:  # which holds for its own tube alone
        return Family("no other tube, for the formula is of this one", ())
    for factor, finer in _SLIMMER:
        diameter, wall = round(factor * spec.outer_diameter_mm), round(factor * spec.wall_mm, 1)
        changes: dict[str, Any] = {"outer_diameter_mm": diameter, "wall_mm": wall}
        if finer < 1.0:
            changes["pitch_mm"] = finer * spec.pitch_mm
        if diameter >= _LEAST_DIAMETER_MM and wall >= _LEAST_WALL_MM:
            trials.append(Trial(changes, 1.0 - factor))
    least = f"down to {trials[-1].changes['outer_diameter_mm']} mm" if trials else "none"
    return Family(f"tubes of {least}", tuple(trials))


def together(at: Situation) -> Iterator[Family]:
    """Families that change two things: both ends, or the stretch and the tube."""
    request, cuts = at.request, list(stretches(at))
    if not cuts:
        return
    width = request.end_pct - request.start_pct
    both = [(round(width * cut / 100.0), 2.0 * cut / 100.0) for cut in _BOTH_PCT]
    a, b = round(request.start_pct), round(request.end_pct)
    yield Family(
        "less of both ends",
        tuple(Trial({"start_pct": a + cut, "end_pct": b - cut}, much) for cut, much in both),
    )
    for slim in slimmer(at).trials[-1:]:
        for cut in cuts:
            pairs = (Trial({**t.changes, **slim.changes}, t.much + slim.much) for t in cut.trials)
            yield Family(f"{cut.what} with the slimmest tube", tuple(pairs))


def promising(at: Situation, family: Family) -> Family:
    """Leave out the trials of a family that a rough search finds too small.

    What a trial reaches, a larger one does too: so it halves the trials left, time and again. A
    family of which none is enough has none left.
    """
    low, high = 0, len(family.trials)
    while low < high:
        middle = (low + high) // 2
        if at.promising(family.trials[middle]):
            high = middle
        else:
            low = middle + 1
    return Family(family.what, family.trials[low:])
