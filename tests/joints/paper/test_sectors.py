from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from profiletool.joints.paper.pieces import Rules
from profiletool.joints.paper.sectors import BendingSector, discretise
from profiletool.profile.target import Reach, profile_of_line, profile_of_object
from profiletool.records.profile import Profile
from profiletool.records.units import FloatArray
from tests.curves import turning_line

T = np.linspace(0.0, 2.0 * np.pi, 1441)[:-1]
CIRCLE = 30.0 * np.column_stack([np.cos(T), np.sin(T)])
RULES = Rules(
    radius_mm=10.0,
    openF_mm=np.array([6.0, 8.0, 10.0, 12.0, 14.0]),
    theta_most_rad=np.radians([33.0, 42.0, 51.0, 59.0, 68.0]),
    wrap_mm=2.0,
    tolerance_mm=1.0,
    interference_mm=0.3,
)


def bent_line(*pieces: tuple[float, float]) -> Profile:
    """Profile of (length, turn in deg) pieces, from heading straight down; right turns negative."""
    return profile_of_line(turning_line(*pieces, steps=200), Reach("left", 10.0))


def test_one_bend_between_two_straights() -> None:
    profile = bent_line((40.0, 0.0), (14.0, 30.0), (40.0, 0.0))
    (sector,) = discretise(profile, RULES)
    assert np.degrees(sector.turn_rad) == pytest.approx(30.0, abs=0.1)
    assert sector.centre == pytest.approx(47.0, abs=0.1)
    assert sector.openF_mm == 8.0  # half of the bend, 7 mm, and up to the next mesh
    radius = 14.0 / np.radians(30.0)
    assert sector.deviation_mm == pytest.approx(
        radius * (1.0 / np.cos(np.radians(15.0)) - 1.0), abs=0.06
    )
    assert (sector.excess_turn_rad, sector.missing_mm) == (0.0, 0.0)


def test_a_bend_away_is_negative() -> None:
    (sector,) = discretise(bent_line((40.0, 0.0), (24.0, -30.0), (40.0, 0.0)), RULES)
    assert np.degrees(sector.turn_rad) == pytest.approx(-30.0, abs=0.1)


def test_an_s_needs_one_joint_each_way() -> None:
    profile = bent_line((30, 0), (14, 30), (30, 0), (24, -30), (30, 0))
    turns = [np.degrees(s.turn_rad) for s in discretise(profile, RULES)]
    # A break point may lie where a bend begins, at the cost of a degree.
    assert turns == pytest.approx([30.0, -30.0], abs=1.5)


def test_a_circle_takes_the_fewest_joints_its_tolerance_allows() -> None:
    profile = profile_of_object(CIRCLE, Reach("left", 10.0))
    for tolerance, most_turn in ((1.0, 29.3), (0.5, 20.8), (2.0, 41.2)):
        sectors = discretise(profile, replace(RULES, tolerance_mm=tolerance))
        assert len(sectors) == np.ceil(135.0 / most_turn)
        assert max(s.deviation_mm for s in sectors) <= tolerance


def test_sectors_join_and_turn_as_much_as_the_profile() -> None:
    profile = profile_of_object(CIRCLE, Reach("left", 10.0))
    sectors = discretise(profile, RULES)
    assert sectors[0].start == 0.0
    assert sectors[-1].end == pytest.approx(profile.length_mm)
    assert [s.end for s in sectors[:-1]] == [s.start for s in sectors[1:]]
    assert sum(s.turn_rad for s in sectors) == pytest.approx(
        profile.sign * (profile.heading[-1] - profile.heading[0])
    )


def test_a_straight_profile_needs_none() -> None:
    assert discretise(bent_line((80.0, 0.0)), RULES) == ()


def test_the_number_asked_for() -> None:
    profile = profile_of_object(CIRCLE, Reach("left", 10.0))
    assert len(discretise(profile, RULES, 7)) == 7
    few = discretise(profile, RULES, 3)
    assert len(few) == 3
    assert max(s.deviation_mm for s in few) > RULES.tolerance_mm


def test_a_sharp_corner_is_the_best_attempt_and_says_so() -> None:
    sectors = discretise(bent_line((50.0, 0.0), (1.0, 90.0), (50.0, 0.0)), RULES)
    assert sectors
    assert any(s.excess_turn_rad > 0 or s.missing_mm > 0 or s.deviation_mm > 1.0 for s in sectors)


