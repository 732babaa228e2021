from __future__ import annotations

import io
from collections import Counter
from dataclasses import replace
from functools import cache
from itertools import combinations, pairwise
from types import SimpleNamespace

import numpy as np
import pytest
from ezdxf import recover
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely import LineString, Point, Polygon, STRtree, box

from profiletool.bending.kinematics import Bend, deform
from profiletool.profile.target import Reach, profile_of_line, profile_of_object
from profiletool.records.frames import Pose
from profiletool.template.callouts import Callout, lettered
from profiletool.template.draughting import CHAIN, dashed, dimension, no_line_twice
from profiletool.template.drawing import Drawing, Line, polyline
from profiletool.template.dxf import write_dxf
from profiletool.template.fingers import clear_radius
from profiletool.template.mounting import mounting_drawing
from tests.template.designs import design_of, row_of_joints
from tests.template.geometry import coincident, segments

T = np.linspace(0.0, 2.0 * np.pi, 721)[:-1]
COLOURS = {"CUT_OUTER": 7, "CUT_INNER": 5, "MARK": 3, "NOTE": 1, "REF": 8}
R = 10.0  # of the tubes, if not said otherwise


def ball(radius=40.0):
    """A ball of ``radius``, its top at the origin."""
    return radius * np.column_stack([np.cos(T), np.sin(T) - 1.0])


def drum(width=160.0, height=60.0):
    """A body with a flat top."""
    half = width / 2
    return np.array([[-half, -height], [half, -height], [half, 0.0], [-half, 0.0]])


def bottle():
    """A neck of radius 12 above a belly of radius 25."""
    right = np.array([[25, -100], [25, -60], [12, -35], [12, 0]], dtype=float)
    return np.concatenate([right, right[::-1] * [-1, 1]])


def lollipop(stick):
    """A ball of radius 30 on a stick of radius ``stick``, 140 high."""
    low = np.arcsin(stick / 30.0) - np.pi / 2
    around = np.linspace(low, np.pi - low, 400)
    head = 30.0 * np.column_stack([np.cos(around), np.sin(around) - 1.0])
    return np.concatenate([head, [[-stick, -140.0], [stick, -140.0]]])


def mug():
    """A drum with a handle on its right."""
    return np.array(
        [[-40, -90], [40, -90], [40, -70], [70, -70], [70, -20], [40, -20], [40, 0], [-40, 0]],
        dtype=float,
    )


def wave():
    """An open line that runs down to the right."""
    y = -np.linspace(0.0, 100.0, 401)
    return np.column_stack([25.0 + 4.0 * np.sin(y / 15.0) - 0.2 * y, 12.0 + y])


def case(
    body,
    side="left",
    start=0.0,
    root=10.0,
    clearance=0.0,
    D=2 * R,
    closed=True,
    away=False,
    back=0.0,
):
    """A design along a body, its profile, the tube at rest and bent; its base moved ``back``."""
    reach = Reach(side, D / 2, clearance_mm=clearance, start_pct=start)
    profile = profile_of_object(body, reach) if closed else profile_of_line(body, reach)
    way = np.array([np.cos(profile.heading[0]), np.sin(profile.heading[0])])
    x, y = profile.points[0] - back * way
    pose = Pose(float(x), float(y), float(np.degrees(profile.heading[0])))
    joints = row_of_joints([(20, 8, 120, 90 if away else 270, 30)] * 3, root)
    design = design_of(joints, root + 60.0, "thing.png")
    design = replace(
        design,
        base_pose=pose,
        source=replace(design.source, side=side),
        tube=replace(design.tube, outer_diameter_mm=D),
    )
    bends = [Bend(j.centre_mm, j.openF_mm, j.sense * np.radians(30.0)) for j in joints]
    shapes = [deform(some, root + 60.0, D / 2, pose, profile.sign) for some in ((), bends)]
    return design, profile, *shapes


