"""The palm: holes, clamps and how many fingers it takes."""

from __future__ import annotations

import re
from itertools import combinations

import numpy as np
import pytest
from shapely import Point, Polygon

from profiletool.template.fingers import clear_radius
from profiletool.template.mounting import mounting_drawing
from tests.template.mounts import (
    ball,
    bottle,
    case,
    drawing_of,
    drum,
    every_case,
    lollipop,
    made,
    on,
    plan,
    rotated,
    said,
)


@every_case
def test_what_is_drilled_is_clear_and_inside_the_palm(name):
    drawing = drawing_of(name)
    palm, holes, clamps = plan(drawing)
    D = made(name)[0].tube.outer_diameter_mm
    holes = [(middle, radius) for middle, radius in holes if radius.max() < 2.0]
    assert len(holes) == 2 * len(clamps)
    for middle, radius in holes:
        np.testing.assert_allclose(radius, 1.6, atol=0.01)
        assert Polygon(palm).boundary.distance(Point(middle)) >= 1.6 + 6.0 - 0.02
        near = min(Polygon(clamp).distance(Point(middle)) for clamp in clamps)
        assert near == pytest.approx(6.0, abs=1e-6)
    for a, b in combinations(clamps, 2):
        assert Polygon(a).distance(Polygon(b)) >= 1.0 - 1e-6
    for (a, _), (b, _) in combinations(holes, 2):
        assert np.hypot(*(a - b)) >= 7.0 - 1e-6
    assert all(Polygon(palm).covers(Polygon(c).buffer(6.0 - 0.05)) for c in clamps)
    for pair, clamp in zip(zip(holes[::2], holes[1::2], strict=True), clamps, strict=True):
        assert np.hypot(*(pair[0][0] - pair[1][0])) == pytest.approx(D + 12.0, abs=1e-6)
        assert Polygon(clamp).buffer(1e-6).covers(Point((pair[0][0] + pair[1][0]) / 2))


@pytest.mark.parametrize(
    ("name", "first"), [("three on a flat top", 180.0), ("three to the right", 0.0)]
)
def test_three_fingers_on_a_flat_top_by_hand(name, first):
    drawing = drawing_of(name)
    palm, holes, clamps = plan(drawing)
    centre = Polygon(palm).centroid
    # Strips of 20 mm are 1 mm apart from 11 / sqrt(3) on; 20 mm are held, up to the base.
    outer = abs(made(name)[0].base_pose.x_mm)
    inner = outer - 20.0
    assert inner > 11 / np.sqrt(3)
    assert f"Base points (x = 0): r = {outer:.1f}" in said(drawing)
    middle = (inner + outer) / 2
    for k in range(3):
        expected = rotated([(middle, 16.0), (middle, -16.0)], first + 120 * k)
        found = np.array([m for m, _ in holes[2 * k : 2 * k + 2]]) - [centre.x, centre.y]
        np.testing.assert_allclose(found, expected, atol=0.01)
        ring = [(inner, -10), (outer, -10), (outer, 10), (inner, 10)]
        strip = rotated(ring, first + 120 * k)
        other = Polygon(clamps[k] - [centre.x, centre.y])
        assert other.symmetric_difference(Polygon(strip)).area < 0.1
    assert np.hypot(*(palm - [centre.x, centre.y]).T) == pytest.approx(
        np.full(len(palm), np.ceil(np.hypot(outer, 10) + 6)), abs=0.01
    )
    assert centre.x == pytest.approx(0.0, abs=0.01)  # below the object's axis
    for k, (m, _) in enumerate(holes, start=1):
        x, y = m - [centre.x, centre.y]
        assert f"{k}:  x {x:.1f},  y {y:.1f}".replace("-0.0", "0.0") in said(drawing)


def test_three_fingers_on_a_slope_are_seen_from_above():
    """A level palm over the highest point; clamps projected; screws through its middle."""
    pose = made("three on a slope")[0].base_pose
    slope = np.radians(pose.heading_deg - 180.0)
    assert 45 < np.degrees(slope) < 55
    drawing = drawing_of("three on a slope")
    palm, holes, clamps = plan(drawing)
    centre = Polygon(palm).centroid
    inner = -pose.x_mm - 20.0 * np.cos(slope)
    outer = -pose.x_mm + 20.0 * np.sin(slope)
    found = np.sort(centre.x - clamps[0][:, 0])
    np.testing.assert_allclose(found[[0, -1]], [inner, outer], atol=0.01)
    np.testing.assert_allclose(np.ptp(clamps[0][:, 1]), 20.0, atol=1e-6)
    assert centre.x - holes[0][0][0] == pytest.approx((inner + outer) / 2, abs=0.01)
    plates = [p for p in on(drawing, "REF") if len(p) == 4]
    top = pose.y_mm + 20 * np.cos(slope) + 20 * np.sin(slope)
    assert min(p[:, 1].min() for p in plates) == pytest.approx(top, abs=1e-6)
    assert f"inclined {np.degrees(slope):.1f}° to the palm" in said(drawing)
    assert f"{np.degrees(slope):.1f}° to the horizontal (heading" in said(drawing)
    # The tube's axis, carried on backward, pierces the palm.
    start = np.array([pose.x_mm - 10 * np.sin(slope), pose.y_mm + 10 * np.cos(slope)])
    r = -(start[0] + (top - start[1]) / np.tan(slope))
    assert f"bore for them at r = {r:.1f}" in said(drawing)


