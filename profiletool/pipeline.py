"""The one place that knows the order of the stages, from a picture to a design."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from formula.errors import BadFormula
from formula.files import load_formula
from formula.theta import Formula, widened
from profiletool.errors import UnreadableInput
from profiletool.joints.assign import Layout
from profiletool.joints.kinematics import deform, misfit
from profiletool.joints.limits import (
    bridged,
    disagreement,
    extrapolated,
    named,
    polygon_warnings,
    shape_warnings,
    warnings,
    wear,
)
from profiletool.joints.reach import Missed
from profiletool.plan import (
    PAPER_TOLERANCE_MM,
    Plan,
    misses,
    not_good,
    optimal_plan,
    paper_plan,
)
from profiletool.records import (
    Design,
    Fit,
    FormulaRef,
    Gauze,
    Profile,
    Shape,
    Source,
    Tube,
)
from profiletool.sensitivity import sensitivity_of
from profiletool.subject import Request, Subject, check_request, drawing_notes, find_subject
from profiletool.template.unroll import best_seam, off_mesh
from profiletool.verify import Check, Progress, check

_STABLE_SHARE = 0.97  # of the pressure at which FE loses its stability
DEPTH_MM = 1.0  # a tube that presses deeper into the object is warned of


@dataclass(frozen=True)
class Result:
    """A design with what it was made from, and what was asked for.

    ``reasons`` say why it is infeasible; none where it is feasible. ``shape`` is the tube as the
    formula bends it. ``check`` is its finite-element run; None where none was asked for.
    ``misses`` are the stretches of the profile that the shape is far off.
    """

    request: Request
    design: Design
    reasons: tuple[str, ...]
    subject: Subject
    plan: Plan
    shape: Shape
    check: Check | None
    misses: tuple[Missed, ...]


def run(request: Request, say: Callable[[str], None], progress: Progress | None = None) -> Result:
    """Design an actuator for a picture or a drawn profile.

    Parameters
    ----------
    request : Request
    say : callable
        Takes one line of progress at a time.
    progress : callable, optional
        Takes the share of the finite-element run that is done, 0 to 1.

    Raises
    ------
    ProfiletoolError
        Of the class whose exit code fits.
    """
    check_request(request)
    formula = read_formula(request.formula, request.extrapolate)
    subject = find_subject(request, say)
    profile = subject.profile
    attempt = _attempt(request, subject, formula, say, progress)
    lower = _lower(request, attempt)
    if lower is not None:
        say(f"once more below {lower.material.max_pressure_bar:.2f} bar, where FE is stable")
        second = _attempt(lower, subject, formula, say, progress)
        attempt = second if second.design.verified else attempt
    plan, shape, checked, design = attempt.plan, attempt.shape, attempt.check, attempt.design
    layout = plan.layout
    known = (checked.shape if checked is not None else None) or plan.bent
    places = misses(plan, known, profile, request)
    reasons = plan.reasons
    if request.method == "optimal":
        reasons = (*reasons, *not_good(design, profile, request, places))
    apart = [place.reason for place in places if place.reason not in reasons]
    notes = [*reasons, *apart, *plan.notes, *drawing_notes(request, subject)]
    notes += _method_notes(request, plan, design, profile, formula)
    notes += extrapolated(design, formula)
    notes += disagreement(design.joints, design.pressure_bar)
    notes += shape_warnings(known, profile, request.tolerance_mm or DEPTH_MM)
    notes += _gauze_notes(layout, design.gauze)
    notes += _fe_notes(checked)
    if checked is not None and checked.run is not None and checked.shape is not None:
        design = replace(design, sensitivity=sensitivity_of(design, checked.run, profile))
    design = replace(design, feasible=not reasons, warnings=tuple(notes))
    return Result(request, design, reasons, subject, plan, shape, checked, places)


@dataclass(frozen=True)
class _Attempt:
    """A plan with its design, the formula's shape of it, and its finite-element run."""

    plan: Plan
    design: Design
    shape: Shape
    check: Check | None


def _attempt(
    request: Request,
    subject: Subject,
    formula: Formula,
    say: Callable[[str], None],
    progress: Progress | None,
) -> _Attempt:
    profile, material = subject.profile, request.material
    make = optimal_plan if request.method == "optimal" else paper_plan
    plan = make(request, profile, formula, say)
    layout = plan.layout
    shape = deform(layout.bends(), layout.length_mm, material.radius_mm, layout.pose, profile.sign)
    design = _design(request, subject, formula, plan, shape)
    if not request.verify:
        return _Attempt(plan, design, shape, None)
    checked = _verified(design, profile, say, progress)
    return _Attempt(plan, checked.design, shape, checked)