CASES = {
    "three on a flat top": lambda: case(drum(), root=40.0),
    "three to the right": lambda: case(drum(), "right", root=40.0),
    "three on a slope": lambda: case(ball(), start=30.0),
    "three around a neck": lambda: case(bottle(), start=25.0),
    "two": lambda: case(drum(), root=14.0),
    "one on a ball": lambda: case(ball(), root=8.0),
    "one thin to the right": lambda: case(ball(30.0), "right", root=8.0, D=8.0),
    "one from beyond the axis": lambda: case(ball(), root=24.0, back=18.0),
    "one beside a handle": lambda: case(mug(), root=30.0),
    "one on a line": lambda: case(wave(), closed=False),
    "one on the right of a line": lambda: case(wave(), "right", closed=False, away=True),
    "thin, with clearance": lambda: case(ball(), "right", start=15.0, clearance=3.0, D=8.0),
}
every_case = pytest.mark.parametrize("name", CASES)


@cache
def made(name):
    return CASES[name]()


@cache
def drawing_of(name) -> Drawing:
    return mounting_drawing(*made(name))


@cache
def dxf_of(name):
    return write_dxf(drawing_of(name))


def on(drawing, layer, closed=True):
    return [x.points for x in drawing.drawn if x.layer == layer and x.closed is closed]


def plan(drawing):
    """Palm, holes (middle, radius), clamps in the plan: as read off the drawing."""
    (palm,) = on(drawing, "CUT_OUTER")
    holes = [(h.mean(axis=0), np.hypot(*(h - h.mean(axis=0)).T)) for h in on(drawing, "CUT_INNER")]
    inside = Polygon(palm).buffer(1e-6)
    clamps = [c for c in on(drawing, "MARK") if len(c) == 4 and inside.covers(Polygon(c))]
    return palm, holes, clamps


def rotated(points, degrees):
    return np.array(points) @ np.array(
        [
            [np.cos(np.radians(degrees)), np.sin(np.radians(degrees))],
            [-np.sin(np.radians(degrees)), np.cos(np.radians(degrees))],
        ]
    )


def said(drawing):
    return " ".join(text.text for text in drawing.texts)


@every_case
def test_dxf_reads_back(name):
    drawing = drawing_of(name)
    doc, auditor = recover.read(io.BytesIO(dxf_of(name)))
    assert not auditor.has_errors
    assert not auditor.has_fixes
    assert doc.header["$INSUNITS"] == 4
    assert {name: doc.layers.get(name).color for name in COLOURS} == COLOURS
    entities = list(doc.modelspace())
    assert {entity.dxftype() for entity in entities} == {"LWPOLYLINE"}
    counts = Counter(entity.dxf.layer for entity in entities)
    assert counts == {layer.name: len(layer.lines) for layer in drawing.layers}
    fingers = {"t": 3, "o": 1}[name[0]] if name != "two" else 2
    assert counts["CUT_OUTER"] == 1
    assert counts["CUT_INNER"] == 2 * fingers + (name == "three around a neck")
    assert all(e.closed for e in entities if e.dxf.layer.startswith("CUT"))


@every_case
def test_the_same_design_gives_the_same_bytes(name):
    assert dxf_of(name) == write_dxf(mounting_drawing(*made(name)))


@every_case
def test_no_line_is_drawn_twice(name):
    assert coincident(segments(SimpleNamespace(drawing=drawing_of(name)))) == []


def assert_lettering_clear(drawing):
    boxes = [box(*text.box) for text in drawing.texts]
    assert [(a, b) for a, b in combinations(boxes, 2) if a.intersects(b)] == []
    lines = [
        LineString(np.vstack([line.points, line.points[:1]]) if line.closed else line.points)
        for line in drawing.drawn
    ]
    found = STRtree(lines).query([b.buffer(0.2) for b in boxes], predicate="intersects")
    assert [drawing.texts[k].text for k in found[0]] == []
    assert min(text.height for text in drawing.texts) >= 2.5


@every_case
def test_lettering_stands_clear(name):
    assert_lettering_clear(drawing_of(name))


