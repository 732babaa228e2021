"""The order of the stages, from a picture to a design and its verdict."""

from __future__ import annotations

import html
import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import reduce

from formula.theta import Formula
from profiletool.files.formula import formula_for
from profiletool.joints.again import edited, plan_again
from profiletool.joints.closest import target_points
from profiletool.joints.optimal_method import optimal_plan
from profiletool.joints.paper_method import paper_plan
from profiletool.records.design import Design
from profiletool.records.edit import Edit
from profiletool.records.grip_request import GripRequest
from profiletool.records.making import check_request, request_again
from profiletool.records.picture import Scale
from profiletool.records.profile import Profile
from profiletool.records.request import Request
from profiletool.records.seal import sealed
from profiletool.records.way import WaysOut
from profiletool.subject.find import Subject, find_subject
from profiletool.verdict.around import with_neighbours
from profiletool.verdict.draft import Draft, attempt_of
from profiletool.verdict.holds import holding
from profiletool.verdict.missed import Missed
from profiletool.verdict.notes import notes_of
from profiletool.verdict.reasons import misses_of, reasons_of
from profiletool.verdict.summary import headline, summary
from profiletool.verdict.trials import Situation
from profiletool.verdict.ways import refused, ways_out
from profiletool.verify.check import Check, check
from profiletool.verify.errors import with_errors
from profiletool.verify.forward import FeForwardModel
from profiletool.verify.operate import in_contact
from profiletool.verify.run import Progress

_CHOSEN, _CORRECTED = 0.35, 0.85  # shares of the time that are gone once joints are so far
_LEFT = 0.85  # of a correction is left after each actuator that finite elements bent
_STABLE_SHARE = 0.94  # of the pressure at which FE loses its stability: 5 % more must stand


@dataclass(frozen=True, repr=False)
class Result(Draft):
    """A design with its verdict, and everything that it was made from; see `Draft`.

    Attributes
    ----------
    request : Request
    subject : Subject
    formula : Formula
    plan : Plan
    design : Design
    shape : Shape
        The tube as the formula bends it.
    check : Check or None
        The finite-element run; None where none was asked for.
    band : (2, M, 2) array or None
        Edges of the band about the object-facing line that holds 95 % of builds, mm.
    grip : Grip or None
        The finger on its object.
    reasons : tuple of str
        Why the design is infeasible; none where it is feasible.
    misses : tuple of Missed
        Stretches of the profile that the best known shape is far off.
    ways : WaysOut or None
        What trials of other options came to; None where the design is feasible.
    """

    reasons: tuple[str, ...]
    misses: tuple[Missed, ...]
    ways: WaysOut | None = None

    def __str__(self) -> str:
        """Joints, distances off the profile, verdict and notes."""
        return summary(self.design)

    def __repr__(self) -> str:
        """One line, as the arrays within would fill pages."""
        return f"<Result {headline(self.design)}>"

    def _repr_html_(self) -> str:
        """Text for a notebook's cell."""
        return f"<pre>{html.escape(str(self))}</pre>"


def _forward(request: Request, progress: Progress) -> FeForwardModel:
    """Give the forward model of a correction, which tells how far that is."""
    bent = itertools.count()

    def told() -> None:
        progress(_CORRECTED - (_CORRECTED - _CHOSEN) * _LEFT ** next(bent))

    return FeForwardModel(request.tube, request.model, told)


def _silent(share: float) -> None:
    del share


def run(request: Request, say: Callable[[str], None], progress: Progress | None = None) -> Result:
    """Design an actuator for a picture or a drawn profile.

    Parameters
    ----------
    request : Request
    say : callable
        Takes one line of progress at a time.
    progress : callable, optional
        Takes the share of all that is done, 0 to 1, about in proportion to the time.

    Returns
    -------
    Result
        Also where the design is infeasible or not verified, which it says.

    Raises
    ------
    ProfiletoolError
        Of the class whose exit code fits.
    """
    check_request(request)
    formula = formula_for(request)
    progress = progress or _silent
    progress(0.0)
    subject = find_subject(request, say)
    bend = _bend(say) if request.verify else None
    with refused(Situation(request, subject, formula, None), say, bend):
        attempt = _attempt(request, subject, formula, say, progress)
    lower = _lower(attempt)
    if lower is not None:
        say(f"once more below {lower.tube.max_pressure_bar:.2f} bar, where FE is stable")
        second = _attempt(lower, subject, formula, say, progress)
        attempt = second if second.design.verified else attempt
    result = _judged(with_neighbours(_with_errors(replace(attempt, request=request), say)))
    if not result.reasons:
        return result
    fit = result.design.fit
    reached = (fit.fe or fit.response or fit.formula).rms_mm
    ways = ways_out(Situation(request, subject, formula, reached), say, bend)
    first = len(result.reasons)
    notes = (*result.reasons, str(ways), *result.design.warnings[first:])
    return replace(result, ways=ways, design=sealed(replace(result.design, warnings=notes)))


