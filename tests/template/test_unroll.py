"""The roll of gauze laid flat."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from profiletool.joints.roll import Roll, roll_of, window_intervals
from profiletool.joints.windows import best_seam
from profiletool.records.design import Gauze, Tube
from profiletool.template.unroll import sheet_size, slits
from tests.template.designs import bulb, joint, long_tube, short_tube, skew
from tests.template.geometry import angle_off

DESIGNS = [bulb, short_tube, long_tube, skew]


TWICE = Roll(10.125, 0.25, 2)


@pytest.mark.parametrize(
    ("D", "t", "turns", "length"),
    [
        (20.0, 0.25, 1, 64.40264939859075),  # 2 pi (10.125 + 0.125)
        (20.0, 0.25, 2, 130.37609512),  # 4 pi (10.125 + 0.25)
        (20.0, 0.0, 2, 125.66370614),  # 4 pi 10
        (12.0, 0.5, 3, 131.94689145),  # 6 pi (6.25 + 0.75)
    ],
)
def test_roll_length_closed_form(D, t, turns, length):
    assert Roll((D + t) / 2, t, turns).length_mm == pytest.approx(length, abs=1e-8)


def test_length_is_the_integral_of_the_radius():
    phi = np.linspace(0, 720, 200_001)
    r = 10 + 0.125 + 0.25 * np.radians(phi) / (2 * np.pi)
    assert TWICE.length_mm == pytest.approx(np.trapezoid(r, np.radians(phi)), abs=1e-8)


@settings(deadline=None)
@given(D=st.floats(5, 60), t=st.floats(0, 1), phi=st.floats(0, 1440), turns=st.integers(1, 4))
def test_phi_inverts_y(D, t, phi, turns):
    roll = Roll((D + t) / 2, t, turns)
    assert roll.phi_deg(roll.y_mm(phi)) == pytest.approx(phi, abs=1e-9)


def test_sheet_size():
    assert sheet_size(bulb()) == pytest.approx((123.0, 130.376095), abs=1e-6)


@pytest.mark.parametrize("build", DESIGNS)
def test_windows_roll_back_onto_their_angles(build):
    """Each slit's ends, rolled up, lie on the edges of a joint's cut, or on the sheet's edge."""
    design = build()
    roll = roll_of(design.tube, design.gauze)
    by_number = {j.number: j for j in design.joints}
    for slit in slits(design.joints, design.tube, design.gauze):
        j = by_number[slit.joint]
        opening = j.alpha_center_deg + j.alpha_closed_deg / 2
        closing = j.alpha_center_deg - j.alpha_closed_deg / 2
        for y, edge, sheet_edge in (
            (slit.y_start_mm, opening, 0.0),
            (slit.y_end_mm, closing, roll.length_mm),
        ):
            if y == pytest.approx(sheet_edge, abs=1e-12):
                assert j.number in best_seam(design.joints).crossed
                continue
            off = angle_off(roll.phi_deg(y) + design.gauze.seam_deg, edge)
            assert off < 1e-9
            assert np.radians(off) * 10.5 < 0.2


@pytest.mark.parametrize("turns", [1, 2, 3])
@settings(deadline=None)
@given(
    alpha=st.integers(1, 359),
    center=st.integers(0, 359),
    seam=st.integers(0, 359),
    fraction=st.floats(0, 1),
)
def test_cut_covers_what_is_not_uncut(turns, alpha, center, seam, fraction):
    """On every turn a point of the sheet is in a window just where its angle is in the cut."""
    j = joint(alpha=alpha, center=center)
    windows = window_intervals(j, seam, Roll(10.125, 0.25, turns))
    assert np.ptp(windows, axis=1).sum() == pytest.approx(turns * (360 - alpha), abs=1e-6)
    phi = fraction * 360 * turns
    off = angle_off(phi + seam, center)
    if abs(off - alpha / 2) > 1e-6 and 1e-6 < phi < 360 * turns - 1e-6:
        assert np.any((windows[:, 0] < phi) & (phi < windows[:, 1])) == (off > alpha / 2)


@pytest.mark.parametrize(
    ("seam", "expected"),
    [
        (270, [[66, 294], [426, 654]]),
        (90, [[0, 114], [246, 474], [606, 720]]),
        (336, [[0, 228], [360, 588]]),
        (204, [[132, 360], [492, 720]]),
    ],
)
def test_window_intervals(seam, expected):
    np.testing.assert_allclose(window_intervals(joint(alpha=132), seam, TWICE), expected, atol=1e-9)


def test_nothing_and_everything_cut():
    assert window_intervals(joint(alpha=360), 270, TWICE).shape == (0, 2)
    np.testing.assert_array_equal(window_intervals(joint(alpha=0), 270, TWICE), [[0, 720]])


def test_alpha_beyond_the_circle_is_refused():
    with pytest.raises(ValueError, match="joint 1"):
        window_intervals(joint(alpha=361), 270, TWICE)


def test_bulb_slits():
    design = bulb()
    cuts = slits(design.joints, design.tube, design.gauze)
    rows = {j.number: round(j.openF_mm / 2) for j in design.joints}
    for number, n in rows.items():
        assert sum(cut.joint == number for cut in cuts) == n * (3 if number == 6 else 2)
    assert [cut.joint for cut in cuts] == sorted(cut.joint for cut in cuts)
    crossing = [cut for cut in cuts if cut.joint == 6][:3]
    assert crossing[0].y_start_mm == 0
    assert crossing[2].y_end_mm == roll_of(design.tube, design.gauze).length_mm


def test_overlapping_joints_share_their_slits():
    rows = (joint(1, alpha=100, center=270, at=20), joint(2, alpha=100, center=200, at=24))
    cuts = slits(rows, Tube(20, 2, 20, 60), Gauze(2, 0.25, 2, 235.0))
    for a in cuts:
        for b in cuts:
            if a is not b and a.x_mm == b.x_mm:
                assert a.y_end_mm < b.y_start_mm or b.y_end_mm < a.y_start_mm
    shared = [cut for cut in cuts if cut.x_mm == 21]
    assert {cut.joint for cut in shared} == {1}
    # Uncut in both: 220..250 deg, so two turns of 330 deg are cut.
    spans = [float(TWICE.phi_deg(c.y_end_mm) - TWICE.phi_deg(c.y_start_mm)) for c in shared]
    assert sum(spans) == pytest.approx(660)


def test_rows_beyond_the_tube_are_left_out():
    cuts = slits((joint(at=2, openF=8),), Tube(20, 2, 2, 40), Gauze(2, 0.25, 2, 270.0))
    assert sorted({cut.x_mm for cut in cuts}) == [1, 3, 5]
