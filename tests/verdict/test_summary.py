"""The summary of a design as text, and the marks on angles that are uncertain."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from profiletool.files.design_json import load_design
from profiletool.records.design import Design
from profiletool.records.seal import sealed
from profiletool.report.tables import joint_table as html_table
from profiletool.verdict.summary import joint_table


@pytest.fixture(scope="module")
def near(samples: Path) -> Design:
    """The paper's bulb, verified, with joint 2 within 3 mm of joint 3's cut."""
    design = load_design(samples / "paper_bulb.json")
    joints = [replace(joint, theta_fe_deg=31.4) for joint in design.joints]
    second, third = joints[1:3]
    centre = third.centre_mm - 0.5 * (second.openF_mm + third.openF_mm) - 3.0
    joints[1] = replace(second, centre_mm=centre)
    return sealed(replace(design, joints=tuple(joints), verified=True))


def test_uncertain_angles_are_marked(near: Design) -> None:
    assert near.theta_uncertain == (2, 3, 5, 6)
    rows = joint_table(near).splitlines()[2:8]
    assert [row.split()[-1] for row in rows] == [
        "31.4", "~31.4", "~31.4", "31.4", "~31.4", "~-31.4",  # the last one bends away
    ]  # fmt: skip
    assert len({len(row) for row in rows}) == 1
    marked = str(html_table(near, np.arange(float(len(near.joints)))))
    assert marked.count("~") == 4
