"""The one place that knows the order of the stages, from a picture to a design."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from formula.errors import BadFormula, OutOfRange
from formula.theta import Formula, load_formula
from profiletool.errors import Infeasible, NoObject, UnreadableInput, UsageError
from profiletool.image.load import load_picture
from profiletool.image.marker import find_markers
from profiletool.image.scale import ScaleRequest, scale_of
from profiletool.image.silhouette import find_silhouette
from profiletool.joints.assign import Layout, joint_rules, lay_out, theta_table
from profiletool.joints.kinematics import deform, misfit
from profiletool.joints.limits import disagreement, named, shape_warnings, shortfalls, warnings
from profiletool.joints.sectors import Sector, discretise
from profiletool.profile.side import top_middle
from profiletool.profile.target import Reach, profile_of_line, profile_of_object
from profiletool.profile.vector import SUFFIXES, load_vector
from profiletool.records import (
    Design,
    Fit,
    FormulaRef,
    Gauze,
    Material,
    Picture,
    Profile,
    Scale,
    Shape,
    Side,
    Silhouette,
    Source,
    Tube,
)
from profiletool.template.unroll import best_seam, off_mesh
from profiletool.verify import Check, Progress, check

_WRONG_SCALE = {"height": {"top", "bottom"}, "width": {"left", "right"}}


@dataclass(frozen=True)
class Request:
    """What `design` was asked for."""

    file: Path
    scale: ScaleRequest = field(default_factory=ScaleRequest)
    side: Side = "left"
    start_pct: float = 0.0
    end_pct: float = 100.0
    clearance_mm: float = 0.0
    tolerance_mm: float = 1.0
    joints: int | None = None
    material: Material = field(default_factory=Material)
    formula: Path | None = None
    verify: bool = False


@dataclass(frozen=True)
class Subject:
    """The object that a design is for; picture, silhouette and origin only where there is one."""

    picture: Picture | None
    silhouette: Silhouette | None
    scale: Scale
    origin_px: tuple[float, float] | None
    profile: Profile


@dataclass(frozen=True)
class Result:
    """A design with what it was made from.

    ``reasons`` say why it is infeasible; none where it is feasible. ``shape`` is the tube as the
    formula bends it. ``check`` is its finite-element run; None where none was asked for.
    """

    design: Design
    reasons: tuple[str, ...]
    subject: Subject
    sectors: tuple[Sector, ...]
    layout: Layout
    shape: Shape
    check: Check | None


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
    _check(request)
    formula = read_formula(request.formula)
    subject = find_subject(request, say)
    profile, material = subject.profile, request.material
    try:
        table = theta_table(formula, material)
    except OutOfRange as error:
        raise UsageError(f"{error}; change --pitch, --max-pressure or --formula") from error
    rules = joint_rules(table, material, request.tolerance_mm)
    sectors = discretise(profile, rules, request.joints)
    if not sectors:
        raise NoObject(
            f"the profile is straight to {request.tolerance_mm:g} mm: there is nothing to bend; "
            "take another --side or stretch, or a smaller --tolerance"
        )
    try:
        layout = lay_out(profile, sectors, table, material)
    except OutOfRange as error:
        raise Infeasible(f"no pressure serves all joints: {error}") from error
    say(f"joints: {len(sectors)} at {layout.pressure_bar:.2f} bar")

    def place(s: float) -> str:
        share = request.start_pct + s / profile.length_mm * (request.end_pct - request.start_pct)
        return f"{s:.0f} mm down the profile ({share:.0f} % of the side)"

    reasons = shortfalls(sectors, layout, rules, material, formula, request.joints, place)
    shape = deform(layout.bends(), layout.length_mm, material.radius_mm, layout.pose, profile.sign)
    design = _design(request, subject, formula, layout, shape, reasons)
    checked = _verified(design, profile, say, progress) if request.verify else None
    if checked is not None:
        design = checked.design
    known = (checked.shape if checked is not None else None) or shape
    fit = design.fit.fe or design.fit.formula
    notes = [*reasons, *_drawing_notes(request, subject)]
    notes += warnings(
        layout, profile, fit, request.tolerance_mm, material, formula, design.verified
    )
    notes += disagreement(design.joints, design.pressure_bar)
    notes += shape_warnings(sectors, known, profile, request.tolerance_mm, request.joints)
    notes += _gauze_notes(layout, design.gauze)
    notes += _fe_notes(checked)
    design = replace(design, warnings=tuple(notes))
    return Result(design, reasons, subject, sectors, layout, shape, checked)


def read_formula(path: Path | None) -> Formula:
    """Read a formula file, or the paper's formula.

    Raises
    ------
    UnreadableInput
        When the file holds no formula.
    """
    try:
        return load_formula(path)
    except BadFormula as error:
        raise UnreadableInput(str(error)) from error


def find_subject(request: Request, say: Callable[[str], None]) -> Subject:
    """Read the picture or drawing and find the profile that the tube shall follow.

    Raises
    ------
    UnreadableInput, NoScale, NoObject, UsageError
    """
    reach = Reach(
        side=request.side,
        radius_mm=request.material.radius_mm,
        clearance_mm=request.clearance_mm,
        start_pct=request.start_pct,
        end_pct=request.end_pct,
    )
    if request.file.suffix.lower() in SUFFIXES:
        return _drawn_subject(request, reach, say)
    picture = load_picture(request.file)
    markers = find_markers(picture) if request.scale.marker_mm is not None else []
    silhouette = find_silhouette(picture, ignore=markers)
    scale = scale_of(picture, silhouette, request.scale)
    _check_frame(silhouette, scale, request.side)
    k = scale.mm_per_px
    origin = top_middle(silhouette.contour_px * [1.0, -1.0]) * [1.0, -1.0]
    outline = (silhouette.contour_px - origin) * [k, -k]
    width, height = np.ptp(outline, axis=0)
    say(
        f"object: {width:.1f} x {height:.1f} mm, found by {silhouette.method}, "
        f"{k:.4g} mm per pixel from {scale.source}"
    )
    reach = replace(reach, noise_mm=silhouette.noise_px * k, spacing_mm=k)
    profile = profile_of_object(outline, reach)
    return Subject(picture, silhouette, scale, (float(origin[0]), float(origin[1])), profile)


def _drawn_subject(request: Request, reach: Reach, say: Callable[[str], None]) -> Subject:
    drawn = load_vector(request.file)
    make = profile_of_object if drawn.closed else profile_of_line
    profile = make(drawn.points, reach)
    kind = "closed outline" if drawn.closed else "open profile"
    x, y = profile.points[0]
    say(f"drawing: {kind}, {profile.length_mm:.1f} mm to follow from ({x:.1f}, {y:.1f}) down")
    return Subject(None, None, Scale(1.0, "vector"), None, profile)


def _check(request: Request) -> None:
    """Refuse options that no design can be made with."""
    material = request.material
    positive = {
        "--diameter": material.outer_diameter_mm,
        "--wall": material.wall_mm,
        "--root": material.root_mm,
        "--pitch": material.pitch_mm,
        "--max-pressure": material.max_pressure_bar,
        "--max-length": material.max_length_mm,
        "--tolerance": request.tolerance_mm,
    }
    for option, value in positive.items():
        if not (np.isfinite(value) and value > 0.0):
            raise UsageError(f"{option} must be a number above 0, not {value:g}")
    if not (np.isfinite(request.clearance_mm) and request.clearance_mm >= 0.0):
        raise UsageError(f"--clearance must be 0 or more, not {request.clearance_mm:g}")
    if material.pitch_mm <= material.thread_mm:
        raise UsageError(f"--pitch must be more than the thread, {material.thread_mm:g} mm")
    if material.wall_mm >= material.radius_mm:
        raise UsageError("--wall must be less than half of --diameter")
    if not 0.0 <= request.start_pct < request.end_pct <= 100.0:
        raise UsageError("--from and --to must be percentages with --from below --to")


def _check_frame(silhouette: Silhouette, scale: Scale, side: Side) -> None:
    """Refuse an object that is cut off where it matters."""
    cut = silhouette.touches & ({side, "top"} | _WRONG_SCALE.get(scale.source, set()))
    if cut:
        raise NoObject(
            f"the object runs out of the frame ({', '.join(sorted(cut))}); "
            "take a picture with some ground all around it"
        )


def _design(
    request: Request,
    subject: Subject,
    formula: Formula,
    layout: Layout,
    shape: Shape,
    reasons: tuple[str, ...],
) -> Design:
    """Gather the design; what the user should know of it comes later."""
    material, profile = request.material, subject.profile
    fit = misfit(shape, profile)
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
        ),
        tube=Tube(material.outer_diameter_mm, material.wall_mm, layout.root_mm, layout.length_mm),
        gauze=gauze,
        formula=FormulaRef(formula.name, formula.sha256),
        pressure_bar=layout.pressure_bar,
        joints=layout.joints,
        base_pose=layout.pose,
        fit=Fit(formula=fit, fe=None),
        feasible=not reasons,
        verified=False,
        warnings=(),
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
    elif checked.run is not None and checked.run.verification.last.touches:
        yield "by FE the bent tube touches itself; the model lets it pass through"


def _drawing_notes(request: Request, subject: Subject) -> Iterator[str]:
    """Say what the user should know of how the picture was read."""
    if subject.silhouette is None:
        if request.scale != ScaleRequest():
            yield "a drawing is in mm already: the scale options were not used"
        return
    if subject.silhouette.method == "grabcut":
        yield "the silhouette is a guess on a busy ground: look at it in overlay.png"
    if subject.silhouette.touches:
        edges = ", ".join(sorted(subject.silhouette.touches))
        yield f"the object runs out of the frame ({edges}); the profile ends there"


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