@every_case
def test_the_side_view_clamp_stands_at_the_base(name):
    """It runs from the base along the heading, up to the first cut, as wide as the tube."""
    design = made(name)[0]
    pose = design.base_pose
    length = design.tube.root_mm - 4.0
    way = np.array([np.cos(np.radians(pose.heading_deg)), np.sin(np.radians(pose.heading_deg))])
    # The object lies to the left of the way on the left side, so the tube to its right.
    out = np.array([way[1], -way[0]]) * (1.0 if design.source.side == "left" else -1.0)
    base, D = np.array([pose.x_mm, pose.y_mm]), design.tube.outer_diameter_mm
    expected = Polygon([base, base + length * way, base + length * way + D * out, base + D * out])
    found = [Polygon(c) for c in on(drawing_of(name), "MARK") if len(c) == 4]
    assert min(c.symmetric_difference(expected).area for c in found) < 1e-6


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
    # Strips of 20 mm are 1 mm apart from 10 / sqrt(3) + 1 / sqrt(3) on; 36 mm are held.
    base = abs(made(name)[0].base_pose.x_mm)
    cut = np.ceil(10 * (11 / np.sqrt(3) - base)) / 10
    assert f"Cut each root {cut:g} mm shorter" in said(drawing)
    assert f"clamp length left {36 - cut:g} mm" in said(drawing)
    inner, outer = base + cut, base + 36.0
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
    assert 35 < np.degrees(slope) < 45
    drawing = drawing_of("three on a slope")
    palm, holes, clamps = plan(drawing)
    centre = Polygon(palm).centroid
    inner = -pose.x_mm
    outer = inner + 6.0 * np.cos(slope) + 20.0 * np.sin(slope)
    found = np.sort(centre.x - clamps[0][:, 0])
    np.testing.assert_allclose(found[[0, -1]], [inner, outer], atol=0.01)
    np.testing.assert_allclose(np.ptp(clamps[0][:, 1]), 20.0, atol=1e-6)
    assert centre.x - holes[0][0][0] == pytest.approx((inner + outer) / 2, abs=0.01)
    plates = [p for p in on(drawing, "REF") if len(p) == 4]
    top = max(pose.y_mm + 20 * np.cos(slope), pose.y_mm)
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
    """Held are 4, 10 and 14 mm, from the axis on; three lose 6.3 to 6.4 mm, two half a mm.

    Saddles of three need 13.3 mm from the axis and 2 mm of clamp beyond.
    """
    text = said(drawing_of("one on a ball"))
    assert "each clamp of 4 mm would have to lose 6.3 mm" in text
    assert "One is laid out" in text
    text = said(drawing_of("two"))
    assert "each clamp of 10 mm would have to lose 6.3 mm" in text
    assert "Two opposite ones are laid out" in text
    assert "Cut each root 0.5 mm shorter" in text
    text = said(mounting_drawing(*case(drum(), root=18.0)))
    assert "their screws would meet. Two opposite ones" in text
    assert "cannot share" not in said(mounting_drawing(*case(drum(), root=20.0)))
    text = said(mounting_drawing(*case(lollipop(15.0), start=62.0)))
    assert "too wide above them" in text
    assert "One is laid out" in text
    text = said(mounting_drawing(*case(lollipop(4.0), start=62.0)))
    assert "closer than the tubes are wide" in text
    assert "cannot share" not in said(drawing_of("one beside a handle"))


def test_a_clamp_that_is_short_is_no_reason_to_stand_alone():
    drawing = mounting_drawing(*case(ball(), start=20.0, root=7.0))
    assert len(plan(drawing)[2]) == 3
    assert "clamp is short: 3 mm" in said(drawing)


@pytest.mark.parametrize("fingers", [2, 3, 5])
def test_strips_clear_each_other_from_the_clear_radius_on(fingers):
    r = clear_radius(fingers, 10.0, 1.0)
    strip = [(r, -10), (r + 50, -10), (r + 50, 10), (r, 10)]
    a, b = (Polygon(rotated(strip, turn)) for turn in (0.0, 360.0 / fingers))
    assert a.distance(b) == pytest.approx(1.0, abs=1e-9)


def test_a_handle_leaves_one_finger_on_a_rectangle():
    drawing = drawing_of("one beside a handle")
    palm, holes, clamps = plan(drawing)
    assert np.ptp(palm, axis=0) == pytest.approx([26 + 12, 2 * np.ceil(16 + 1.6 + 6)])
    assert len(clamps) == 1
    end = made("one beside a handle")[0].base_pose.x_mm
    assert clamps[0][:, 0].max() == pytest.approx(end)
    assert [m[0] for m, _ in holes] == pytest.approx([end - 13.0] * 2)
    assert "Not taken for a body of revolution" in said(drawing)
    assert "width 110.0" in said(drawing)
    assert "height 90.0" in said(drawing)


