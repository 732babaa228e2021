"""The weld line, and rows of cut cells."""

from __future__ import annotations

import csv
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from profiletool.joints.windows import best_seam, off_mesh, seam_at, slit_rows
from tests.template.designs import bulb, design_of, joint, row_of_joints
from tests.template.geometry import angle_off


@pytest.mark.parametrize(
    ("openF", "pitch", "rows"),
    [(8, 2, [7, 9, 11, 13]), (6, 2, [8, 10, 12]), (6, 1.5, [7.75, 9.25, 10.75, 12.25])],
)
def test_rows_sit_in_the_middle_of_the_cells(openF, pitch, rows):
    np.testing.assert_allclose(slit_rows(joint(openF=openF, at=10), pitch), rows)


def test_seam_of_equal_joints_is_the_middle_of_their_uncut_sector():
    choice = best_seam([joint(k, alpha=60 + 12 * k, center=270) for k in range(1, 6)])
    assert (choice.seam_deg, choice.crossed, choice.margin_deg) == (270, (), 36)


def test_seam_of_the_bulb_crosses_least(shared):
    with (shared / "reference" / "table5_bulb.csv").open() as file:
        rows = [tuple(map(float, list(row.values())[1:])) for row in csv.DictReader(file)]
    joints = bulb().joints
    assert rows == [
        (j.F_mm, j.openF_mm, j.alpha_closed_deg, j.alpha_center_deg, j.theta_target_deg)
        for j in joints
    ]
    choice = best_seam(row_of_joints(rows))
    assert (choice.seam_deg, choice.crossed, choice.margin_deg) == (270, (6,), 66)


def test_seam_in_a_narrow_common_sector():
    choice = best_seam([joint(1, alpha=90, center=200), joint(2, alpha=90, center=280)])
    assert (choice.seam_deg, choice.crossed, choice.margin_deg) == (240, (), 5)


def test_seam_among_equal_crossings_takes_the_wider_margin():
    choice = best_seam([joint(1, alpha=100, center=270), joint(2, alpha=140, center=90)])
    assert (choice.seam_deg, choice.crossed, choice.margin_deg) == (90, (1,), 70)


def test_touching_sectors_leave_no_place_for_a_seam():
    """The sliver that rounding leaves between two uncut sectors is no common sector."""
    choice = best_seam([joint(1, 19, 6, 80, 200), joint(2, 19, 8, 80, 280 - 1e-9)])
    assert choice.crossed == (1,)
    assert choice.seam_deg == pytest.approx(280, abs=1e-6)


def test_seam_without_joints_faces_the_object():
    assert best_seam([]).seam_deg == 270


WILD = st.lists(
    st.tuples(st.integers(3, 7).map(lambda n: 2 * n), st.integers(10, 350), st.integers(0, 359)),
    min_size=1,
    max_size=6,
)


def wild_joints(rows, turned=0):
    return [joint(k, 20, o, a, (c + turned) % 360) for k, (o, a, c) in enumerate(rows, start=1)]


@settings(deadline=None)
@given(rows=WILD, turned=st.integers(0, 359))
def test_turning_all_joints_turns_the_seam(rows, turned):
    here, there = best_seam(wild_joints(rows)), best_seam(wild_joints(rows, turned))
    assert angle_off(there.seam_deg, here.seam_deg + turned) < 1e-6
    assert there.crossed == here.crossed
    assert there.margin_deg == pytest.approx(here.margin_deg)


@pytest.mark.slow
@settings(max_examples=30, deadline=None)
@given(rows=WILD)
def test_no_place_on_the_circle_is_better(rows):
    joints = wild_joints(rows)
    openF = {j.number: j.openF_mm for j in joints}
    best = best_seam(joints)
    for place in np.arange(0.25, 360, 0.5):
        other = seam_at(joints, float(place))
        cost, least = (sum(openF[k] for k in seam.crossed) for seam in (other, best))
        assert least <= cost
        if cost == least:
            assert other.margin_deg <= best.margin_deg + 1e-9


def test_rows_off_the_mesh_of_the_others():
    assert off_mesh(bulb().joints, bulb().gauze) == (2, 4)
    assert off_mesh(bulb().joints, replace(bulb().gauze, pitch_mm=1.0)) == ()
    assert off_mesh((), bulb().gauze) == ()


def test_design_helper_takes_the_best_seam():
    assert design_of([joint(center=90)], 40).gauze.seam_deg == 90
