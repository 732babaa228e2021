from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import shapely
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from fem.touching import overlap
from profiletool.bending.kinematics import PIVOT_SHARE, Bend, deform, facing_stretch, meets_itself
from profiletool.joints.misfit import depth_inside, misfit
from profiletool.profile.curve import points_at
from profiletool.profile.target import Reach, profile_of_object
from profiletool.records.frames import Pose

T = np.linspace(0.0, 2.0 * np.pi, 1441)[:-1]
CIRCLE = 30.0 * np.column_stack([np.cos(T), np.sin(T)])
ORIGIN = Pose(0.0, 0.0, 0.0)
turns = st.floats(-1.2, 1.2)


def length(points: np.ndarray) -> float:
    return float(np.hypot(*np.diff(points, axis=0).T).sum())


def test_unbent_it_is_a_straight_tube() -> None:
    shape = deform([Bend(20.0, 8.0, 0.0)], 50.0, 10.0, Pose(1.0, 2.0, 90.0), 1.0)
    np.testing.assert_allclose(shape.facing[[0, -1]], [[1, 2], [1, 52]], atol=1e-12)
    np.testing.assert_allclose(shape.axis[-1], [11, 52], atol=1e-12)
    np.testing.assert_allclose(shape.far[-1], [21, 52], atol=1e-12)


@given(turns)
def test_one_joint_against_its_closed_form(turn: float) -> None:
    shape = deform([Bend(20.0, 8.0, turn)], 50.0, 10.0, ORIGIN, 1.0)
    # Arc of the facing line: length 8 + stretch, then 26 mm straight.
    arc = 8.0 + float(facing_stretch(turn, 10.0))
    chord = arc * np.sinc(turn / 2 / np.pi)
    end = np.array([16.0, 0.0])
    end = end + chord * np.array([np.cos(turn / 2), np.sin(turn / 2)])
    end = end + 26.0 * np.array([np.cos(turn), np.sin(turn)])
    np.testing.assert_allclose(shape.facing[-1], end, atol=1e-9)


@given(turns)
def test_the_line_through_the_pivot_keeps_its_length(turn: float) -> None:
    shape = deform([Bend(20.0, 8.0, turn)], 50.0, 10.0, ORIGIN, 1.0)
    share = 0.5 * (1.0 - np.sign(turn) * PIVOT_SHARE)
    pivot = (1.0 - share) * shape.facing + share * shape.far
    assert length(pivot) == pytest.approx(50.0, abs=2e-3)


@given(st.lists(turns, min_size=1, max_size=4), st.floats(-180, 180))
def test_rotating_the_base_rotates_the_shape(bends: list[float], angle: float) -> None:
    joints = [Bend(20.0 * (k + 1), 8.0, turn) for k, turn in enumerate(bends)]
    still = deform(joints, 120.0, 10.0, ORIGIN, 1.0)
    turned = deform(joints, 120.0, 10.0, replace(ORIGIN, heading_deg=angle), 1.0)
    c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    np.testing.assert_allclose(turned.far, still.far @ [[c, s], [-s, c]], atol=1e-9)


@given(st.lists(turns, min_size=1, max_size=4))
def test_the_other_side_is_the_mirror_image(bends: list[float]) -> None:
    joints = [Bend(20.0 * (k + 1), 8.0, turn) for k, turn in enumerate(bends)]
    left = deform(joints, 120.0, 10.0, ORIGIN, 1.0)
    right = deform(joints, 120.0, 10.0, ORIGIN, -1.0)
    for a, b in ((left.facing, right.facing), (left.far, right.far)):
        np.testing.assert_allclose(a * [1.0, -1.0], b, atol=1e-12)


def test_misfit_of_a_tube_that_lies_on_its_profile() -> None:
    profile = profile_of_object(CIRCLE, Reach("left", 10.0))
    sector = profile.length_mm
    turn = sector / 30.0
    # One long joint whose facing line bends at radius 30 all along the profile.
    cut = sector - float(facing_stretch(turn, 10.0))
    x, y = profile.points[0]
    pose = Pose(float(x), float(y), float(np.degrees(profile.heading[0])))
    on = misfit(deform([Bend(cut / 2, cut, turn)], cut, 10.0, pose, 1.0), profile)
    assert on.max_mm < 0.02
    off = replace(pose, y_mm=pose.y_mm + 1.0)
    shifted = misfit(deform([Bend(cut / 2, cut, turn)], cut, 10.0, off, 1.0), profile)
    assert shifted.max_mm == pytest.approx(1.0, abs=0.05)
    assert 0.5 < shifted.rms_mm < 1.0


