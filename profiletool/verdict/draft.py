"""An attempt at a design: the plan, the design and its finite-element run."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from formula.theta import Formula
from profiletool.bending.kinematics import deform
from profiletool.joints.misfit import misfit
from profiletool.joints.plan import Plan
from profiletool.joints.threads import threads_of
from profiletool.joints.windows import best_seam
from profiletool.records.design import Design, Fit, FormulaRef, Gauze, Source, Tube
from profiletool.records.fe import FeState
from profiletool.records.frames import Shape
from profiletool.records.grip import Grip
from profiletool.records.grip_request import OnObject
from profiletool.records.profile import Profile
from profiletool.records.request import Request
from profiletool.records.units import FloatArray
from profiletool.subject.find import Subject, digest_of
from profiletool.verify.check import Check


@dataclass(frozen=True)
class Draft:
    """A design with everything that it was made from, to be judged.

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
        The finger on its object, by finite elements.
    """

    request: Request
    subject: Subject
    formula: Formula
    plan: Plan
    design: Design
    shape: Shape
    check: Check | None
    band: FloatArray | None
    grip: Grip | None

    @property
    def profile(self) -> Profile:
        """The target profile."""
        return self.subject.profile

    @property
    def bent(self) -> FeState | None:
        """The tube at its operating pressure; None where finite elements did not get there."""
        run = None if self.check is None else self.check.run
        return run.verification.last if run is not None and run.verification.converged else None

    @property
    def best_shape(self) -> Shape:
        """The tube as finite elements bend it, else as the joints were chosen by."""
        return self.plan.bent if self.bent is None else self.bent.shape


def attempt_of(request: Request, subject: Subject, formula: Formula, plan: Plan) -> Draft:
    """Make the design of a plan; finite elements and the verdict come later.

    Parameters
    ----------
    request : Request
    subject : Subject
    formula : Formula
        Bends the tube as the design's formula says, whatever the joints were chosen by.
    plan : Plan

    Returns
    -------
    Draft
        Not verified and without notes.
    """
    profile, layout = subject.profile, plan.layout
    radius = request.tube.radius_mm
    shape = deform(layout.bends(), layout.length_mm, radius, layout.pose, profile.sign)
    design = _design(request, subject, formula, plan, shape)
    return Draft(request, subject, formula, plan, design, shape, None, None, None)


def _design(
    request: Request, subject: Subject, formula: Formula, plan: Plan, shape: Shape
) -> Design:
    """Gather the design; whether it is feasible and what its user should know comes later."""
    spec, profile, layout = request.tube, subject.profile, plan.layout
    response = None if plan.by == "formula" else misfit(plan.bent, profile)
    seam = best_seam(layout.joints).seam_deg
    gauze = Gauze(spec.pitch_mm, spec.thread_mm, spec.turns, seam)
    design = Design(
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
            spec.outer_diameter_mm,
            spec.wall_mm,
            layout.root_mm,
            layout.length_mm,
            spec.rubber,
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
        model=request.model,
        clamp=spec.clamp,
        grip=OnObject(request.grip, request.grip_N, request.solid, request.clearance_mm),
    )
    return replace(design, threads=threads_of(design))
