from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from formula.files import load_formula
from formula.table import assign
from profiletool.joints.bounds import END_WRAP_MM, WRAP_MM
from profiletool.joints.paper.assign import joint_rules, lay_out, theta_table
from profiletool.joints.paper.sectors import BendingSector, discretise
from profiletool.profile.target import Reach, profile_of_line, profile_of_object
from profiletool.records.design import AWAY_DEG, TOWARD_DEG
from profiletool.records.profile import Profile
from profiletool.records.request import TubeSpec

PAPER = load_formula()
SPEC = TubeSpec()
TABLE = theta_table(PAPER, SPEC)
T = np.linspace(0.0, 2.0 * np.pi, 2881)[:-1]
CIRCLE = 30.0 * np.column_stack([np.cos(T), np.sin(T)])


def sector(
    centre: float, turn_deg: float, openF: float, vertex: tuple[float, float]
) -> BendingSector:
    return BendingSector(
        0.0, centre, 0.0, vertex, np.radians(turn_deg), openF, 0.0, 0.0, 0.0, 0.0, False
    )


@pytest.fixture(scope="module")
def circle() -> Profile:
    return profile_of_object(CIRCLE, Reach("left", 10.0))


def test_eq_10_on_a_circle(circle: Profile) -> None:
    # Centres 30 deg apart on R 30: NS spans 30 deg less 8 mm of the profile, measured at R 40.
    step = np.radians(30.0) * 30.0
    vertex = (-30.0 * np.tan(np.radians(15.0)), 30.0)
    sectors = [sector(step * (k + 0.5), 30.0, 8.0, vertex) for k in range(3)]
    layout = lay_out(circle, sectors, TABLE, SPEC)
    chord = 80.0 * np.sin(0.5 * (step - 8.0) / 30.0)
    assert layout.joints[0].F_mm == layout.joints[1].F_mm == round(8.0 + chord, 1)
    assert layout.joints[0].F_mm == 18.2
    assert layout.root_mm == 10.0
    assert layout.pose.x_mm == pytest.approx(vertex[0] + 10.0, abs=0.01)
    assert layout.pose.heading_deg == pytest.approx(180.0, abs=0.2)


def test_places_along_the_tube_add_up(circle: Profile) -> None:
    rules = joint_rules(TABLE, SPEC, 1.0)
    layout = lay_out(circle, discretise(circle, rules), TABLE, SPEC)
    centres = [joint.centre_mm for joint in layout.joints]
    F = [joint.F_mm for joint in layout.joints]
    assert centres[0] == layout.root_mm
    np.testing.assert_allclose(np.diff(centres), F[:-1], atol=1e-9)
    assert layout.length_mm == pytest.approx(centres[-1] + F[-1])
    assert [joint.number for joint in layout.joints] == list(range(1, len(centres) + 1))


def test_the_look_up_gives_the_same_back(circle: Profile) -> None:
    rules = joint_rules(TABLE, SPEC, 1.0)
    layout = lay_out(circle, discretise(circle, rules), TABLE, SPEC)
    found = assign(
        TABLE,
        [joint.openF_mm for joint in layout.joints],
        [joint.theta_target_deg for joint in layout.joints],
    )
    assert found.pressure_bar == layout.pressure_bar
    assert found.alpha_closed_deg == tuple(joint.alpha_closed_deg for joint in layout.joints)
    for joint in layout.joints:
        assert joint.theta_formula_deg >= joint.theta_target_deg - 1e-9


def test_direction_tells_the_side_of_the_uncut_sector(circle: Profile) -> None:
    sectors = [sector(20.0, 25.0, 8.0, (-9.0, 30.0)), sector(50.0, -25.0, 8.0, (0.0, 0.0))]
    layout = lay_out(circle, sectors, TABLE, SPEC)
    assert [j.alpha_center_deg for j in layout.joints] == [TOWARD_DEG, AWAY_DEG]
    assert np.sign([bend.turn_rad for bend in layout.bends()]).tolist() == [1.0, -1.0]


def test_windows_keep_their_distance_from_each_other_and_the_end(circle: Profile) -> None:
    end = circle.length_mm
    crowded = [sector(end - 3.0, 25.0, 8.0, (-9.0, 30.0)), sector(end, 25.0, 8.0, (0.0, 0.0))]
    first, second = lay_out(circle, crowded, TABLE, SPEC).joints
    assert first.F_mm == 8.0 + WRAP_MM
    assert second.F_mm == 4.0 + END_WRAP_MM