def test_an_object_that_reaches_through_has_an_opening():
    drawing = drawing_of("three around a neck")
    palm, holes, _ = plan(drawing)
    middle, radius = max(holes, key=lambda hole: hole[1].max())
    np.testing.assert_allclose(radius, 13.0, atol=0.01)
    np.testing.assert_allclose(middle, palm.mean(axis=0), atol=1e-6)
    assert "opening of 26.0" in said(drawing)


def test_fingers_that_cannot_meet_are_said_so():
    """Three need 6.4 mm from the axis to the open end, two half a mm; the screws of three 13.3."""
    text = said(drawing_of("one on a ball"))
    assert "their tubes would meet: they begin 19.9 mm beyond" in text
    assert "one is laid out" in text
    text = said(drawing_of("two"))
    assert "their tubes would meet: they begin 1.9" in text
    assert "mm from the object's axis, and need 6.4 mm before it; two opposite ones" in text
    assert "cannot share" not in said(mounting_drawing(*case(drum(), start=20.0)))
    text = said(mounting_drawing(*case(lollipop(15.0), start=62.0)))
    assert "too wide above them" in text
    assert "one is laid out" in text
    assert "cannot share" not in said(drawing_of("one beside a handle"))


@pytest.mark.parametrize(
    ("body", "side"),
    [(ball(), "left"), (ball(30.0), "right"), (drum(), "left"), (bottle(), "left")],
)
def test_the_start_that_is_said_has_room_for_three_fingers(body, side):
    text = said(mounting_drawing(*case(body, side)))
    (start,) = re.findall(r"three find room with --from (\d+)", text)
    drawing = mounting_drawing(*case(body, side, start=float(start)))
    assert len(plan(drawing)[2]) == 3
    assert "cannot share" not in said(drawing)
    before = mounting_drawing(*case(body, side, start=0.6 * float(start)))
    assert len(plan(before)[2]) < 3


def test_no_start_has_room_for_three_thick_fingers():
    text = said(mounting_drawing(*case(ball(24.0), D=24.0)))
    assert "no start farther down has room for three of this tube (--diameter)" in text


@pytest.mark.parametrize("fingers", [2, 3, 5])
def test_strips_clear_each_other_from_the_clear_radius_on(fingers):
    r = clear_radius(fingers, 10.0, 1.0)
    strip = [(r, -10), (r + 50, -10), (r + 50, 10), (r, 10)]
    a, b = (Polygon(rotated(strip, turn)) for turn in (0.0, 360.0 / fingers))
    assert a.distance(b) == pytest.approx(1.0, abs=1e-9)


def test_a_handle_leaves_one_finger_on_a_rectangle():
    drawing = drawing_of("one beside a handle")
    palm, holes, clamps = plan(drawing)
    assert np.ptp(palm, axis=0) == pytest.approx([20 + 12, 2 * np.ceil(16 + 1.6 + 6)])
    assert len(clamps) == 1
    end = made("one beside a handle")[0].base_pose.x_mm
    assert clamps[0][:, 0].min() == pytest.approx(end)
    assert [m[0] for m, _ in holes] == pytest.approx([end + 10.0] * 2)
    assert "Not taken for a body of revolution" in said(drawing)
    assert "width 110.0" in said(drawing)
    assert "height 90.0" in said(drawing)


def test_places_on_one_finger_s_palm_are_measured_from_the_axis():
    """Held from 38 to 18 mm beyond the axis."""
    drawing = drawing_of("one from beyond the axis")
    _, holes, (clamp,) = plan(drawing)
    pose = made("one from beyond the axis")[0].base_pose
    assert 17.5 < pose.x_mm < 18.0
    # On the palm's face, where the far line begins.
    end = pose.x_mm + 20.0 * np.sin(np.radians(pose.heading_deg))
    np.testing.assert_allclose(np.sort(clamp[:, 0])[[0, -1]], [end, end + 20], atol=0.01)
    assert [m[0] for m, _ in holes] == pytest.approx([end + 10.0] * 2, abs=0.01)
    assert f"1:  x {end + 10:.1f},  y -16.0 2:  x {end + 10:.1f},  y 16.0" in said(drawing)
    assert f"0 to screws {end + 10:.1f}" in said(drawing)
    crosses = [p for p in on(drawing, "MARK", closed=False) if np.ptp(p[:, 0]) == 0.0]
    assert any(abs(p[0, 0]) < 0.02 and abs(np.ptp(p[:, 1]) - 8.0) < 0.1 for p in crosses)
