"""Gauze, sleeve and strip: the slits wrapped back onto the tube, and what the kerf takes away."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from shapely import LineString, Polygon

from profiletool.errors import UsageError
from profiletool.template.dxf import write_dxf
from profiletool.template.kinds import KINDS, Wish
from profiletool.template.layout import build_sheet
from profiletool.template.unroll import slits
from tests.template.designs import bulb, design_of, joint, long_tube, short_tube, skew, tight
from tests.template.geometry import read_back

DESIGNS = [bulb, short_tube, skew, tight, pytest.param(long_tube, marks=pytest.mark.slow)]
AXIS = np.array([1.0, 0.0, 0.0])  # along the tube, to its closed end


def around(angle_deg):
    """Unit vector out of the tube at an angle, counter-clockwise as seen from the closed end."""
    a = np.radians(angle_deg)
    return np.array([0.0, np.cos(a), np.sin(a)])


def angle_of(outward):
    return np.degrees(np.arctan2(outward[2], outward[1]))


def rolled_up(design, step=0.005):
    """Tell angle (deg), radius (mm) and turn of points along a sheet that the tube rolls up.

    The tube lies on the sheet and rolls toward +y: bit by bit the sheet sticks to its lowest
    line, which wanders counter-clockwise around it, one thread further out after each turn.
    """
    thread = design.gauze.thread_mm
    r, turned = [design.tube.outer_diameter_mm / 2 + thread / 2], [0.0]
    while turned[-1] < 4 * np.pi + 0.01:
        turned.append(turned[-1] + step / r[-1])
        r.append(r[0] + thread * turned[-1] / (2 * np.pi))
    places = step * np.arange(len(r))

    def at(y):
        phi = np.interp(y, places, turned)
        return design.gauze.seam_deg + np.degrees(phi), np.interp(y, places, r), phi // (2 * np.pi)

    return at


def wrapped_around(design, y, radius):
    """Angle (deg) of a point ``y`` up a sheet of a middle radius, wrapped face outside.

    Whoever looks at its face has x on the right and y up, so that up is outward cross axis.
    """
    n = around(design.gauze.seam_deg)
    n = np.cos(y / radius) * n + np.sin(y / radius) * np.cross(n, AXIS)
    return angle_of(n)


def cut_lines(design, wish):
    doc = read_back(write_dxf(build_sheet(design, wish).drawing))
    lines = doc.modelspace().query('LWPOLYLINE[layer=="CUT_INNER"]')
    return [np.array([p[:2] for p in line.get_points()]) for line in lines]


def off_window(design, x, angle, edges):
    """Distance (deg) from an angle to the nearest edge of a joint's cut whose rows hold x."""
    here = [j for j in design.joints if abs(x - j.centre_mm) < j.openF_mm / 2 + 1e-6]
    assert here, f"a slit at {x} is in no joint"
    wanted = [j.alpha_center_deg + side * j.alpha_closed_deg / 2 for j in here for side in edges]
    return min(abs((angle - edge + 180) % 360 - 180) for edge in wanted)


@pytest.mark.parametrize("build", DESIGNS)
def test_slits_roll_back_onto_their_windows_on_both_turns(build):
    design = build()
    sheet = build_sheet(design)
    place = rolled_up(design)
    seen = {j.number: set() for j in design.joints}
    for line in cut_lines(design, Wish()):
        for y, edge, side in zip(line[:, 1], (0.0, sheet.size_mm[1]), (1, -1), strict=True):
            if abs(y - edge) < 1e-6:
                continue  # it runs out of the sheet: the seam is in this cut
            angle, r, turn = place(y)
            assert np.radians(off_window(design, line[0, 0], angle, (side,))) * r < 0.2
            for j in design.joints:
                if abs(line[0, 0] - j.centre_mm) < j.openF_mm / 2:
                    seen[j.number].add(turn)
    assert all(turns == {0, 1} for turns in seen.values())


@pytest.mark.parametrize(("variant", "radius"), [("sleeve", 10.125), ("strip", 10.55)])
@pytest.mark.parametrize("build", DESIGNS)
def test_slits_of_one_turn_lie_on_their_windows(build, variant, radius):
    design = build()
    sheet = build_sheet(design, Wish(variant))
    assert sheet.size_mm[1] == pytest.approx(2 * np.pi * radius)
    for line in cut_lines(design, Wish(variant)):
        for y, edge, side in zip(line[:, 1], (0.0, sheet.size_mm[1]), (-1, 1), strict=True):
            if abs(y - edge) > 1e-6:
                angle = wrapped_around(design, y, radius)
                assert np.radians(off_window(design, line[0, 0], angle, (side,))) * radius < 0.01


