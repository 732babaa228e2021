"""Notes on a design: what its user should know before building it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from formula.theta import Formula, beyond
from profiletool.bending.kinematics import deform
from profiletool.joints.layout import Layout
from profiletool.joints.misfit import depth_inside
from profiletool.joints.paper.assign import NEAR_DEG
from profiletool.joints.paper.sectors import BendingSector
from profiletool.joints.paper_method import PAPER_TOLERANCE_MM
from profiletool.joints.windows import best_seam, off_mesh
from profiletool.records.design import Design, Gauze, Joint, Misfit, named
from profiletool.records.fe import FeState
from profiletool.records.frames import Shape
from profiletool.records.profile import Profile
from profiletool.records.request import TubeSpec
from profiletool.records.rubber import breaking_stretch
from profiletool.subject.find import drawing_notes
from profiletool.template.mounted import mounted_of, mounting_warnings
from profiletool.verdict.draft import Draft
from profiletool.verdict.missed import Missed
from profiletool.verdict.model import model_notes
from profiletool.verify.cautions import strained, uncertain
from profiletool.verify.check import Check

_FORMULA_LOW_ABOVE_BAR = 1.2
_SLACK_SHARE = 0.1
_SHORT = 0.02  # of a force, that is close enough
_BULGES_ABOVE_BAR = 2.0
SLACK = 0.05  # mm or deg that nobody can see
DEPTH_MM = 1.0  # a tube that presses deeper into the object is warned of


def notes_of(attempt: Draft, reasons: Sequence[str], misses: Sequence[Missed]) -> tuple[str, ...]:
    """Everything that the user should know of a design, the reasons against it first."""
    design, request = attempt.design, attempt.request
    apart = (place.reason for place in misses if place.reason not in reasons)
    return (
        *reasons,
        *apart,
        *attempt.plan.notes,
        *drawing_notes(request, attempt.subject),
        *_method_notes(attempt),
        *extrapolated(design, attempt.formula),
        *disagreement(design.joints, design.pressure_bar),
        *shape_warnings(attempt.best_shape, attempt.profile, request.tolerance_mm or DEPTH_MM),
        *_gauze_notes(attempt.plan.layout, design.gauze),
        *_coarse(design),
        *_mounting_notes(attempt),
        *_fe_notes(attempt.check),
        *_grip_notes(attempt),
        *model_notes(design, request.method == "optimal" and request.refine),
    )


def warnings(
    layout: Layout,
    profile: Profile,
    fit: Misfit,
    tolerance_mm: float,
    spec: TubeSpec,
    formula: Formula,
    verified: bool,
) -> tuple[str, ...]:
    """Say what the user should know of a design that can be made.

    ``fit`` is that of FE where it has ``verified`` the design, else the formula's.
    """
    found = []
    if spec.max_pressure_bar > formula.pressure_range_bar[1]:
        found.append(
            f'formula "{formula.name}" ends at {formula.pressure_range_bar[1]:g} bar: '
            "no higher pressure was considered"
        )
    theirs = formula.name == "paper"
    if theirs and layout.pressure_bar > _FORMULA_LOW_ABOVE_BAR and not verified:
        found.append(
            f"formula (9) reads low above {_FORMULA_LOW_ABOVE_BAR:g} bar: expect the joints to "
            f"bend more than it says at {layout.pressure_bar:.2f} bar"
        )
    eager = [j for j in layout.joints if j.theta_formula_deg - j.theta_target_deg > NEAR_DEG]
    if eager:
        worst = max(j.theta_formula_deg - j.theta_target_deg for j in eager)
        found.append(
            f"{named(j.number for j in eager)} will bend up to {worst:.1f} deg more than wanted: "
            f"the look-up rounds up, and the table is coarse at {layout.pressure_bar:.2f} bar"
        )
    found += bridged(profile)
    if fit.max_mm > tolerance_mm:
        by = "by FE the bent shape lies" if verified else "the bent shape is predicted"
        found.append(
            f"{by} up to {fit.max_mm:.1f} mm off the profile "
            f"(RMS {fit.rms_mm:.1f} mm): the paper's method rounds angles up, takes lengths off "
            "the drawing and corrects neither"
        )
    return tuple(found)


def bridged(profile: Profile) -> Iterator[str]:
    """Say how much of the profile the tube spans without touching it."""
    share = 100.0 * float(np.mean(profile.bridged))
    if share >= 0.5:
        yield f"{share:.0f} % of the profile is bridged: grooves too tight to enter"


def extrapolated(design: Design, formula: Formula) -> Iterator[str]:
    """Say for which joints the formula is used beyond what it was fitted on."""
    out = [
        joint.number
        for joint in design.joints
        if beyond(formula, joint.alpha_closed_deg, joint.openF_mm, design.pressure_bar)
    ]
    if out:
        yield (
            f'formula "{formula.name}" was not fitted for {named(out)}: its angle there is '
            "extrapolated"
        )


def disagreement(joints: Sequence[Joint], pressure_bar: float) -> Iterator[str]:
    """Say where FE and the formula disagree, by more than the table's own coarseness."""
    for more, word in ((True, "more"), (False, "less")):
        off = {
            j.number: (1.0 if more else -1.0) * (j.theta_fe_deg - j.theta_formula_deg)
            for j in joints
            if j.theta_fe_deg is not None
        }
        apart = {number: by for number, by in off.items() if by > NEAR_DEG}
        if apart:
            verb = "bends" if len(apart) == 1 else "bend up to"
            yield (
                f"by FE {named(apart)} {verb} {max(apart.values()):.1f} deg {word} at "
                f"{pressure_bar:.2f} bar than the formula says: believe the FE"
            )


