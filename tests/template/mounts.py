"""Mounting drawings of a dozen designs, and what is read off them."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from itertools import combinations

import numpy as np
import pytest
from shapely import LineString, Polygon, STRtree, box

from profiletool.bending.kinematics import Bend, deform
from profiletool.profile.target import Reach, profile_of_line, profile_of_object
from profiletool.records.frames import Pose
from profiletool.records.seal import sealed
from profiletool.template.drawing import Drawing
from profiletool.template.dxf import write_dxf
from profiletool.template.mounting import mounting_drawing
from tests.template.designs import design_of, row_of_joints

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
    right = np.array([[25, -125], [25, -85], [12, -60], [12, 0]], dtype=float)
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
    return sealed(design), profile, *shapes


CASES = {
    "three on a flat top": lambda: case(drum(), start=25.0),
    "three to the right": lambda: case(drum(), "right", start=25.0),
    "three on a slope": lambda: case(ball(), start=38.0),
    "three around a neck": lambda: case(bottle(), start=40.0),
    "two": lambda: case(drum(), start=16.0),
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