def test_places_on_one_finger_s_palm_are_measured_from_the_axis():
    """Held from 18 mm beyond the axis to 2 mm on this side of it."""
    drawing = drawing_of("one from beyond the axis")
    _, holes, (clamp,) = plan(drawing)
    pose = made("one from beyond the axis")[0].base_pose
    assert 17.5 < pose.x_mm < 18.0
    # On the palm's face, where the far line begins.
    end = pose.x_mm + 20.0 * np.sin(np.radians(pose.heading_deg))
    np.testing.assert_allclose(np.sort(clamp[:, 0])[[0, -1]], [end - 20, end], atol=0.01)
    assert [m[0] for m, _ in holes] == pytest.approx([end - 10.0] * 2, abs=0.01)
    assert f"1:  x {end - 10:.1f},  y -16.0 2:  x {end - 10:.1f},  y 16.0" in said(drawing)
    assert f"0 to screws {end - 10:.1f}" in said(drawing)
    crosses = [p for p in on(drawing, "MARK", closed=False) if np.ptp(p[:, 0]) == 0.0]
    assert any(abs(p[0, 0]) < 0.02 and abs(np.ptp(p[:, 1]) - 8.0) < 0.1 for p in crosses)


def test_a_drawn_line_stands_for_the_object():
    profile = made("one on a line")[1]
    drawing = drawing_of("one on a line")
    line = LineString(profile.points)
    grey = [LineString(p) for p in on(drawing, "REF", closed=False)]
    assert max(p.length for p in grey if line.buffer(0.05).covers(p)) > 0.95 * line.length
    assert "body of revolution" not in said(drawing)
    assert "0: middle of the tube's clamped end" in said(drawing)
    x, y = profile.points[0]
    assert f"base point: x {x:.1f}, y {y:.1f}" in said(drawing)
    clamps = plan(drawing)[2]
    assert np.ptp(clamps[0], axis=0) == pytest.approx([6.0, 20.0])  # true size, steep as it is


def test_outline_target_and_tubes_are_mounting_drawing():
    design, profile, straight, bent = case(ball(), start=10.0, clearance=4.0)
    drawing = mounting_drawing(design, profile, straight, bent)
    assert any(
        Polygon(p).symmetric_difference(Polygon(ball())).area < 5.0 for p in on(drawing, "REF")
    )
    paths = [LineString(line.points) for line in drawing.drawn if line.layer in ("REF", "NOTE")]
    for shape, least in ((bent.facing, 0.9), (bent.far, 0.9), (straight.far, 0.5)):
        held = LineString(shape[straight.along >= design.tube.root_mm])
        cover = held.buffer(0.05)
        assert sum(p.intersection(cover).length for p in paths) > least * held.length
    target = LineString(profile.points).buffer(0.05)
    notes = [LineString(line.points) for line in drawing.drawn if line.layer == "NOTE"]
    assert max(p.intersection(target).length for p in notes) > 0.95 * profile.length_mm


def test_left_and_right_mirror_each_other():
    left, right = (
        plan(mounting_drawing(*case(drum(), side, root=40.0)))[1] for side in ("left", "right")
    )
    mirrored = sorted(tuple(np.round(m * [-1, 1], 2)) for m, _ in left)
    assert mirrored == sorted(tuple(np.round(m, 2)) for m, _ in right)


def test_base_is_measured_from_the_top_middle():
    drawing = mounting_drawing(*case(ball(), start=20.0))
    x, y = case(ball(), start=20.0)[0].base_pose.x_mm, case(ball(), start=20.0)[0].base_pose.y_mm
    assert f"base x {-x:.1f}" in said(drawing)
    assert f"base y {-y:.1f}" in said(drawing)
    assert f"base point: x {x:.1f}, y {y:.1f}" in said(drawing)


