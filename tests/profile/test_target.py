from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from profiletool.errors import NoObject
from profiletool.profile.target import Reach, profile_of_line, profile_of_object

T = np.linspace(0.0, 2.0 * np.pi, 1441)[:-1]
CIRCLE = 30.0 * np.column_stack([np.cos(T), np.sin(T)])
BOX = np.array([[0.0, 0.0], [60.0, 0.0], [60.0, 120.0], [0.0, 120.0]])


def test_a_circle_to_45_degrees_under() -> None:
    profile = profile_of_object(CIRCLE, Reach("left", 10.0))
    assert profile.length_mm == pytest.approx(30.0 * 0.75 * np.pi, abs=0.3)
    assert np.degrees(profile.heading[0]) == pytest.approx(180.0, abs=0.1)
    np.testing.assert_allclose(profile.curvature, 1 / 30, rtol=0.01)
    assert not profile.bridged.any()


def test_convex_counts_positive_on_both_sides() -> None:
    right = profile_of_object(CIRCLE, Reach("right", 10.0))
    np.testing.assert_allclose(right.curvature, 1 / 30, rtol=0.01)
    assert np.degrees(right.heading[0]) == pytest.approx(0.0, abs=0.1)
    assert right.sign * (right.heading[-1] - right.heading[0]) > 0.0


@given(st.floats(0, 30), st.floats(70, 100))
@pytest.mark.slow
def test_from_and_to_are_shares_of_the_arc_length(start: float, end: float) -> None:
    whole = profile_of_object(CIRCLE, Reach("left", 10.0))
    part = profile_of_object(CIRCLE, Reach("left", 10.0, start_pct=start, end_pct=end))
    assert part.length_mm == pytest.approx((end - start) / 100 * whole.length_mm, abs=0.11)
    at = [np.interp(start / 100 * whole.length_mm, whole.s, whole.points[:, k]) for k in (0, 1)]
    np.testing.assert_allclose(part.points[0], at, atol=0.06)


def test_the_corner_to_the_base_is_left_out() -> None:
    profile = profile_of_object(BOX, Reach("left", 10.0))
    assert np.degrees(profile.heading[-1]) == pytest.approx(270.0, abs=0.1)
    assert 0.0 < profile.points[-1, 1] < 5.0


def test_the_cap_of_a_lamp_ends_at_its_rim() -> None:
    # Below the rim a cone of 40 deg and a contact: undercut, with a groove that the tube bridges.
    half = [[13, 100], [13, 15], [7, 10], [7, 7], [0, 7]]
    outline = np.array(half + [[-x, y] for x, y in half[-2::-1]], dtype=float)
    end = profile_of_object(outline, Reach("right", 10.0)).points[-1]
    assert end[0] == pytest.approx(13.0, abs=0.1)
    assert 15.0 < end[1] < 19.5


def test_a_bridged_groove_is_reported() -> None:
    grooved = np.array([[0, 0], [60, 0], [60, 120], [0, 120], [0, 65], [5, 65], [5, 55], [0, 55]])
    profile = profile_of_object(grooved.astype(float), Reach("left", 10.0))
    assert profile.bridged.sum() * 0.1 == pytest.approx(10.0, abs=0.5)
    np.testing.assert_allclose(profile.points[profile.bridged, 1], 60.0, atol=5.1)


def test_clearance_moves_the_target_off_the_object() -> None:
    profile = profile_of_object(CIRCLE, Reach("left", 10.0, clearance_mm=2.0))
    np.testing.assert_allclose(np.hypot(*profile.points.T), 32.0, atol=0.01)
    assert not profile.bridged.any()


def test_smaller_than_the_tube() -> None:
    with pytest.raises(NoObject, match="shorter than two diameters"):
        profile_of_object(CIRCLE * 0.2, Reach("left", 10.0))


@pytest.mark.parametrize("direction", [1, -1])
def test_an_open_line_runs_down(direction: int) -> None:
    line = np.array([[0.0, 100.0], [-5.0, 50.0], [0.0, 0.0]])[::direction]
    profile = profile_of_line(line, Reach("left", 10.0))
    assert profile.points[0, 1] == pytest.approx(100.0, abs=0.01)
    assert profile.outline is None


def test_a_level_line_runs_as_drawn() -> None:
    line = np.array([[100.0, 0.0], [50.0, 10.0], [0.0, 0.0]])
    assert profile_of_line(line, Reach("left", 10.0)).points[0, 0] == pytest.approx(100.0, abs=0.01)


def test_too_short_a_stretch_and_too_large_an_object() -> None:
    with pytest.raises(NoObject, match="between `start_pct` and `end_pct`"):
        profile_of_object(CIRCLE, Reach("left", 10.0, start_pct=50.0, end_pct=60.0))
    with pytest.raises(NoObject, match="check the scale"):
        profile_of_object(CIRCLE * 1e6, Reach("left", 10.0))
