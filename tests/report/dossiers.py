"""Dossiers for the tests of the report: real designs, made-up finite elements."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any, cast

import numpy as np

from profiletool.bending.kinematics import Bend, deform
from profiletool.pipeline import Request, Result, run
from profiletool.records.design import Design, Misfit, Sensitivity
from profiletool.records.fe import CriticalPoint, FeState, Verification
from profiletool.records.seal import sealed
from profiletool.records.side import side_sign
from profiletool.report.dossier import Dossier, dossier_of
from profiletool.report.scene import scene_of
from profiletool.template.layout import build_sheet
from profiletool.template.svg import write_svg
from profiletool.verify.check import Check
from profiletool.verify.run import Run


def designed(file: Path, **asked: Any) -> Result:
    return run(Request(file, method="paper", **({"verify": False} | asked)), lambda line: None)


def unverified(result: Result) -> Dossier:
    return dossier_of(result, scene_of(result), _template(result.design))


def with_design(dossier: Dossier, design: Design) -> Dossier:
    """The same with another design, and its template."""
    scene = replace(dossier.scene, design=design)
    return replace(dossier, scene=scene, template_svg=_template(design))


def fe_state(design: Design, share: float) -> FeState:
    """As if every joint had bent by a share of what the formula says."""
    theta = [share * joint.sense * joint.theta_formula_deg for joint in design.joints]
    bends = [
        Bend(joint.centre_mm, joint.openF_mm, float(np.radians(angle)))
        for joint, angle in zip(design.joints, theta, strict=True)
    ]
    tube = design.tube
    shape = deform(
        bends, tube.length_mm, 0.5 * tube.outer_diameter_mm, design.base_pose,
        side_sign(design.source.side),
    )  # fmt: skip
    return FeState(
        share * design.pressure_bar, tuple(theta), shape, shape.axis[: len(theta) + 1],
        6.25 * share, tuple(1.0 + share * (k + 1) / 10.0 for k in range(len(theta))),
        1.0 + share, 1.0 - 0.1 * share, 0.25, 8.5, 1e-7, 1e-3, False,
    )  # fmt: skip


def made_up(design: Design, reached: float = 1.0) -> Verification:
    """As if finite elements had got to a share of the pressure."""
    shares = [k / 10.0 for k in range(1, 11) if k / 10.0 <= reached]
    bar = design.pressure_bar
    critical = None if reached == 1.0 else CriticalPoint("limit point", (reached + 0.04) * bar)
    states = tuple(fe_state(design, share) for share in shares)
    return Verification(fe_state(design, 0.0), states, bar, critical, 123, 4567, 8910, 31, 1.5)


def verified(dossier: Dossier) -> Dossier:
    """As if finite elements had bent the tube as the formula does."""
    design = dossier.scene.design
    found = made_up(design)
    joints = tuple(
        replace(joint, theta_fe_deg=joint.theta_formula_deg, stretch_fe=1.5)
        for joint in design.joints
    )
    made = replace(
        design,
        joints=joints,
        fit=replace(design.fit, fe=Misfit(0.234, 0.567)),
        verified=True,
        warnings=tuple(w for w in design.warnings if not w.startswith("NOT VERIFIED")),
        sensitivity=(
            Sensitivity("pressure 0.05 bar off", None, 1.2, 3.4),
            Sensitivity("one thread more or less uncut", 2, 5.6, 7.8),
        ),
    )
    design = sealed(made)
    dossier = with_design(dossier, design)
    scene = replace(dossier.scene, fe=found.last.shape)
    return replace(dossier, scene=scene, check=Check(design, _run(found), None))


def ended_early(dossier: Dossier, reached: float) -> Dossier:
    design = dossier.scene.design
    found = made_up(design, reached)
    assert found.critical is not None
    why = f"limit point at {found.critical.pressure_bar:.2f} bar"
    return replace(dossier, check=Check(design, _run(found), why))


def infeasible(dossier: Dossier, *reasons: str) -> Dossier:
    design = dossier.scene.design
    made = replace(design, feasible=False, warnings=(*reasons, *design.warnings))
    return replace(with_design(dossier, sealed(made)), reasons=reasons)


def with_joints(dossier: Dossier, count: int) -> Dossier:
    """The same tube with so many small joints, evenly along it."""
    design = dossier.scene.design
    step = design.tube.length_mm / (count + 1)
    joints = tuple(
        replace(
            design.joints[0], number=k + 1, F_mm=step, openF_mm=4.0, centre_mm=(k + 1) * step,
            alpha_center_deg=90.0 if k % 3 == 2 else 270.0,
        )
        for k in range(count)
    )  # fmt: skip
    places = np.linspace(0.0, dossier.scene.profile.length_mm, count)
    dossier = with_design(dossier, replace(design, joints=joints))
    scene = replace(dossier.scene, places=places)
    marks = [
        replace(mark, theta_deg=[joint.sense * joint.theta_formula_deg for joint in joints])
        for mark in dossier.marks
    ]
    return replace(dossier, scene=scene, marks=marks)


def _template(design: Design) -> str:
    return write_svg(build_sheet(design).drawing)


def _run(found: Verification) -> Run:
    return Run(found, cast(Any, None))  # the report asks nothing of the solution
