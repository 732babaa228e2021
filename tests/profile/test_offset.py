from __future__ import annotations

import numpy as np
import pytest
import shapely

from profiletool.errors import NoObject
from profiletool.profile.offset import (
    offset_curve,
    offset_points,
    reachable_line,
    reachable_outline,
)
from profiletool.profile.target import Reach, profile_of_object

T = np.linspace(0.0, 2.0 * np.pi, 1441)[:-1]
CIRCLE = 30.0 * np.column_stack([np.cos(T), np.sin(T)])


@pytest.mark.parametrize("clearance", [0.0, 3.0])
def test_a_convex_object_is_reachable_all_over(clearance: float) -> None:
    points = reachable_outline(CIRCLE, 10.0, clearance)
    np.testing.assert_allclose(np.hypot(*points.T), 30.0 + clearance, atol=0.003)


def test_a_groove_narrower_than_the_tube_is_bridged() -> None:
    groove = [[0, 45], [5, 45], [5, 55], [0, 55]]  # 10 mm wide, 5 mm deep
    outline = np.array([[0, 0], [40, 0], [40, 100], [0, 100], *groove[::-1]], dtype=float)
    body = shapely.Polygon(reachable_outline(outline, 10.0, 0.0))
    # A disc of radius 10 over a slot of half-width 5 dips in by 10 - sqrt(100 - 25).
    dip = 10.0 - np.sqrt(75.0)
    across = body.intersection(shapely.LineString([(-50, 50), (20, 50)]))
    assert across.bounds[0] == pytest.approx(dip, abs=0.005)


def test_a_wide_groove_is_entered_down_to_its_fillets() -> None:
    outline = np.array(
        [[0, 0], [40, 0], [40, 100], [0, 100], [0, 75], [5, 75], [5, 25], [0, 25]], dtype=float
    )
    body = shapely.Polygon(reachable_outline(outline, 10.0, 0.0))
    assert body.intersection(shapely.LineString([(-50, 50), (20, 50)])).bounds[0] == (
        pytest.approx(5.0, abs=1e-6)
    )


def test_an_outline_without_area() -> None:
    with pytest.raises(NoObject, match="no area"):
        reachable_outline(np.array([[0.0, 0.0], [50.0, 0.0], [100.0, 0.0]]), 10.0, 0.0)


@pytest.mark.parametrize("side", ["left", "right"])
@pytest.mark.parametrize("distance", [10.0, 20.0])
def test_offsets_of_a_circle_are_circles(side: str, distance: float) -> None:
    profile = profile_of_object(CIRCLE, Reach(side, 10.0))
    for points in (offset_points(profile, distance), offset_curve(profile, distance)):
        np.testing.assert_allclose(np.hypot(*points.T), 30.0 + distance, atol=0.01)


def test_an_open_line_is_closed_by_the_disc_on_the_tubes_side_only() -> None:
    # A notch to the left of the travel direction (downward), 4 mm wide: the tube is to the right.
    notch = np.array([[0, 50], [0, 2], [4, 2], [4, -2], [0, -2], [0, -50]], dtype=float)
    inward = reachable_line(notch, 10.0, 0.0, 1.0)
    assert inward[:, 0].max() < 0.3
    outward = reachable_line(notch, 10.0, 0.0, -1.0)
    assert outward[:, 0].max() == pytest.approx(4.0, abs=0.01)


def test_a_straight_line_stays_where_it_is() -> None:
    line = np.array([[0.0, 50.0], [0.0, -50.0]])
    points = reachable_line(line, 10.0, 0.0, 1.0)
    np.testing.assert_allclose(points[[0, -1]], line, atol=0.002)
    np.testing.assert_allclose(points[:, 0], 0.0, atol=0.002)


@pytest.mark.parametrize("toward", [1.0, -1.0])
def test_an_s_of_gentle_arcs_is_reachable_on_both_sides(toward: float) -> None:
    t = np.linspace(0.0, np.pi, 400)
    upper = 25.0 * np.column_stack([np.sin(t), np.cos(t)]) + [0, 25]
    lower = 25.0 * np.column_stack([-np.sin(t), np.cos(t)]) - [0, 25]
    line = np.concatenate([upper, lower[1:]])
    points = reachable_line(line, 10.0, 0.0, toward)
    gap = shapely.distance(shapely.points(points), shapely.LineString(line))
    assert gap.max() < 0.01
    assert shapely.LineString(points).length == pytest.approx(50 * np.pi, rel=1e-3)
    np.testing.assert_allclose(points[[0, -1]], line[[0, -1]], atol=0.01)


@pytest.mark.parametrize("toward", [1.0, -1.0])
@pytest.mark.parametrize("clearance", [1.0, 3.0, 10.0])
def test_clearance_moves_an_open_line_across_not_round_its_ends(
    clearance: float, toward: float
) -> None:
    t = np.linspace(0.0, np.pi / 2, 500)
    arc = 60.0 * np.column_stack([-np.sin(t), np.cos(t)])  # from the top down the left
    points = reachable_line(arc, 10.0, clearance, toward)
    radius = 60.0 + toward * clearance
    np.testing.assert_allclose(points[0], [0.0, radius], atol=0.2)
    np.testing.assert_allclose(points[-1], [-radius, 0.0], atol=0.2)
    assert shapely.LineString(points).length == pytest.approx(radius * np.pi / 2, abs=0.4)


def test_what_the_tube_can_follow_is_kept_point_for_point() -> None:
    line = np.array([[0.0, 50.0], [-3.0, 0.0], [0.0, -50.0]])
    assert reachable_line(line, 10.0, 0.0, 1.0) is line