def run_again(
    design: Design,
    profile: Profile,
    formula: Formula,
    say: Callable[[str], None],
    progress: Progress | None = None,
    *,
    edits: Sequence[Edit] = (),
    refine: bool = False,
    pressure_bar: float | None = None,
) -> Result:
    """Take a design up again: change or correct it where asked, verify it and judge it anew.

    Parameters
    ----------
    design : Design
        Its joints by their places; the rest follows from them.
    profile : Profile
    formula : Formula
        For the angles of the table.
    say, progress : callable
        As for `run`.
    edits : sequence of Edit
        Changes by hand, one after the other.
    refine : bool
        Whether finite elements correct the joints, in numbers that can be built.
    pressure_bar : float, optional
        That they are to work at, then.

    Raises
    ------
    ProfiletoolError
        Such as UsageError for a change that cannot be built, and UnreadableInput where a joint
        bends out of the plane.
    """
    design = reduce(edited, edits, design)
    request = request_again(design, profile, refine, pressure_bar)
    check_request(request)
    source = design.source
    subject = Subject(None, None, Scale(source.mm_per_px or 1.0, "vector"), None, profile)
    progress = progress or _silent
    progress(0.0)
    forward = _forward(request, progress) if refine else None
    plan = plan_again(design, request, profile, formula, say, forward)
    attempt = attempt_of(request, subject, formula, plan)
    attempt = replace(attempt, design=replace(attempt.design, source=source, method=design.method))
    checked = _verified(attempt.design, profile, say, progress)
    made = holding(replace(attempt, design=checked.design, check=checked))
    return _judged(_with_errors(made, say))


def _bend(say: Callable[[str], None]) -> Callable[[Request, Subject], Draft]:
    """Give what designs by finite elements for a trial of other options."""

    def bend(request: Request, subject: Subject) -> Draft:
        return _attempt(request, subject, formula_for(request), say, _silent)

    return bend


def _attempt(
    request: Request,
    subject: Subject,
    formula: Formula,
    say: Callable[[str], None],
    progress: Progress,
) -> Draft:
    profile = subject.profile
    if request.method == "optimal":
        forward = _forward(request, progress) if request.verify and request.refine else None
        plan = optimal_plan(request, profile, formula, say, forward, neighbours=True)
    else:
        plan = paper_plan(request, profile, formula, say)
    attempt = attempt_of(request, subject, formula, plan)
    if not request.verify:
        return attempt
    if plan.hopeless:
        say(plan.hopeless)
        return replace(attempt, plan=replace(plan, notes=(*plan.notes, plan.hopeless)))
    checked = _verified(attempt.design, profile, say, progress)
    return holding(replace(attempt, design=checked.design, check=checked))


def _lower(attempt: Draft) -> Request | None:
    """Ask for less pressure where FE loses its stability below what a refined plan works at."""
    request = attempt.request
    run = None if attempt.check is None else attempt.check.run
    found = None if run is None else run.verification
    ended = None if found is None else found.critical or found.ahead
    given = request.tube.pressure_bar is not None
    if ended is None or given or request.method != "optimal" or not request.refine:
        return None
    bar = _STABLE_SHARE * ended.pressure_bar
    return replace(request, tube=replace(request.tube, max_pressure_bar=bar))


def _verified(
    design: Design, profile: Profile, say: Callable[[str], None], progress: Progress
) -> Check:
    def share(reached_bar: float) -> None:
        progress(_CORRECTED + (1.0 - _CORRECTED) * reached_bar / design.pressure_bar)

    say(f"finite elements: the whole actuator to {design.pressure_bar:.2f} bar")
    return check(design, profile.points, share)


def _with_errors(attempt: Draft, say: Callable[[str], None]) -> Draft:
    """Add what errors of the build do to a verified design, free and against its object."""
    checked, design, request = attempt.check, attempt.design, attempt.request
    if checked is None or checked.run is None or checked.shape is None:
        return attempt
    points, build = target_points(attempt.profile), request.build
    expected = with_errors(design, checked.run, points, build)
    told = replace(attempt, design=expected.design, band=expected.band)
    if not request.grip or expected.fields is None:
        return told
    say("finite elements: the actuator against its object")
    asked = GripRequest(solid=request.solid, clearance_mm=request.clearance_mm)
    most = request.tube.max_pressure_bar
    held = in_contact(
        expected.design, checked.run.solution, attempt.profile.points, expected.fields,
        asked, most, request.grip_N,
    )  # fmt: skip
    return replace(told, design=held.design, grip=held.grip)


def _judged(attempt: Draft) -> Result:
    """Add the verdict: reasons against the design, notes for its user."""
    misses = misses_of(attempt)
    reasons = reasons_of(attempt, misses)
    notes = notes_of(attempt, reasons, misses)
    design = sealed(replace(attempt.design, feasible=not reasons, warnings=notes))
    return Result(**vars(replace(attempt, design=design)), reasons=reasons, misses=misses)
