"""Designs changed by hand."""

from __future__ import annotations

from dataclasses import astuple, replace
from pathlib import Path

import numpy as np
import pytest

from formula import load_formula
from profiletool.errors import UsageError
from profiletool.files.design_json import load_design
from profiletool.joints.again import edited, plan_again, posed_of
from profiletool.records.design import Design
from profiletool.records.edit import Edit, edit_of
from profiletool.records.grip_request import OnObject
from profiletool.records.making import request_again
from profiletool.subject.recall import profile_along
from profiletool.verify.recompute import recomputed


@pytest.fixture(scope="module")
def design(samples: Path) -> Design:
    return load_design(samples / "paper_bulb.json")


def test_what_is_given_is_changed_and_nothing_else(design: Design) -> None:
    new = edited(design, Edit(3, alpha_deg=144.0, openF_mm=6.0, move_mm=-1.5, pressure_bar=1.5))
    joint = new.joints[2]
    assert (joint.alpha_closed_deg, joint.openF_mm) == (144.0, 6.0)
    assert joint.centre_mm == pytest.approx(design.joints[2].centre_mm - 1.5)
    assert new.pressure_bar == 1.5
    back = replace(joint, alpha_closed_deg=132.0, openF_mm=8.0, centre_mm=48.0)
    assert (*new.joints[:2], back, *new.joints[3:]) == design.joints
    assert edited(design, Edit(pressure_bar=1.5)).joints == design.joints


@pytest.mark.parametrize(
    ("edit", "says"),
    [
        (Edit(), "nothing to change"),
        (Edit(joint=3), "`joint` goes with"),
        (Edit(alpha_deg=90.0), "`joint` goes with"),
        (Edit(7, alpha_deg=90.0), "`joint` must be 1 to 6, not 7"),
        (Edit(1, alpha_deg=400.0), "`alpha_deg` must be within 0 to 360"),
        (Edit(1, openF_mm=7.0), "whole meshes of 2 mm, not 7"),
        (Edit(1, openF_mm=0.0), "whole meshes"),
        (Edit(2, move_mm=12.0), "joints 2 and 3 would overlap by 1 mm"),
        (Edit(2, move_mm=11.0), "joints 2 and 3 would leave only 0 mm of gauze"),
        (Edit(1, move_mm=-6.0), "into the clamp"),
        (Edit(6, move_mm=8.0), "beyond the tube's closed end"),
        (Edit(pressure_bar=-1.0), "`pressure_bar` must be above 0"),
        (Edit(1, alpha_center_deg=360.0), "`alpha_center_deg` must be within 0 to 360"),
    ],
)
def test_what_cannot_be_built_is_refused(design: Design, edit: Edit, says: str) -> None:
    with pytest.raises(UsageError, match=says):
        edited(design, edit)


def test_a_joint_is_turned_over(design: Design) -> None:
    new = edited(design, edit_of("2:center=90,alpha=103"))
    assert [joint.sense for joint in new.joints[:3]] == [1.0, -1.0, 1.0]
    assert new.joints[1].alpha_closed_deg == 103.0


@pytest.mark.parametrize(
    "text",
    ["", "2", "2:", ":alpha=3", "2:alpha", "2:alpha=x", "2:alpha=nan", "2:beta=3", "x:move=1",
     "2:move=1,move=2", "2:move=1e999"],
)  # fmt: skip
def test_a_change_that_cannot_be_read(text: str) -> None:
    with pytest.raises(UsageError, match="expected a change such as"):
        edit_of(text)


def test_a_plan_has_the_joints_of_its_design(design: Design) -> None:
    line = np.column_stack([-np.linspace(0.0, 60.0, 601), np.zeros(601)])
    profile = profile_along(line, design, None)
    assert profile.heading[0] == pytest.approx(np.pi)
    asked = request_again(design, profile, refine=False)
    formula = load_formula(None)
    plan = plan_again(design, asked, profile, formula, lambda line: None)
    assert plan.by == "joint response"
    assert plan.layout.pressure_bar == pytest.approx(design.pressure_bar)
    again = recomputed(design, line, formula).joints
    for name in ("F_mm", "openF_mm", "alpha_closed_deg", "theta_formula_deg", "centre_mm"):
        ours, theirs = (
            [getattr(j, name) for j in joints] for joints in (plan.layout.joints, again)
        )
        assert ours == pytest.approx(theirs)
    strong = replace(design, pressure_bar=5.0)
    assert plan_again(strong, asked, profile, formula, lambda line: None).by == "formula"
    assert posed_of(design).chain.length == design.tube.length_mm


def test_a_design_is_taken_up_again_with_its_own_object(design: Design) -> None:
    line = np.column_stack([-np.linspace(0.0, 60.0, 601), np.zeros(601)])
    own = OnObject(pressed=False, force_N=0.4, solid="extruded", clearance_mm=0.5)
    asked = request_again(
        replace(design, grip=own), profile_along(line, design, None), refine=False
    )
    assert (asked.grip, asked.grip_N, asked.solid, asked.clearance_mm) == astuple(own)