def test_misfit_counts_what_is_not_covered_but_not_what_sticks_out() -> None:
    profile = profile_of_object(CIRCLE, Reach("left", 10.0, end_pct=50.0))
    x, y = profile.points[0]
    pose = Pose(float(x), float(y), 180.0)
    short = misfit(deform([], 5.0, 10.0, pose, 1.0), profile)
    far_end = np.hypot(*(profile.points[-1] - [x - 5.0, y]))
    assert short.max_mm == pytest.approx(far_end, abs=0.05)
    ahead = deform([], 20.0, 10.0, replace(pose, x_mm=pose.x_mm + 15.0), 1.0)
    assert misfit(ahead, profile).max_mm == pytest.approx(far_end, abs=0.05)


def test_stretch_of_the_facing_line_by_hand() -> None:
    # Radius 10, axis of rotation 7.9 mm off the axis: 2.1 mm inside the uncut surface.
    assert facing_stretch(1.0, 10.0) == pytest.approx(-2.1)
    assert facing_stretch(-1.0, 10.0) == pytest.approx(17.9)


def test_the_bulbs_centre_line_grows_as_measured() -> None:
    # Whole-actuator FE of the paper's bulb: 26.8 mm for a total turn of 3.38 rad.
    turns = np.radians([34.36, 35.09, 34.71, 29.35, 20.10, -44.49])
    centres, cuts = [10, 29, 48, 67, 79, 91], [8, 8, 8, 8, 6, 10]
    bends = [Bend(c, o, t) for c, o, t in zip(centres, cuts, turns, strict=True)]
    bent = deform(bends, 103.0, 10.0, ORIGIN, 1.0)
    assert length(bent.axis) - 103.0 == pytest.approx(26.8, rel=0.02)


def test_misfit_looks_from_the_line_too() -> None:
    profile = profile_of_object(CIRCLE, Reach("left", 10.0))
    x, y = profile.points[0]
    # A tube that leaves the profile and ends level with its end: the line is far, not the profile.
    straight = misfit(deform([], 60.0, 10.0, Pose(float(x), float(y), 230.0), 1.0), profile)
    end = x + 60.0 * np.cos(np.radians(230.0)), y + 60.0 * np.sin(np.radians(230.0))
    line = shapely.LineString([(x, y), end])
    to_line = shapely.distance(shapely.points(profile.points), line)
    assert straight.rms_mm != pytest.approx(float(np.sqrt(np.mean(to_line**2))), rel=0.02)


@pytest.mark.parametrize(("side", "heading"), [("left", 180.0), ("right", 0.0)])
def test_depth_inside_the_object_has_a_sign(side: str, heading: float) -> None:
    profile = profile_of_object(CIRCLE, Reach(side, 10.0, end_pct=50.0))
    x, y = profile.points[0]
    # A straight tube along the crown lies outside the circle; 3 mm lower it is 3 mm inside.
    crown = Pose(float(x), float(y), heading)
    assert depth_inside(deform([], 30.0, 10.0, crown, profile.sign), profile) < 0.05
    lower = replace(crown, y_mm=crown.y_mm - 3.0)
    inside = depth_inside(deform([], 30.0, 10.0, lower, profile.sign), profile)
    assert inside == pytest.approx(3.0, abs=0.1)


def test_a_tube_that_curls_up_meets_itself() -> None:
    curl = [Bend(20.0 + 24.0 * k, 10.0, np.radians(50.0)) for k in range(9)]
    assert meets_itself(deform(curl, 240.0, 10.0, ORIGIN, 1.0))
    assert not meets_itself(deform(curl[:3], 240.0, 10.0, ORIGIN, 1.0))


@settings(max_examples=12, deadline=None)
@given(st.lists(st.tuples(st.floats(16.0, 40.0), st.floats(0.3, 1.5)), min_size=4, max_size=9))
def test_a_tube_meets_itself_where_its_surface_in_space_does(
    rows: list[tuple[float, float]],
) -> None:
    centres = np.cumsum([row[0] for row in rows])
    bends = [Bend(float(at), 10.0, turn) for at, (_, turn) in zip(centres, rows, strict=True)]
    shape = deform(bends, float(centres[-1]) + 30.0, 10.0, ORIGIN, 1.0)
    along = np.linspace(0.0, shape.along[-1], 200)
    axis, far = (points_at(along, shape.along, line) for line in (shape.axis, shape.far))
    phi = np.linspace(0.0, 2.0 * np.pi, 48, endpoint=False)
    plane = axis[:, None] + np.cos(phi)[:, None] * (far - axis)[:, None]
    up = np.broadcast_to(10.0 * np.sin(phi), plane.shape[:2])
    depth = overlap(np.dstack([plane, up]))
    assume(not 0.0 < depth < 0.2)
    assert meets_itself(shape) == (depth > 0.0)
