"""The best paths of a search, polished: of so many joints, and those around the chosen one."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from profiletool.bending.model import Model
from profiletool.joints.expected import BUILT_WEIGHT
from profiletool.joints.misfit import score
from profiletool.joints.optimal.polish import Goal, Polished, polish
from profiletool.joints.optimal.search import SearchResult

RUNS, QUICK = 12, 4  # steps of a polish, and of one that only tells whether it is worth it
_LOWER = 0.9  # of the pressure: a neighbour's


def score_of(polished: Polished, goal: Goal) -> float:
    """Say what decides between polished actuators, mm: the shape, and what errors cost."""
    nominal = score(polished.misfit, polished.depth, goal.aim.interference_mm)
    return float(np.hypot(nominal, np.sqrt(BUILT_WEIGHT) * polished.errors))


def best_of(
    searches: list[SearchResult],
    model: Model,
    goal: Goal,
    joints: int,
    rivals: int,
    runs: int = RUNS,
) -> Polished:
    """Polish the best paths of so many joints, of all searches and pressures."""
    candidates = []
    for _, k, pressure in _starts(searches, goal, joints)[:rivals]:
        start = searches[k].posed_chain(pressure, joints, model, goal.profile, goal.limits)
        candidates.append(polish(start, model, goal, runs))
    return min(candidates, key=lambda polished: score_of(polished, goal))


def _starts(searches: list[SearchResult], goal: Goal, joints: int) -> list[tuple[float, int, int]]:
    """Costs of all paths of so many joints, the least first, with their search and pressure."""
    most = goal.limits.pressure[1] + 1e-9
    return sorted(
        (float(cost), k, p)
        for k, one in enumerate(searches)
        for p, cost in enumerate(one.cost[:, joints - 1])
        if np.isfinite(cost) and one.pressure[p] <= most
    )


def around(
    best: Polished, searches: list[SearchResult], model: Model, goal: Goal
) -> Iterator[tuple[str, Polished]]:
    """Polish the best path with one joint fewer, one more, and the chosen one at less pressure."""
    count, (low, _) = len(best.posed.chain.openF), goal.limits.pressure
    most = min(one.cost.shape[1] for one in searches)
    for what, joints in (("one joint fewer", count - 1), ("one joint more", count + 1)):
        if 1 <= joints <= most and _starts(searches, goal, joints):
            yield what, best_of(searches, model, goal, joints, rivals=1)
    pressure = _LOWER * best.posed.pressure
    if pressure > low:
        lower = replace(goal, limits=replace(goal.limits, pressure=(low, pressure)))
        yield "lower pressure", polish(replace(best.posed, pressure=pressure), model, lower)