def test_a_sheet_the_wrong_way_round_is_seen():
    """A joint that bends out of plane tells the two faces of the sheet apart."""
    design = design_of([joint(center=240.0, alpha=100.0, at=15.0)], 30.0)
    tilted = replace(design, gauze=replace(design.gauze, seam_deg=270.0))
    rolled = slits(tilted.joints, tilted.tube, replace(tilted.gauze, turns=1))
    wrapped = slits(tilted.joints, tilted.tube, tilted.gauze, "strip")
    assert rolled[0].y_start_mm / 10 == pytest.approx(np.radians(20), rel=0.05)
    assert wrapped[0].y_start_mm / 10 == pytest.approx(np.radians(80), rel=0.06)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("build", [bulb, skew])
def test_the_kerf_leaves_the_piece_its_size(build, kind):
    kerf = 0.3
    sheet, plain = build_sheet(build(), Wish(kind, kerf)), build_sheet(build(), Wish(kind))
    assert sheet.slits == plain.slits
    drawn = {layer.name: layer.lines for layer in sheet.drawing.layers}
    (contour,), cuts = drawn["CUT_OUTER"], drawn["CUT_INNER"]
    left = Polygon(contour.points).buffer(-kerf / 2, join_style="mitre", mitre_limit=20.0)
    assert left.hausdorff_distance(Polygon(plain.outline)) < 1e-6
    assert len(cuts) == len(sheet.slits)
    roll = sheet.size_mm[1]
    for line, slit in zip(cuts, sheet.slits, strict=True):
        _, y0, _, y1 = LineString(line.points).buffer(kerf / 2).bounds
        for y, end, edge in ((y0, slit.y_start_mm, 0.0), (y1, slit.y_end_mm, roll)):
            assert abs(y - end) < 1e-6 or end == pytest.approx(edge)


def test_a_slit_no_longer_than_the_kerf_is_left_out_and_told():
    # 2 deg of the cut lie across the seam: 0.36 mm of slit, open at the end edge.
    near = design_of([joint(alpha=180.0, center=270.0, at=15.0)], 30.0)
    design = replace(near, gauze=replace(near.gauze, seam_deg=2.0))
    assert "left out" not in said(design, Wish(kerf_mm=0.6))
    assert "! 4 slits no longer than the kerf are left out" in said(design, Wish(kerf_mm=0.8))
    assert len(cut_lines(design, Wish())) - len(cut_lines(design, Wish(kerf_mm=0.8))) == 4


@pytest.mark.parametrize("kerf", [-0.1, 1.75, float("nan")])
def test_a_kerf_that_burns_hoop_threads_is_refused(kerf):
    with pytest.raises(UsageError, match="does not pass between hoop threads"):
        build_sheet(bulb(), Wish(kerf_mm=kerf))


def said(design, wish):
    return " ".join(text.text for text in build_sheet(design, wish).drawing.texts)


def test_date_and_kerf_are_printed():
    plain = said(bulb(), Wish())
    assert "Kerf 0." in plain
    told = said(bulb(), Wish(kerf_mm=0.15, date="26 Nov\n2026"))
    assert "Kerf 0.15." in told
    assert "26 Nov2026" in told


def test_each_kind_says_what_it_is():
    for kind, words in {
        "gauze": ("Cut template: bulb.png", "weld end edge here", "Turn 2", "Roll this way"),
        "sleeve": ("Sleeve template: bulb.png", "One layer where the design has 2"),
        "strip": ("Marking strip: bulb.png", "Prick through", "Roll gauze of 123 x 130.4 mm twice"),
    }.items():
        text = said(bulb(), Wish(kind))
        assert all(word in text for word in words)
    assert "Turn 1" not in said(bulb(), Wish("strip"))
    assert "weld line" not in said(bulb(), Wish("sleeve"))


def test_the_strip_has_a_tab_beyond_its_register_line():
    sheet = build_sheet(bulb(), Wish("strip"))
    assert np.ptp(sheet.outline[:, 1]) == pytest.approx(sheet.size_mm[1] + 8.0)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("build", [bulb, long_tube, skew, short_tube])
def test_piece_and_notes_fit_a_page_each(build, kind):
    """A4 with margins of 5 mm, and a strip of 10 mm for the page's foot."""
    for part in build_sheet(build(), Wish(kind)).parts:
        x0, y0, x1, y1 = part.bounds
        wide, tall = max(x1 - x0, y1 - y0), min(x1 - x0, y1 - y0)
        assert wide <= 287
        assert tall <= (190 if wide > 200 else 200)
