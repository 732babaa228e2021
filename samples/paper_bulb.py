"""Write paper_bulb.json: the bulb actuator of the paper's Table 5 as a design of ours.

Where the paper leaves something open: the tube ends 4 mm beyond the last F, and the base lies on
the crown of the sample bulb so that joint 1 sits over the middle of the first 30 deg.
"""

from __future__ import annotations

import csv
import hashlib
from pathlib import Path

import numpy as np

from formula.files import load_formula
from formula.theta import theta_deg
from profiletool.bending.kinematics import deform
from profiletool.files.design_json import to_json
from profiletool.joints.misfit import misfit
from profiletool.joints.paper.assign import Layout
from profiletool.joints.windows import best_seam
from profiletool.profile.target import Reach, profile_of_object
from profiletool.records.design import Design, Fit, FormulaRef, Gauze, Joint, Source, Tube
from profiletool.records.frames import Pose

HERE = Path(__file__).parent
ROOT_MM, END_MM, PRESSURE_BAR, SPHERE_MM = 10.0, 4.0, 1.90, 30.0
# Table 5: F, openF, alpha_closed, alpha_center, theta.
TABLE_5 = (
    (19, 8, 132, 270, 30),
    (19, 8, 132, 270, 30),
    (19, 8, 132, 270, 30),
    (12, 8, 144, 270, 25),
    (12, 6, 144, 270, 20),
    (8, 10, 108, 90, 45),
)


def paper_bulb() -> Design:
    """Build the design of Table 5, measured against the sample bulb's true outline."""
    formula = load_formula()
    F = [float(row[0]) for row in TABLE_5]
    centres = ROOT_MM + np.concatenate([[0.0], np.cumsum(F)])
    joints = tuple(
        Joint(
            number=k + 1,
            F_mm=F[k],
            openF_mm=float(openF),
            alpha_closed_deg=float(alpha),
            alpha_center_deg=float(center),
            theta_target_deg=float(theta),
            theta_formula_deg=float(theta_deg(formula, alpha, openF, PRESSURE_BAR)),
            theta_fe_deg=None,
            centre_mm=float(centres[k]),
        )
        for k, (_, openF, alpha, center, theta) in enumerate(TABLE_5)
    )
    lead = SPHERE_MM * np.tan(np.radians(15.0))
    pose = Pose(float(ROOT_MM - lead), 0.0, 180.0)
    length = float(centres[-1]) + END_MM
    layout = Layout(joints, ROOT_MM, length, PRESSURE_BAR, pose)
    truth = HERE / "truth" / "bulb.csv"
    with truth.open() as file:
        outline = np.array([[float(v) for v in row] for row in list(csv.reader(file))[1:]])
    profile = profile_of_object(outline, Reach("left", 10.0))
    fit = misfit(deform(layout.bends(), length, 10.0, pose, profile.sign), profile)
    seam = best_seam(joints)
    return Design(
        source=Source(
            file="truth/bulb.csv",
            sha256=hashlib.sha256(truth.read_bytes()).hexdigest(),
            mm_per_px=None,
            scale_source="vector",
            side="left",
            profile_length_mm=profile.length_mm,
            bridged_share=float(np.mean(profile.bridged)),
            origin_px=None,
        ),
        tube=Tube(20.0, 2.0, ROOT_MM, length),
        gauze=Gauze(2.0, 0.25, 2, seam.seam_deg),
        formula=FormulaRef(formula.name, formula.sha256),
        pressure_bar=PRESSURE_BAR,
        joints=joints,
        base_pose=pose,
        fit=Fit(fit, None),
        feasible=True,
        verified=False,
        warnings=("the paper's own design (Table 5), for a bulb that it does not measure",),
    )


if __name__ == "__main__":
    (HERE / "paper_bulb.json").write_text(to_json(paper_bulb()))
