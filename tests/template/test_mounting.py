"""The mounting drawing as a whole."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from itertools import combinations
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely import LineString, Polygon

from profiletool.template.dxf import write_dxf
from profiletool.template.mounting import mounting_drawing
from tests.template.geometry import coincident, read_back, segments
from tests.template.mounts import (
    CASES,
    COLOURS,
    assert_lettering_clear,
    ball,
    case,
    drawing_of,
    drum,
    dxf_of,
    every_case,
    made,
    on,
    plan,
    said,
    wave,
)

# Every third: three fingers, one around a neck, one on a line, one thin.
some_cases = pytest.mark.parametrize(
    "name",
    [
        name if k % 3 == 0 else pytest.param(name, marks=pytest.mark.slow)
        for k, name in enumerate(CASES)
    ],
)


@some_cases
def test_dxf_reads_back(name):
    drawing = drawing_of(name)
    doc = read_back(dxf_of(name))
    assert doc.header["$INSUNITS"] == 4
    assert {name: doc.layers.get(name).color for name in COLOURS} == COLOURS
    entities = list(doc.modelspace())
    assert {entity.dxftype() for entity in entities} == {"LWPOLYLINE"}
    counts = Counter(entity.dxf.layer for entity in entities)
    assert counts == {layer.name: len(layer.lines) for layer in drawing.layers}
    fingers = {"three": 3, "two": 2}.get(name.split()[0], 1)
    assert counts["CUT_OUTER"] == 1
    assert counts["CUT_INNER"] == 2 * fingers + (name == "three around a neck")
    assert all(e.closed for e in entities if e.dxf.layer.startswith("CUT"))


@some_cases
def test_the_same_design_gives_the_same_bytes(name):
    assert dxf_of(name) == write_dxf(mounting_drawing(*made(name)))


@every_case
def test_no_line_is_drawn_twice(name):
    assert coincident(segments(SimpleNamespace(drawing=drawing_of(name)))) == []


@every_case
def test_lettering_stands_clear(name):
    assert_lettering_clear(drawing_of(name))


@every_case
def test_the_side_view_clamp_stands_at_the_base(name):
    """It runs back from the base against the heading, as long as the clamp, as wide as the tube."""
    design = made(name)[0]
    pose = design.base_pose
    length = -design.clamp.length_mm
    way = np.array([np.cos(np.radians(pose.heading_deg)), np.sin(np.radians(pose.heading_deg))])
    # The object lies to the left of the way on the left side, so the tube to its right.
    out = np.array([way[1], -way[0]]) * (1.0 if design.source.side == "left" else -1.0)
    base, D = np.array([pose.x_mm, pose.y_mm]), design.tube.outer_diameter_mm
    expected = Polygon([base, base + length * way, base + length * way + D * out, base + D * out])
    found = [Polygon(c) for c in on(drawing_of(name), "MARK") if len(c) == 4]
    assert min(c.symmetric_difference(expected).area for c in found) < 1e-6


def test_a_drawn_line_stands_for_the_object():
    profile = made("one on a line")[1]
    drawing = drawing_of("one on a line")
    line = LineString(profile.points)
    grey = [LineString(p) for p in on(drawing, "REF", closed=False)]
    assert max(p.length for p in grey if line.buffer(0.05).covers(p)) > 0.95 * line.length
    assert "body of revolution" not in said(drawing)
    assert "0: middle of the tube's open end" in said(drawing)
    x, y = profile.points[0]
    assert f"base point: x {x:.1f}, y {y:.1f}" in said(drawing)
    clamps = plan(drawing)[2]
    assert np.ptp(clamps[0], axis=0) == pytest.approx([20.0, 20.0])  # true size, steep as it is


def test_outline_target_and_tubes_are_mounting_drawing():
    design, profile, straight, bent = case(ball(), start=10.0, clearance=4.0)
    drawing = mounting_drawing(design, profile, straight, bent)
    assert any(
        Polygon(p).symmetric_difference(Polygon(ball())).area < 5.0 for p in on(drawing, "REF")
    )
    paths = [LineString(line.points) for line in drawing.drawn if line.layer in ("REF", "NOTE")]
    for shape, least in ((bent.facing, 0.9), (bent.far, 0.9), (straight.far, 0.5)):
        free = LineString(shape)
        cover = free.buffer(0.05)
        assert sum(p.intersection(cover).length for p in paths) > least * free.length
    target = LineString(profile.points).buffer(0.05)
    notes = [LineString(line.points) for line in drawing.drawn if line.layer == "NOTE"]
    assert sum(p.intersection(target).length for p in notes) > 0.95 * profile.length_mm


def test_left_and_right_mirror_each_other():
    left, right = (
        plan(mounting_drawing(*case(drum(), side, start=25.0)))[1] for side in ("left", "right")
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
    assert "runs into the palm" in said(
        mounting_drawing(*case(wave(), closed=False, away=True, root=5.0))
    )
    assert "runs into the palm" not in said(drawing_of("one on a line"))


def test_the_bar_is_100_mm():
    bars = [p for p in on(drawing_of("two"), "REF", closed=False) if len(p) == 2]
    assert any(np.ptp(p, axis=0) == pytest.approx([100.0, 0.0]) for p in bars)


@pytest.mark.slow
@settings(max_examples=5, deadline=None)
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
