"""Design records for the tests of the template."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from profiletool.files.design_json import load_design
from profiletool.joints.windows import best_seam
from profiletool.records.design import Design, Fit, FormulaRef, Gauze, Joint, Misfit, Source, Tube
from profiletool.records.frames import Pose
from profiletool.records.seal import sealed


def joint(number=1, F=19.0, openF=8.0, alpha=132.0, center=270.0, theta=30.0, at=10.0) -> Joint:
    return Joint(number, F, openF, alpha, center, theta, theta, None, at)


def row_of_joints(rows: Sequence[Sequence[float]], root: float = 10.0) -> tuple[Joint, ...]:
    joints = []
    at = root
    for number, (F, openF, alpha, center, theta) in enumerate(rows, start=1):
        joints.append(joint(number, F, openF, alpha, center, theta, at))
        at += F
    return tuple(joints)


def design_of(joints: Sequence[Joint], length: float, name: str = "object.png") -> Design:
    design = Design(
        source=Source(
            file=name,
            sha256="0" * 64,
            mm_per_px=None,
            scale_source="vector",
            side="left",
            profile_length_mm=length,
            bridged_share=0.0,
            origin_px=None,
        ),
        tube=Tube(20.0, 2.0, joints[0].centre_mm if joints else 10.0, length),
        gauze=Gauze(2.0, 0.25, 2, best_seam(joints).seam_deg),
        formula=FormulaRef("formula (9)", "0" * 64),
        pressure_bar=1.9,
        joints=tuple(joints),
        base_pose=Pose(0.0, 0.0, -90.0),
        fit=Fit(Misfit(0.5, 1.0), None),
        feasible=True,
        verified=True,
        warnings=(),
    )
    return sealed(design)


def bulb() -> Design:
    """Read the actuator of Table 5 (root 10, end 4 mm beyond the last F), as if verified."""
    paper = load_design(Path(__file__).parents[2] / "samples" / "paper_bulb.json")
    return sealed(replace(paper, source=replace(paper.source, file="bulb.png"), verified=True))


def short_tube() -> Design:
    """Build one joint on 40 mm of tube, not verified."""
    joints = (joint(openF=10.0, alpha=84.0, at=20.0),)
    return replace(design_of(joints, 40.0, "ring.svg"), verified=False)


def long_tube() -> Design:
    """Build twelve joints on alternating sides of 230 mm of tube."""
    rows = [
        (18, (6, 8, 10, 12, 14)[k % 5], 84 + 6 * k, 270 if k % 2 == 0 else 90, 25)
        for k in range(12)
    ]
    return design_of(row_of_joints(rows, 15.0), 230.0, "garland of lamps, no. 3.jpeg")


def skew() -> Design:
    """Build three joints that bend out of plane."""
    rows = [(22, 8, 120, 200, 30), (22, 10, 132, 250, 30), (20, 6, 108, 300, 25)]
    return replace(design_of(row_of_joints(rows), 80.0, "handle.dxf"), feasible=False)


def tight() -> Design:
    """Build twelve joints so close that hardly a label fits, one beyond the tube's end."""
    joints = [joint(k + 1, 7, 6, 84, (270, 90)[k % 2], at=8 + 7 * k) for k in range(12)]
    return replace(design_of(joints, 84.0, "Röhre ☃ & <co>.png"), feasible=False, verified=False)
