"""The one place that knows the order of the stages, from a picture to a design."""

from __future__ import annotations

import html
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from formula.theta import Formula
from profiletool.bending.kinematics import deform
from profiletool.files.formula import read_formula
from profiletool.joints.misfit import misfit
from profiletool.joints.optimal_method import optimal_plan
from profiletool.joints.paper_method import paper_plan
from profiletool.joints.plan import Plan
from profiletool.joints.windows import best_seam
from profiletool.records.design import Design, Fit, FormulaRef, Gauze, Source, Tube
from profiletool.records.frames import Shape
from profiletool.records.making import check_request
from profiletool.records.profile import Profile
from profiletool.records.request import Request
from profiletool.subject.find import Subject, digest_of, find_subject
from profiletool.verdict.attempt import Attempt
from profiletool.verdict.missed import Missed
from profiletool.verdict.notes import notes_of
from profiletool.verdict.reasons import misses_of, reasons_of
from profiletool.verdict.summary import headline, summary
from profiletool.verify.bench import FeBench
from profiletool.verify.check import Check, check
from profiletool.verify.run import Progress
from profiletool.verify.sensitivity import sensitivity_of

_STABLE_SHARE = 0.97  # of the pressure at which FE loses its stability


@dataclass(frozen=True, repr=False)
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

    def __str__(self) -> str:
        """Joints, distances off the profile, verdict and notes."""
        return summary(self.design)

    def __repr__(self) -> str:
        """One line, as the arrays within would fill pages."""
        return f"<Result {headline(self.design)}>"

    def _repr_html_(self) -> str:
        """Text for a notebook's cell."""
        return f"<pre>{html.escape(str(self))}</pre>"


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
    attempt = _attempt(request, subject, formula, say, progress)
    lower = _lower(attempt)
    if lower is not None:
        say(f"once more below {lower.tube.max_pressure_bar:.2f} bar, where FE is stable")
        second = _attempt(lower, subject, formula, say, progress)
        attempt = second if second.design.verified else attempt
    attempt = replace(attempt, request=request)
    misses = misses_of(attempt)
    reasons = reasons_of(attempt, misses)
    design = replace(
        attempt.design, feasible=not reasons, warnings=notes_of(attempt, reasons, misses)
    )
    checked = attempt.check
    if checked is not None and checked.run is not None and checked.shape is not None:
        sensitivity = sensitivity_of(design, checked.run, subject.profile)
        design = replace(design, sensitivity=sensitivity)
    return Result(request, design, reasons, subject, attempt.plan, attempt.shape, checked, misses)


def _attempt(
    request: Request,
    subject: Subject,
    formula: Formula,
    say: Callable[[str], None],
    progress: Progress | None,
) -> Attempt:
    profile, material = subject.profile, request.tube
    if request.method == "optimal":
        bench = FeBench(material) if request.verify and request.refine else None
        plan = optimal_plan(request, profile, formula, say, bench)
    else:
        plan = paper_plan(request, profile, formula, say)
    layout = plan.layout
    shape = deform(layout.bends(), layout.length_mm, material.radius_mm, layout.pose, profile.sign)
    design = _design(request, subject, formula, plan, shape)
    attempt = Attempt(request, subject, formula, plan, design, shape, None)
    if not request.verify:
        return attempt
    checked = _verified(design, profile, say, progress)
    return replace(attempt, design=checked.design, check=checked)


def _lower(attempt: Attempt) -> Request | None:
    """Ask for less pressure where FE loses its stability below what a refined plan works at."""
    request = attempt.request
    run = None if attempt.check is None else attempt.check.run
    ended = None if run is None else run.verification.critical
    if ended is None or request.method != "optimal" or not request.refine:
        return None
    bar = _STABLE_SHARE * ended.pressure_bar
    return replace(request, tube=replace(request.tube, max_pressure_bar=bar))


def _design(
    request: Request, subject: Subject, formula: Formula, plan: Plan, shape: Shape
) -> Design:
    """Gather the design; what the user should know of it comes later."""
    material, profile, layout = request.tube, subject.profile, plan.layout
    response = None if plan.by == "formula" else misfit(plan.bent, profile)
    seam = best_seam(layout.joints).seam_deg
    gauze = Gauze(material.pitch_mm, material.thread_mm, material.turns, seam)
    return Design(
        source=Source(
            file=request.file.name,
            sha256=digest_of(request),
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
        feasible=True,  # until the verdict
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
    return check(design, profile.points, share)