def test_title_says_what_is_wrong():
    good, *rest = made("two")
    assert mounting_drawing(good, *rest).title == "Mounting: thing.png"
    bad = mounting_drawing(replace(good, feasible=False, verified=False), *rest)
    assert bad.title == "Mounting: thing.png - INFEASIBLE - NOT VERIFIED"
    assert {"INFEASIBLE", "NOT VERIFIED"} <= {text.text for text in bad.texts}


def test_a_tube_that_bends_into_the_palm_is_warned_of():
    assert "runs into the palm" in said(mounting_drawing(*case(wave(), closed=False, away=True)))
    assert "runs into the palm" not in said(drawing_of("one on a line"))


def test_the_bar_is_100_mm():
    bars = [p for p in on(drawing_of("two"), "REF", closed=False) if len(p) == 2]
    assert any(np.ptp(p, axis=0) == pytest.approx([100.0, 0.0]) for p in bars)


def test_a_root_without_room_is_refused():
    design, *rest = made("two")
    tube = replace(design.tube, root_mm=4.0)
    with pytest.raises(ValueError, match="no root"):
        mounting_drawing(replace(design, tube=tube), *rest)


@settings(max_examples=8, deadline=None)
@given(
    side=st.sampled_from(["left", "right"]),
    start=st.floats(0, 40),
    root=st.floats(8, 30),
    D=st.floats(8, 24),
    radius=st.floats(30, 60),
)
def test_any_ball_gives_a_clean_drawing(side, start, root, D, radius):
    drawing = mounting_drawing(*case(ball(radius), side, start, root, D=D))
    assert coincident(segments(SimpleNamespace(drawing=drawing))) == []
    assert_lettering_clear(drawing)
    clamps = plan(drawing)[2]
    assert all(Polygon(a).distance(Polygon(b)) > 0.99 for a, b in combinations(clamps, 2))


def test_dashes_follow_their_pattern():
    strokes = [line.points for line in dashed("MARK", np.array([[0.0, 0.0], [25.0, 0.0]]), CHAIN)]
    assert [p[:, 0].tolist() for p in strokes] == [
        [0.0, 8.0], [9.5, 11.0], [12.5, 20.5], [22.0, 23.5],
    ]  # fmt: skip
    bent = dashed("MARK", np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 9.0]]), (4.0, 1.0))
    assert bent[0].points.tolist() == [[0, 0], [2, 0], [2, 2]]


@pytest.mark.parametrize("upright", [False, True])
@pytest.mark.parametrize("length", [3.0, 12.0, 60.0])
def test_a_dimension_spans_what_it_says(length, upright):
    turn = (lambda p: p[::-1]) if upright else (lambda p: p)
    a, b = np.array(turn((5.0, 1.0))), np.array(turn((5.0 + length, -4.0)))
    lines, (text,) = dimension(a, b, 20.0, upright, "x ")
    assert text.text == f"x {length:.1f}"
    shafts = [turn(line.points.T) for line in lines if len(line.points) == 2]
    level = [u for u, v in shafts if np.allclose(v, 20.0)]
    assert any(np.allclose(sorted(u), [5.0, 5.0 + length]) for u in level)
    assert dimension(a, a, 20.0, upright) == ((), ())


def test_what_runs_on_a_line_is_taken_away():
    square = np.array([[0, 0], [10, 0], [10, 10], [0, 10]], dtype=float)
    lines = no_line_twice(
        (
            polyline("MARK", (-5, 0), (4, 0)),
            Line("REF", square, closed=True),
            polyline("NOTE", (5, -5), (5, 15)),
            polyline("NOTE", (10, 2), (10, 8)),
        )
    )
    assert len(lines) == 3
    assert not lines[1].closed
    assert LineString(lines[1].points).length == pytest.approx(36.0, abs=0.1)
    assert lines[2].points.tolist() == [[5, -5], [5, 15]]


def test_callouts_keep_off_everything():
    wall = polyline("MARK", (5, -30), (5, 30))
    wanted = [Callout(f"number {k}", np.array([0.0, 0.0]), 0.0) for k in range(6)]
    lines, texts = lettered(wanted, [wall], [])
    assert_lettering_clear(Drawing("", (wall, *lines[::2]), texts))
    tips = [line.points[1] for line in lines[::2]]
    assert all(tip.tolist() == [0, 0] for tip in tips)
    assert all(a.box != b.box for a, b in pairwise(texts))
