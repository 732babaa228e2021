"""The way out of an infeasible design: other options, tried until one or two of them work.

A rough search tells what is worth trying; then joints are chosen as the command itself does. So
much is tried, whatever the time: the same input ends in the same words.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace

from profiletool.errors import Infeasible, ProfiletoolError
from profiletool.joints.optimal_method import optimal_plan
from profiletool.joints.paper_method import paper_plan
from profiletool.records.request import Request
from profiletool.records.rubber import breaking_stretch
from profiletool.records.way import Way, WaysOut
from profiletool.subject.find import Subject
from profiletool.verdict.draft import Draft, attempt_of
from profiletool.verdict.reasons import misses_of, reasons_of
from profiletool.verdict.trials import Family, Situation, Trial, alone, promising, together
from profiletool.verify.cautions import strained

_MOST_CHOICES = 4  # of joints until one works, by the model that they are chosen by
_MOST_WAYS = 2
_AFTER = 1  # choices that are left once one works
_MOST_BENT = 2  # ways that finite elements are asked about, each for as long as a design takes

Say = Callable[[str], None]
Bend = Callable[[Request, Subject], Draft]  # design and finite elements, as for any request


def ways_out(at: Situation, say: Say, bend: Bend | None) -> WaysOut:
    """Try other options, the least change first.

    Parameters
    ----------
    at : Situation
    say : callable
        Takes one line of progress at a time.
    bend : callable or None
        Designs by finite elements, with which the first way that works is checked; None for none.
    """
    say("no design within the limits: trying other options")
    tried: list[str] = []
    for families in (alone, together):
        ways = _worked(at, tuple(families(at)), say, bend)
        tried += [family.what for family in families(at) if family.trials]
        if ways:
            return WaysOut(ways, tuple(tried))
    return WaysOut((), tuple(tried))


@contextmanager
def refused(at: Situation, say: Say, bend: Bend | None) -> Iterator[None]:
    """Try other options where there is not even an attempt, and add them to the error.

    Raises
    ------
    Infeasible
    """
    try:
        yield
    except Infeasible as error:
        raise Infeasible(f"{error}; {ways_out(at, say, bend)}") from error


def _worked(
    at: Situation, families: tuple[Family, ...], say: Say, bend: Bend | None
) -> tuple[Way, ...]:
    """Choose joints for the least change that is left, time and again.

    A family is searched roughly once its least change is the least of all.
    """
    ways: list[Way] = []
    left, searched, choices = [f for f in families if f.trials], list[str](), _MOST_CHOICES
    asked = 0
    while left and choices and len(ways) < _MOST_WAYS:
        family = min(left, key=lambda one: one.trials[0].much)
        left.remove(family)
        if family.what not in searched:
            searched.append(family.what)
            rest = promising(at, family).trials
        else:
            choices -= 1
            by_fe = bend if not ways and asked < _MOST_BENT else None
            way = _way(at, family.trials[0], by_fe)
            asked += by_fe is not None
            if way is not None:
                say(str(way))
                ways.append(way)
                choices = min(choices, _AFTER)
                continue
            rest = family.trials[1:]
        if rest:
            left.append(replace(family, trials=rest))
    return tuple(ways)


def _way(at: Situation, trial: Trial, bend: Bend | None) -> Way | None:
    """Design with a trial's changes; None where that is infeasible too."""
    changes = tuple(trial.changes.items())
    try:
        request, subject = at.changed(trial.changes)
        draft = _planned(at, request, subject)
        if any(_wrong(draft)):
            return None
        fit = draft.design.fit.response or draft.design.fit.formula
        by = "the formula" if draft.plan.by == "formula" else "the joint response"
        if bend is None:
            return Way(changes, fit.rms_mm, f"{by} alone" if request.verify else by)
        draft = bend(request, subject)
    except ProfiletoolError:
        return None
    if not draft.design.verified or draft.design.fit.fe is None or any(_wrong(draft)):
        return None
    return Way(changes, draft.design.fit.fe.rms_mm, "FE")


def _planned(at: Situation, request: Request, subject: Subject) -> Draft:
    make = optimal_plan if request.method == "optimal" else paper_plan
    plan = make(request, subject.profile, at.formula, lambda line: None)
    return attempt_of(request, subject, at.formula, plan)


def _wrong(draft: Draft) -> Iterator[str]:
    """Say why a draft is no way out: it is infeasible, or its rubber would tear soon."""
    yield from reasons_of(draft, misses_of(draft))
    if draft.bent is not None:
        breaks = breaking_stretch(draft.request.tube.rubber)
        yield from (text for text in strained(draft.bent, breaks) if "breaks at" in text)
