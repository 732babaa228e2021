"""Reasons why a design is infeasible."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from formula.theta import Formula
from profiletool.joints.layout import Layout
from profiletool.joints.optimal.choose import TOLERANCE_MM
from profiletool.joints.paper.pieces import Rules
from profiletool.joints.paper.sectors import BendingSector
from profiletool.joints.plan import GOOD_SHARE
from profiletool.records.design import Design, Misfit
from profiletool.records.profile import Profile
from profiletool.records.request import Request, TubeSpec
from profiletool.verdict.draft import Draft
from profiletool.verdict.holds import broken
from profiletool.verdict.missed import Missed, missed
from profiletool.verdict.notes import SLACK

WORST = 3.0  # times that: the farthest that any place of it may lie off
_SLACK_MM = 0.05  # that nobody can see


def reasons_of(attempt: Draft, misses: Sequence[Missed]) -> tuple[str, ...]:
    """Reasons why an attempt is infeasible; none where it is a design that can be built."""
    request, plan, profile = attempt.request, attempt.plan, attempt.profile
    if plan.rules is None:
        poor = not_good(attempt.design, profile, request, misses)
        return (*(poor or far_off(attempt.design, profile, request, misses)), *broken(attempt))
    place = placer(request, profile)
    short = shortfalls(
        plan.sectors, plan.layout, plan.rules, request.tube, attempt.formula,
        request.joints, place,
    )  # fmt: skip
    return (*short, *off_by_fe(attempt.design, profile, request), *broken(attempt))


def shortfalls(
    sectors: Sequence[BendingSector],
    layout: Layout,
    rules: Rules,
    spec: TubeSpec,
    formula: Formula,
    count: int | None,
    place: Callable[[float], str],
) -> tuple[str, ...]:
    """Reasons why a design is beyond the physical limits; none where it is within them.

    Where a number of joints was asked for (``count``), a polygon off the tolerance is what the
    user chose, not a limit. ``place`` says in words where an arc length on the profile is.
    """
    reasons = []
    tube = (spec.outer_diameter_mm, spec.wall_mm)
    if tube != (formula.outer_diameter_mm, formula.wall_mm):
        reasons.append(
            f'formula "{formula.name}" holds for a tube of {formula.outer_diameter_mm:g} mm with '
            f"a wall of {formula.wall_mm:g} mm, not {tube[0]:g} and {tube[1]:g} mm; "
            "give a formula for this tube with `formula`"
        )
    if count is not None and len(sectors) < count:
        reasons.append(f"there is no room for {count} joints on this profile, only {len(sectors)}")
    for number, sector in enumerate(sectors, start=1):
        found = [*_missing(sector, rules), *(_off(sector, rules) if count is None else ())]
        reasons += [f"joint {number}, {place(sector.centre)}: {what}" for what in found]
    if layout.length_mm > spec.max_length_mm + SLACK:
        reasons.append(
            f"the tube would be {layout.length_mm:.1f} mm long, more than "
            f"{spec.max_length_mm:g} mm; shorten `root_mm` or the stretch (`start_pct`, "
            "`end_pct`), or raise `max_length_mm`"
        )
    return tuple(reasons)


def _missing(sector: BendingSector, rules: Rules) -> Iterator[str]:
    """Say what one joint cannot do."""
    if sector.blocked:
        yield "there is nothing for it to bend; ask for fewer joints"
    if np.degrees(sector.excess_turn_rad) > SLACK:
        most = np.degrees(rules.theta_most_rad[np.searchsorted(rules.openF_mm, sector.openF_mm)])
        yield (
            f"a turn of {abs(np.degrees(sector.turn_rad)):.1f} deg is more than one joint reaches "
            f"({most:.1f} deg with openF {sector.openF_mm:g} mm at the highest pressure); leave "
            "such a corner out with `start_pct` or `end_pct`"
        )
    if sector.missing_mm > SLACK:
        yield (
            f"its cut of {sector.openF_mm:g} mm lacks {2.0 * sector.missing_mm:.1f} mm of room; "
            "the profile turns too fast here for this tube: leave it out with "
            "`start_pct` or `end_pct`"
        )


def _off(sector: BendingSector, rules: Rules) -> Iterator[str]:
    """Say where the polygon leaves the profile."""
    if sector.deviation_mm > rules.tolerance_mm:
        yield (
            f"the polygon is {sector.deviation_mm:.2f} mm off the profile, more than the "
            f"tolerance of {rules.tolerance_mm:g} mm; raise `tolerance_mm`, or leave this place "
            "out with `start_pct` or `end_pct`"
        )
    elif sector.inward_mm > rules.interference_mm:
        yield (
            f"the polygon runs {sector.inward_mm:.2f} mm into the object, more than "
            f"{rules.interference_mm:g} mm; give some `clearance_mm`, or leave this place out with "
            "`start_pct` or `end_pct`"
        )


def placer(request: Request, profile: Profile) -> Callable[[float], str]:
    """Say in words where an arc length on the profile is."""

    def place(s: float) -> str:
        share = request.start_pct + s / profile.length_mm * (request.end_pct - request.start_pct)
        return f"{s:.0f} mm down the profile ({share:.0f} % of the side)"

    return place


def misses_of(attempt: Draft) -> tuple[Missed, ...]:
    """Stretches of the profile that an optimal plan's bent shape misses, each with its cause."""
    plan, profile, request = attempt.plan, attempt.profile, attempt.request
    if plan.choice is None or plan.model is None:
        return ()
    bent = replace(plan.choice, shape=attempt.best_shape)
    return missed(profile, bent, plan.model, request.tube, TOLERANCE_MM, placer(request, profile))


