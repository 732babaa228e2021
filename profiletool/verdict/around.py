"""The neighbours of a chosen design: what one joint fewer, one more, or less pressure would give.

All are by the model that joints are chosen by. Where that says that less pressure will do, and
finite elements verified the design, they correct this neighbour too: its state lies near the
design's own, so that takes some seconds. Other numbers of joints would take the path from rest.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from profiletool.joints.again import on_mesh
from profiletool.joints.closest import closest_points, target_points
from profiletool.joints.correction.correct import CannotBend
from profiletool.joints.expected import Expected, error_sizes
from profiletool.joints.misfit import misfit
from profiletool.joints.optimal.polish import Polished
from profiletool.joints.optimal_method import correction
from profiletool.records.neighbour import Neighbour
from profiletool.records.units import BAR_PER_MPA
from profiletool.verdict.draft import Draft
from profiletool.verdict.trials import limit_mm
from profiletool.verify.forward import FeForwardModel
from profiletool.verify.run import Run

_DECIMALS = 4


def with_neighbours(attempt: Draft) -> Draft:
    """Add the neighbours to a design whose joints were chosen all at once."""
    around = tuple(_neighbours(attempt))
    return replace(attempt, design=replace(attempt.design, neighbours=around))


def _neighbours(attempt: Draft) -> Iterator[Neighbour]:
    choice = attempt.plan.choice
    run = attempt.check.run if attempt.check is not None and attempt.design.verified else None
    for what, polished in () if choice is None else choice.neighbours:
        found = _by_model(what, polished, attempt)
        near = found.rms_mm <= limit_mm(attempt.request, attempt.profile)
        if what == "lower pressure" and near and run is not None and attempt.request.refine:
            found = _by_fe(found, polished, attempt, run)
        yield found


def _by_model(what: str, polished: Polished, attempt: Draft) -> Neighbour:
    nominal, errors = polished.misfit.rms_mm, _errors_mm(polished, attempt)
    return Neighbour(
        what=what,
        joints=len(polished.posed.chain.openF),
        pressure_bar=round(BAR_PER_MPA * polished.posed.pressure, _DECIMALS),
        rms_mm=round(nominal, _DECIMALS),
        expected_rms_mm=_expected(nominal, errors),
        by="formula" if attempt.plan.by == "formula" else "joint response",
    )


def _by_fe(found: Neighbour, polished: Polished, attempt: Draft, run: Run) -> Neighbour:
    """Correct a neighbour by finite elements, from the design's own state; else leave it."""
    request, plan = on_mesh(attempt.request, attempt.design), attempt.plan
    assert plan.choice is not None
    assert plan.model is not None
    forward = FeForwardModel(request.tube, request.model, known=run.solution)
    low, _ = plan.choice.limits.pressure
    limits = replace(plan.choice.limits, pressure=(low, polished.posed.pressure))
    try:
        best = correction(
            request, forward, attempt.profile, plan.model, (polished.posed, limits),
            lambda line: None,
        ).best  # fmt: skip
    except CannotBend:
        return found
    nominal = misfit(best.shape, attempt.profile).rms_mm
    return replace(
        found,
        pressure_bar=round(BAR_PER_MPA * best.posed.pressure, _DECIMALS),
        rms_mm=round(nominal, _DECIMALS),
        expected_rms_mm=_expected(nominal, _errors_mm(polished, attempt)),
        by="FE",
    )


def _errors_mm(polished: Polished, attempt: Draft) -> float | None:
    """Give what a build's errors cost once the pressure is set; None for perfect parts."""
    request, profile, model = attempt.request, attempt.profile, attempt.plan.model
    sizes = error_sizes(request.build, request.tube)
    if request.objective == "nominal" or sizes is None or model is None:
        return None
    closest = closest_points(polished.shape.facing, target_points(profile), profile.sign)
    return Expected(model, sizes).trimmed_mm(polished.posed, polished.shape, closest)


def _expected(nominal: float, errors: float | None) -> float | None:
    return None if errors is None else round(float(np.hypot(nominal, errors)), _DECIMALS)
