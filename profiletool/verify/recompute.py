"""Designs whose joints were changed by hand: what follows from them, computed anew."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from formula.theta import Formula, theta_deg
from profiletool.bending.kinematics import Bend, deform
from profiletool.joints.misfit import misfit_to
from profiletool.joints.threads import threads_of
from profiletool.joints.windows import best_seam
from profiletool.records.design import Design, Fit, FormulaRef
from profiletool.records.side import side_sign
from profiletool.records.units import FloatArray


def recomputed(design: Design, target: FloatArray, formula: Formula) -> Design:
    """Design with everything that follows from its joints computed anew, and not yet verified."""
    length = design.tube.length_mm
    ends = [*(joint.centre_mm for joint in design.joints[1:]), length]
    joints = tuple(
        replace(
            joint,
            F_mm=end - joint.centre_mm,
            theta_formula_deg=float(
                theta_deg(formula, joint.alpha_closed_deg, joint.openF_mm, design.pressure_bar)
            ),
            theta_fe_deg=None,
            theta_response_deg=None,
            stretch_fe=None,
        )
        for joint, end in zip(design.joints, ends, strict=True)
    )
    bends = [
        Bend(j.centre_mm, j.openF_mm, float(np.radians(j.sense * j.theta_formula_deg)))
        for j in joints
    ]
    radius, sign = 0.5 * design.tube.outer_diameter_mm, side_sign(design.source.side)
    shape = deform(bends, length, radius, design.base_pose, sign)
    changed = replace(
        design,
        tube=replace(design.tube, root_mm=joints[0].centre_mm),
        gauze=replace(design.gauze, seam_deg=best_seam(joints).seam_deg),
        formula=FormulaRef(formula.name, formula.sha256),
        joints=joints,
        fit=Fit(formula=misfit_to(shape, target), fe=None),
        verified=False,
        sensitivity=(),
        built=None,
        operate_bar=None,
        trim=(),
        threads_off_mm=None,
        neighbours=(),
    )
    return replace(changed, threads=threads_of(changed))
