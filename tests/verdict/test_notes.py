from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from formula.files import load_formula
from profiletool.bending.kinematics import Bend, deform
from profiletool.joints.layout import Layout
from profiletool.joints.paper.assign import joint_rules, theta_table
from profiletool.joints.paper.sectors import BendingSector
from profiletool.profile.target import Reach, profile_of_object
from profiletool.records.design import Joint, Misfit, named
from profiletool.records.frames import Pose, Shape
from profiletool.records.request import TubeSpec
from profiletool.verdict.notes import (
    disagreement,
    polygon_warnings,
    shape_warnings,
    warnings,
)
from profiletool.verdict.reasons import shortfalls

PAPER = load_formula()
SPEC = TubeSpec()
RULES = joint_rules(theta_table(PAPER, SPEC), SPEC, 1.0)
GOOD = BendingSector(0.0, 12.4, 20.0, (0.0, 0.0), np.radians(30.0), 8.0, 0.8, 0.1, 0.0, 0.0, False)
JOINT = Joint(1, 20.0, 8.0, 132.0, 270.0, 30.0, 30.6, None, 10.0)
LAYOUT = Layout((JOINT,), 10.0, 30.0, 1.9, Pose(0.0, 0.0, 180.0))
T = np.linspace(0.0, 2.0 * np.pi, 1441)[:-1]
ROUND = profile_of_object(30.0 * np.column_stack([np.cos(T), np.sin(T)]), Reach("left", 10.0))


def place(s: float) -> str:
    return f"{s:.0f} mm down"


def reasons(
    sector: BendingSector = GOOD, layout: Layout = LAYOUT, **options: object
) -> tuple[str, ...]:
    spec = options.get("spec", SPEC)
    return shortfalls([sector], layout, RULES, spec, PAPER, options.get("count"), place)


def test_a_good_design_has_none() -> None:
    assert reasons() == ()


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"turn_rad": 1.5, "excess_turn_rad": 0.5, "openF_mm": 14.0}, r"turn of 85\.9 deg .*68\.3"),
        ({"missing_mm": 1.5}, r"cut of 8 mm lacks 3\.0 mm of room"),
        ({"deviation_mm": 1.04}, r"1\.04 mm off the profile, more than the tolerance of 1 mm"),
        ({"inward_mm": 0.42}, r"runs 0\.42 mm into the object"),
        ({"blocked": True}, "nothing for it to bend"),
    ],
)
def test_what_a_joint_misses_and_where(change: dict[str, float], says: str) -> None:
    (reason,) = reasons(replace(GOOD, **change))
    assert reason.startswith("joint 1, 12 mm down: ")
    with pytest.raises(AssertionError, match=says):
        raise AssertionError(reason)


def test_what_nobody_can_see_is_no_reason() -> None:
    assert reasons(replace(GOOD, excess_turn_rad=1e-5, missing_mm=0.01)) == ()


def test_a_number_that_was_asked_for_may_leave_the_tolerance() -> None:
    assert reasons(replace(GOOD, deviation_mm=3.0), count=1) == ()
    assert "no room for 3 joints" in reasons(count=3)[0]


def test_tube_and_length() -> None:
    assert "`formula`" in reasons(spec=replace(SPEC, outer_diameter_mm=16.0))[0]
    assert "`formula`" in reasons(spec=replace(SPEC, wall_mm=1.5))[0]
    assert "250 mm" in reasons(layout=replace(LAYOUT, length_mm=250.2))[0]
    assert reasons(layout=replace(LAYOUT, length_mm=250.0)) == ()


def noted(layout: Layout = LAYOUT, fit: Misfit | None = None, **options: object) -> str:
    profile = options.get("profile", ROUND)
    spec = options.get("spec", SPEC)
    fit = Misfit(0.2, 0.5) if fit is None else fit
    return " | ".join(warnings(layout, profile, fit, 1.0, spec, PAPER, False))


def test_warnings_come_with_their_cause_only() -> None:
    quiet = replace(LAYOUT, pressure_bar=1.2)
    assert noted(quiet) == ""
    assert "reads low above 1.2 bar" in noted(replace(LAYOUT, pressure_bar=1.3))
    eager = replace(JOINT, theta_formula_deg=32.1)
    assert "joint 1 will bend up to 2.1 deg more" in noted(replace(quiet, joints=(eager,)))
    assert "up to 1.1 mm off" in noted(quiet, Misfit(0.4, 1.1))
    bridged = replace(ROUND, bridged=np.arange(len(ROUND.s)) < 0.25 * len(ROUND.s))
    assert "25 % of the profile is bridged" in noted(quiet, profile=bridged)
    assert "ends at 2 bar" in noted(quiet, spec=replace(SPEC, max_pressure_bar=3.0))


def tube_at(dy: float, *bends: Bend) -> Shape:
    x, y = ROUND.points[0]
    return deform(bends, 60.0, 10.0, Pose(float(x), float(y) + dy, 180.0), ROUND.sign)


def test_what_is_wrong_with_the_shape() -> None:
    assert list(shape_warnings(tube_at(0.0), ROUND, 1.0)) == []
    (pressed,) = shape_warnings(tube_at(-4.0), ROUND, 1.0)
    assert "press up to 4.0 mm into the object" in pressed
    assert list(shape_warnings(tube_at(-4.0), ROUND, 4.1)) == []


def test_what_is_wrong_with_the_polygon() -> None:
    off = replace(GOOD, deviation_mm=2.5)
    (asked,) = polygon_warnings([GOOD, off], 1.0, 2)
    assert asked == "with `joints` 2 the polygon is 2.5 mm off the profile, beyond `tolerance_mm` 1"
    assert list(polygon_warnings([GOOD, off], 1.0, None)) == []  # a shortfall there
    assert list(polygon_warnings([GOOD], 1.0, 1)) == []


def test_joints_by_name() -> None:
    assert named([2]) == "joint 2"
    assert named([2, 3, 5]) == "joints 2, 3 and 5"


def test_where_fe_and_the_formula_disagree() -> None:
    def joints(*angles: float | None) -> list[Joint]:
        return [
            replace(JOINT, number=k, theta_fe_deg=angle) for k, angle in enumerate(angles, start=1)
        ]

    assert list(disagreement(joints(None, 32.5, 28.7), 1.9)) == []
    (more,) = disagreement(joints(34.6, 30.0, 35.4), 1.9)
    assert more == (
        "by FE joints 1 and 3 bend up to 4.8 deg more at 1.90 bar than the formula says: "
        "believe the FE"
    )
    (less,) = disagreement(joints(30.6, 25.6), 1.0)
    assert "joint 2 bends 5.0 deg less at 1.00 bar" in less


def test_what_fe_makes_needless_to_say() -> None:
    fit = Misfit(2.0, 5.0)
    told = warnings(LAYOUT, ROUND, fit, 1.0, SPEC, PAPER, True)
    assert not any("reads low" in line for line in told)
    assert any("by FE the bent shape lies up to 5.0 mm off" in line for line in told)
    assert any("is predicted up to 5.0 mm off" in line for line in noted(fit=fit).split(" | "))