def _lower(request: Request, attempt: _Attempt) -> Request | None:
    """Ask for less pressure where FE loses its stability below what a refined plan works at."""
    run = None if attempt.check is None else attempt.check.run
    ended = None if run is None else run.verification.critical
    if ended is None or request.method != "optimal" or not request.refine:
        return None
    bar = _STABLE_SHARE * ended.pressure_bar
    return replace(request, material=replace(request.material, max_pressure_bar=bar))


def _method_notes(
    request: Request, plan: Plan, design: Design, profile: Profile, formula: Formula
) -> Iterator[str]:
    """Say what the user should know of how the joints were chosen."""
    if request.method == "paper":
        tolerance = request.tolerance_mm or PAPER_TOLERANCE_MM
        fit = design.fit.fe or design.fit.formula
        yield from warnings(
            plan.layout, profile, fit, tolerance, request.material, formula, design.verified
        )
        yield from polygon_warnings(plan.sectors, tolerance, request.joints)
    else:
        yield from bridged(profile)


def read_formula(path: Path | None, extrapolate: bool = False) -> Formula:
    """Read a formula file, or the paper's formula; let it be extrapolated or not.

    Raises
    ------
    UnreadableInput
        When the file holds no formula.
    """
    try:
        formula = load_formula(path)
    except BadFormula as error:
        raise UnreadableInput(str(error)) from error
    return widened(formula) if extrapolate else formula


def _design(
    request: Request, subject: Subject, formula: Formula, plan: Plan, shape: Shape
) -> Design:
    """Gather the design; what the user should know of it comes later."""
    material, profile, layout = request.material, subject.profile, plan.layout
    response = None if plan.by == "formula" else misfit(plan.bent, profile)
    seam = best_seam(layout.joints).seam_deg
    gauze = Gauze(material.pitch_mm, material.thread_mm, material.turns, seam)
    return Design(
        source=Source(
            file=request.file.name,
            sha256=hashlib.sha256(request.file.read_bytes()).hexdigest(),
            mm_per_px=subject.scale.mm_per_px if subject.picture is not None else None,
            scale_source=subject.scale.source,
            side=request.side,
            profile_length_mm=profile.length_mm,
            bridged_share=float(np.mean(profile.bridged)),
            origin_px=subject.origin_px,
            rotated_deg=subject.rotated_deg,
            symmetric=request.look.symmetric,
            scale_error_share=subject.scale.measured_error,
            confidence=None if subject.silhouette is None else subject.silhouette.confidence,
        ),
        tube=Tube(
            material.outer_diameter_mm,
            material.wall_mm,
            layout.root_mm,
            layout.length_mm,
            material.rubber,
        ),
        gauze=gauze,
        formula=FormulaRef(formula.name, formula.sha256),
        pressure_bar=layout.pressure_bar,
        joints=layout.joints,
        base_pose=layout.pose,
        fit=Fit(formula=misfit(shape, profile), fe=None, response=response),
        feasible=not plan.reasons,
        verified=False,
        warnings=(),
        method=request.method,
    )


def _verified(
    design: Design, profile: Profile, say: Callable[[str], None], progress: Progress | None
) -> Check:
    def share(reached_bar: float) -> None:
        if progress is not None:
            progress(reached_bar / design.pressure_bar)

    say(f"finite elements: the whole actuator to {design.pressure_bar:.2f} bar")
    return check(design, profile, share)


def _fe_notes(checked: Check | None) -> Iterator[str]:
    """Say what came of the finite-element run."""
    if checked is None:
        yield "NOT VERIFIED: no finite-element run has checked this design"
    elif checked.failure is not None:
        yield f"NOT VERIFIED: finite elements: {checked.failure}"
    elif checked.run is not None:
        yield from wear(checked.run.verification.last, checked.design)


def _gauze_notes(layout: Layout, gauze: Gauze) -> Iterator[str]:
    """Say what the user should know when cutting the gauze."""
    seam = best_seam(layout.joints)
    for numbers, what in (
        (seam.crossed, "the weld line crosses the cuts of {}: weld again there"),
        (
            off_mesh(layout.joints, gauze),
            "the cuts of {} lie off the mesh of the others: cut in the nearest meshes",
        ),
    ):
        if numbers:
            yield what.format(named(numbers))