def off_by_fe(design: Design, profile: Profile, request: Request) -> Iterator[str]:
    """Say that a polygon within its limits bends, by FE, to another shape than the profile's."""
    fit, limit = _judged(design, profile, request)
    if fit is design.fit.fe and (fit.rms_mm > limit or fit.max_mm > WORST * limit):
        yield (
            f"by FE the shape lies {fit.rms_mm:.2f} mm RMS and up to {fit.max_mm:.2f} mm off the "
            f"profile, more than {limit:.2f} and {WORST * limit:.2f} mm; "
            'take "optimal" as `method`'
        )


def not_good(
    design: Design, profile: Profile, request: Request, places: Sequence[Missed]
) -> tuple[str, ...]:
    """Give reasons why an optimal plan is no design; none where it is good enough."""
    fit, limit = _judged(design, profile, request)
    reasons = []
    longest = request.tube.max_length_mm
    if design.tube.length_mm > longest + _SLACK_MM:
        reasons.append(
            f"the tube would be {design.tube.length_mm:.1f} mm long, more than {longest:g} mm; "
            "shorten the stretch (`start_pct`, `end_pct`), or raise `max_length_mm`"
        )
    if fit.rms_mm > limit:
        reasons.append(
            f"the best shape found lies {fit.rms_mm:.2f} mm RMS and up to {fit.max_mm:.2f} mm off "
            f"the profile, more than {limit:.2f} mm RMS"
        )
        reasons += [place.reason for place in places]
    if request.joints is not None and len(design.joints) < request.joints:
        reasons.append(
            f"there is no room for {request.joints} joints on this profile, only "
            f"{len(design.joints)}"
        )
    return tuple(reasons)


def far_off(
    design: Design, profile: Profile, request: Request, places: Sequence[Missed]
) -> tuple[str, ...]:
    """Give reasons why an optimal plan that is good on the whole is not so at its worst place."""
    fit, limit = _judged(design, profile, request)
    if fit.max_mm <= WORST * limit:
        return ()
    said = (
        f"the best shape found lies up to {fit.max_mm:.2f} mm off the profile, more than "
        f"{WORST:g} times the {limit:.2f} mm of its RMS; raise `tolerance_mm`, or leave that place "
        "out with `start_pct` or `end_pct`"
    )
    return (said, *(place.reason for place in places))


def _judged(design: Design, profile: Profile, request: Request) -> tuple[Misfit, float]:
    """Give the misfit by the best model that was run, and the RMS of one that is good, mm."""
    fit = design.fit.fe or design.fit.response or design.fit.formula
    return fit, request.tolerance_mm or GOOD_SHARE * profile.length_mm