def polygon_warnings(
    sectors: Sequence[BendingSector], tolerance_mm: float, count: int | None
) -> Iterator[str]:
    """Say what is wrong with the polygon that was asked for."""
    off = max(sector.deviation_mm for sector in sectors)
    if count is not None and off > tolerance_mm:
        yield (
            f"with `joints` {count} the polygon is {off:.1f} mm off the profile, "
            f"beyond `tolerance_mm` {tolerance_mm:g}"
        )


def shape_warnings(shape: Shape, profile: Profile, depth_mm: float) -> Iterator[str]:
    """Say what is wrong with the bent shape; it may lie ``depth_mm`` deep in the object."""
    depth = depth_inside(shape, profile)
    if depth > depth_mm:
        yield f"the tube would press up to {depth:.1f} mm into the object"


def wear(state: FeState, design: Design) -> Iterator[str]:
    """Say what strains the tube at its operating pressure, by FE."""
    worst = max(design.joints, key=lambda joint: joint.stretch_fe or 0.0)
    breaks = breaking_stretch(design.tube.rubber)
    limit = "its data sheet tells where it breaks" if breaks is None else f"breaks at {breaks:g}"
    yield (
        f"the rubber is stretched most at joint {worst.number}: {worst.stretch_fe:.1f} times "
        f"({limit})"
    )
    yield from strained(state, breaks)
    if state.slack_share > _SLACK_SHARE:
        yield (
            f"axial threads are slack on {100.0 * state.slack_share:.0f} % of the wrapped surface: "
            "the gauze may wrinkle there"
        )
    if design.pressure_bar > _BULGES_ABOVE_BAR:
        yield f"bulges were seen above {_BULGES_ABOVE_BAR:.1f} bar on the paper's actuators"


def _method_notes(attempt: Draft) -> Iterator[str]:
    """Tell how the joints were chosen, where the user should know."""
    request, plan, design = attempt.request, attempt.plan, attempt.design
    if request.method == "paper":
        tolerance = request.tolerance_mm or PAPER_TOLERANCE_MM
        fit = design.fit.fe or design.fit.formula
        yield from warnings(
            plan.layout, attempt.profile, fit, tolerance, request.tube, attempt.formula,
            design.verified,
        )  # fmt: skip
        yield from polygon_warnings(plan.sectors, tolerance, request.joints)
    else:
        yield from bridged(attempt.profile)


def _fe_notes(checked: Check | None) -> Iterator[str]:
    """Say what came of the finite-element run."""
    if checked is None:
        yield "NOT VERIFIED: no finite-element run has checked this design"
    elif checked.failure is not None:
        yield f"NOT VERIFIED: finite elements: {checked.failure}"
    elif checked.run is not None:
        yield from wear(checked.run.verification.last, checked.design)
        yield from uncertain(checked.design.theta_uncertain)


def _grip_notes(attempt: Draft) -> Iterator[str]:
    """Say what a finger on its object does not reach."""
    grip, asked = attempt.grip, attempt.request.grip_N
    if grip is None:
        return
    if grip.failure is not None:
        yield f"against its object: {grip.failure}"
    bar = attempt.design.operate_bar
    if asked is None or bar is None:
        return
    found = grip.normal_at(bar)
    if found < asked * (1.0 - _SHORT):
        yield (
            f"one finger presses on its object with {found:.2f} N at {bar:.2f} bar, not with "
            f"{asked:g} N: raise `max_pressure_bar`, or take a wider tube"
        )


def _coarse(design: Design) -> Iterator[str]:
    """Say where a picture's pixels are larger than what the design claims to be off."""
    fit, k = design.fit.fe or design.fit.response or design.fit.formula, design.source.mm_per_px
    if k is not None and k > fit.rms_mm:
        yield (
            f"a pixel of the picture is {k:.2g} mm, more than the {fit.rms_mm:.2f} mm RMS that the "
            "shape is off: the outline itself is hardly known that well"
        )


def _mounting_notes(attempt: Draft) -> Iterator[str]:
    """Say what the mounting drawing warns of."""
    request, design, profile = attempt.request, attempt.design, attempt.profile
    tube = design.tube
    straight = deform(
        (), tube.length_mm, 0.5 * tube.outer_diameter_mm, design.base_pose, profile.sign
    )
    stretch = request.start_pct, request.end_pct
    return mounting_warnings(mounted_of(design, profile, straight, attempt.best_shape, stretch))


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
