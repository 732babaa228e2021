"""The sheet: slits, outline, lettering."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely import LineString, Polygon, STRtree, box

from profiletool.joints.windows import best_seam
from profiletool.template.kinds import KINDS, Wish
from profiletool.template.layout import build_sheet
from tests.template.designs import bulb, design_of, joint, long_tube, short_tube, skew, tight
from tests.template.geometry import coincident, segments

DESIGNS = [bulb, short_tube, long_tube, skew]


of_all_kinds = pytest.mark.parametrize("wish", [Wish(kind) for kind in KINDS], ids=list(KINDS))


def test_coincident_segments_are_seen():
    found = [[(0, 0), (5, 0)], [(9, 0), (4, 0)], [(2, -1), (2, 1)], [(5, 0), (5, 3)]]
    assert coincident(np.array(found, float)) == [(0, 1)]
    assert coincident(np.array([[(0, 0), (1, 2)], [(-1, -2), (3, 6)]], float)) == [(0, 1)]


@of_all_kinds
@pytest.mark.parametrize("build", [*DESIGNS, tight])
def test_no_line_is_drawn_twice(build, wish):
    assert coincident(segments(build_sheet(build(), wish))) == []


@of_all_kinds
@pytest.mark.parametrize("build", [*DESIGNS, tight])
def test_slits_lie_inside_the_outline(build, wish):
    sheet = build_sheet(build(), wish)
    piece = Polygon(sheet.outline)
    assert piece.is_valid
    assert piece.exterior.is_ccw
    for slit in sheet.slits:
        assert piece.covers(LineString([(slit.x_mm, slit.y_start_mm), (slit.x_mm, slit.y_end_mm)]))


@pytest.mark.parametrize("build", DESIGNS)
def test_outline_is_tube_and_clamp_with_a_notch_at_the_clamps_edge(build):
    design = build()
    sheet = build_sheet(design)
    length, roll = sheet.size_mm
    assert length == design.tube.length_mm + design.clamp.length_mm
    np.testing.assert_allclose(sheet.outline.min(axis=0), [-design.clamp.length_mm, 0])
    np.testing.assert_allclose(sheet.outline.max(axis=0), [design.tube.length_mm, roll])
    notch = box(*sheet.outline.min(axis=0), *sheet.outline.max(axis=0)).difference(
        Polygon(sheet.outline)
    )
    assert notch.area == pytest.approx(4.5)
    assert notch.bounds == pytest.approx((-3, 0, 0, 3))  # its straight side is x = 0


@of_all_kinds
@pytest.mark.parametrize("build", DESIGNS)
def test_the_clamps_edge_is_marked_from_the_notch_to_the_end_edge(build, wish):
    sheet = build_sheet(build(), wish)
    marks = [x.points for x in sheet.drawing.drawn if x.layer == "MARK" and len(x.points) == 2]
    edge = [p[:, 1] for p in marks if np.all(p[:, 0] == 0.0) and p.min() > 0.0 - 1e-9]
    inside = [y for y in edge if y.min() > 0 and y.max() < sheet.outline[:, 1].max()]
    assert sum(np.ptp(y) for y in inside) > sheet.outline[:, 1].max() - 7.0
    assert "x = 0: edge of the clamp" in {text.text for text in sheet.drawing.texts}


@of_all_kinds
@pytest.mark.parametrize("build", [*DESIGNS, tight])
def test_lettering_stands_clear(build, wish):
    """No text meets another one, a slit, the outline or any other line."""
    sheet = build_sheet(build(), wish)
    boxes = [box(*text.box) for text in sheet.drawing.texts]
    assert [(a, b) for a, b in combinations(boxes, 2) if a.intersects(b)] == []
    others = [LineString(line.points) for line in sheet.drawing.drawn if len(line.points) < 10]
    named = [layer for layer in sheet.drawing.layers if layer.name.startswith("CUT")]
    cuts = [line.points for layer in named for line in layer.lines]
    others += [LineString(np.vstack([line, line[:1]])) for line in cuts]
    tree = STRtree(others)
    assert tree.query([b.buffer(0.2) for b in boxes], predicate="intersects").size == 0


@pytest.mark.parametrize("build", DESIGNS)
def test_every_joint_is_named_on_every_turn(build):
    design = build()
    sheet = build_sheet(design)
    middle = sheet.size_mm[1] / 2
    for j in design.joints:
        own = [t for t in sheet.drawing.texts if t.text == str(j.number) and t.layer == "MARK"]
        inside = [t for t in own if 0 < t.y < sheet.size_mm[1]]
        assert len(own) == 4
        assert [t.y > middle for t in inside] == [False, True]
        assert all(abs(np.mean(t.box[::2]) - j.centre_mm) < 8 for t in inside)
        small = f"{j.openF_mm:g}/{j.alpha_closed_deg:g}°"
        assert sum(t.text == small for t in sheet.drawing.texts) >= 2
    assert min(text.height for text in sheet.drawing.texts) >= 2.5


def test_register_line_is_one_turn_before_the_end_and_open_at_the_crossing():
    sheet = build_sheet(bulb())
    y = 2 * np.pi * 10.25
    pieces = [line.points for line in sheet.drawing.drawn if np.allclose(line.points[:, 1], y)]
    inside = [p for p in pieces if p[:, 0].max() < 103]
    assert len(inside) == 2
    cut = [slit.x_mm for slit in sheet.slits if slit.joint == 6]
    assert inside[0].max() > 60
    assert inside[0][:, 0].max() < min(cut) < max(cut) < inside[1][:, 0].min()


def said(design):
    return " ".join(text.text for text in build_sheet(design).drawing.texts)


def test_sheet_says_what_is_wrong():
    good = said(short_tube())
    assert "NOT VERIFIED" in good
    assert "INFEASIBLE" not in good
    assert "crosses" not in good
    bad = said(tight())
    assert "INFEASIBLE" in bad
    assert "Joint 12: rows beyond" in bad
    assert "Joint 6: cut crosses the weld line" in said(bulb())
    assert "NOT VERIFIED" not in said(bulb())
    assert build_sheet(tight()).drawing.title.endswith("INFEASIBLE - NOT VERIFIED")
    assert "only 1.2 mm from the weld line" in said(skew())


def test_sheet_refuses_a_gauze_without_turns():
    with pytest.raises(ValueError, match="at least one turn"):
        build_sheet(replace(bulb(), gauze=replace(bulb().gauze, turns=0)))


@pytest.mark.parametrize("turns", [1, 3])
def test_other_turns(turns):
    design = replace(bulb(), gauze=replace(bulb().gauze, turns=turns))
    sheet = build_sheet(design)
    assert coincident(segments(sheet)) == []
    assert any("Register" in text.text for text in sheet.drawing.texts) == (turns > 1)


@settings(max_examples=15, deadline=None)
@given(
    rows=st.lists(
        st.tuples(
            st.floats(10, 25),
            st.sampled_from([6, 8, 10, 14]),
            st.floats(60, 180),
            st.floats(0, 360),
        ),
        min_size=1,
        max_size=6,
    )
)
def test_any_design_gives_a_clean_sheet(rows):
    at, joints = 10.0, []
    for k, (F, openF, alpha, center) in enumerate(rows, start=1):
        joints.append(joint(k, F, openF, alpha, center, at=at))
        at += F
    sheet = build_sheet(design_of(joints, at))
    assert sheet.seam == best_seam(joints)
    piece = Polygon(sheet.outline).buffer(1e-9)
    assert all(piece.covers(LineString(line.points)) for line in sheet.drawing.layers[1].lines)
    assert coincident(segments(sheet)) == []