def test_a_long_straight_lead_makes_the_root_longer() -> None:
    line = np.array([[0.0, 60.0], [0.0, 0.0], [20.0, -40.0]])
    profile = profile_of_line(line, Reach("left", 10.0))
    layout = lay_out(profile, [sector(60.0, 26.0, 8.0, (0.0, 0.0))], TABLE, SPEC)
    assert layout.root_mm == pytest.approx(60.0, abs=0.1)
    assert layout.pose.y_mm == pytest.approx(60.0, abs=0.1)


def test_a_small_turn_takes_a_cut_whose_column_is_near(circle: Profile) -> None:
    sectors = [sector(20.0, 45.0, 10.0, (-9.0, 30.0)), sector(50.0, 14.5, 14.0, (0.0, 0.0))]
    lead, small = lay_out(circle, sectors, TABLE, SPEC).joints
    assert lead.openF_mm == 10.0
    assert small.openF_mm < 14.0
    assert small.theta_formula_deg - 14.5 <= 2.0


def test_a_turn_beyond_reach_is_cut_back(circle: Profile) -> None:
    (joint,) = lay_out(circle, [sector(20.0, 90.0, 14.0, (-9.0, 30.0))], TABLE, SPEC).joints
    assert joint.theta_target_deg == pytest.approx(90.0)
    assert joint.theta_formula_deg == pytest.approx(float(TABLE.theta_deg.max()))


@pytest.mark.parametrize(("pitch", "cuts"), [(2.0, (6, 8, 10, 12, 14)), (3.0, (6, 9, 12))])
def test_cuts_are_whole_meshes_within_the_formula(pitch: float, cuts: tuple[int, ...]) -> None:
    assert theta_table(PAPER, replace(SPEC, pitch_mm=pitch)).openF_mm == cuts


def test_no_row_above_the_highest_pressure() -> None:
    assert theta_table(PAPER, replace(SPEC, max_pressure_bar=1.55)).pressures_bar[-1] == 1.5


def test_an_away_joint_covers_its_opening_on_the_profile(circle: Profile) -> None:
    def first_F(turn: float) -> float:
        pair = [sector(15.0, 25.0, 8.0, (-9.0, 30.0)), sector(50.0, turn, 8.0, (0.0, 0.0))]
        return lay_out(circle, pair, TABLE, SPEC).joints[0].F_mm

    # 17.9 mm per radian, half of it on this side, at 4/3 of the profile's length on the axis.
    opening = 17.9 * np.radians(25.0) / 2.0
    assert first_F(25.0) - first_F(-25.0) == pytest.approx(opening * 4.0 / 3.0, rel=0.1)


def test_the_root_gives_the_first_cut_its_room(circle: Profile) -> None:
    short = replace(SPEC, root_mm=1.0)
    layout = lay_out(circle, [sector(2.0, 60.0, 14.0, (-2.0, 30.0))], TABLE, short)
    assert layout.root_mm == 7.0 + WRAP_MM


def test_equal_largest_angles_keep_their_cuts(circle: Profile) -> None:
    pair = [sector(15.0, 38.0, 12.0, (-9.0, 30.0)), sector(50.0, 38.0, 12.0, (0.0, 0.0))]
    assert [j.openF_mm for j in lay_out(circle, pair, TABLE, SPEC).joints] == [12.0, 12.0]


def test_a_coarser_gauze_keeps_one_mesh_between_windows(circle: Profile) -> None:
    coarse = replace(SPEC, pitch_mm=3.0)
    table = theta_table(PAPER, coarse)
    pair = [sector(40.0, 25.0, 9.0, (-9.0, 30.0)), sector(41.0, 25.0, 9.0, (0.0, 0.0))]
    assert lay_out(circle, pair, table, coarse).joints[0].F_mm == 9.0 + 3.0
    assert joint_rules(table, coarse, 1.0).wrap_mm == 3.0


def test_the_joint_that_sets_the_pressure_keeps_its_cut(circle: Profile) -> None:
    # 29 deg at 6 mm asks for 1.9 bar, where 14 mm has nothing near 30 deg, but 8 mm would.
    pair = [sector(15.0, 30.0, 14.0, (-9.0, 30.0)), sector(50.0, 29.0, 6.0, (0.0, 0.0))]
    lead, other = lay_out(circle, pair, TABLE, SPEC).joints
    assert (lead.openF_mm, other.openF_mm) == (14.0, 6.0)
    assert lead.theta_formula_deg - 30.0 > 2.0