def geometry(sectors: tuple[BendingSector, ...]) -> np.ndarray:
    return np.array([(s.centre, s.turn_rad, s.openF_mm, s.deviation_mm) for s in sectors])


PEAR = CIRCLE * np.column_stack([1.0 - 0.25 * np.sin(T), np.full(len(T), 1.4)])


@cache
def pear() -> tuple[Profile, FloatArray]:
    """The profile, and what comes of it."""
    profile = profile_of_object(PEAR, Reach("left", 10.0))
    return profile, geometry(discretise(profile, RULES))


@settings(max_examples=15)
@given(st.floats(-np.pi, np.pi), st.floats(-500, 500))
@pytest.mark.slow
def test_invariant_under_rotation_and_shift(angle: float, shift: float) -> None:
    profile, expected = pear()
    c, s = np.cos(angle), np.sin(angle)
    moved = replace(
        profile,
        points=profile.points @ np.array([[c, s], [-s, c]]) + shift,
        heading=profile.heading + angle,
    )
    np.testing.assert_allclose(geometry(discretise(moved, RULES)), expected, atol=1e-6)


def test_invariant_under_mirroring() -> None:
    profile, expected = pear()
    mirrored = replace(
        profile, points=profile.points * [-1, 1], heading=np.pi - profile.heading, side="right"
    )
    np.testing.assert_allclose(geometry(discretise(mirrored, RULES)), expected, atol=1e-9)


@pytest.mark.parametrize("factor", [0.5, 3.0])
def test_scales_with_the_object_and_the_tube(factor: float) -> None:
    profile = profile_of_object(PEAR, Reach("left", 10.0))
    larger = replace(
        profile,
        points=profile.points * factor,
        s=profile.s * factor,
        curvature=profile.curvature / factor,
    )
    rules = replace(
        RULES,
        radius_mm=RULES.radius_mm * factor,
        openF_mm=RULES.openF_mm * factor,
        wrap_mm=RULES.wrap_mm * factor,
        tolerance_mm=RULES.tolerance_mm * factor,
        interference_mm=RULES.interference_mm * factor,
    )
    np.testing.assert_allclose(
        geometry(discretise(larger, rules)),
        geometry(discretise(profile, RULES)) * [factor, 1.0, factor, factor],
        atol=1e-6 * factor,
    )


def test_a_cut_that_finds_no_room_says_how_much_is_missing() -> None:
    # Two bends 8 mm apart: cuts of 6 mm and a mesh between them want 8 mm and their share.
    profile = bent_line((40, 0), (1, 28), (3, 0), (1, 28), (40, 0))
    sectors = discretise(profile, RULES, 2)
    assert max(s.missing_mm for s in sectors) > 1.0


def test_an_s_on_the_right_is_the_mirror_image() -> None:
    left = bent_line((30, 0), (14, 30), (30, 0), (24, -30), (30, 0))
    right = profile_of_line(left.points * [-1, 1], Reach("right", 10.0))
    np.testing.assert_allclose(
        geometry(discretise(right, RULES)), geometry(discretise(left, RULES)), atol=0.3
    )


def test_nothing_to_bend_is_never_passed_off_as_a_joint() -> None:
    arc = profile_of_object(CIRCLE + np.array([500.0, 0.0]), Reach("left", 10.0, end_pct=30.0))
    sectors = discretise(arc, RULES, 6)
    for s in sectors:
        assert s.blocked or abs(s.turn_rad) > 0.0
        assert abs(s.vertex[0] - 500.0) < 40.0


@pytest.mark.slow
def test_a_long_profile_stays_quick() -> None:
    waves = [(60.0, 40.0), (60.0, -40.0)] * 8
    grid_free = bent_line(*waves)
    assert grid_free.length_mm > 950.0
    assert discretise(grid_free, RULES)


def test_beyond_the_tolerance_joints_must_be_worth_their_while() -> None:
    # Two bends too tight for any joint: three joints more would better the sum by a hair.
    rough = bent_line((30, 10), (3, 50), (30, 10), (3, -50), (30, 10))
    assert len(discretise(rough, RULES)) == 4
