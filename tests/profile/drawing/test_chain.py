"""Lines joined into one profile."""

import numpy as np
import pytest

from profiletool.errors import NoObject
from tests.profile.drawing.drawings import SQUARE, assert_circle, assert_same_ring


def test_csv_ends_within_the_tolerance_are_one(load):
    found = load("a.csv", "0,0\n10,0\n10,10\n0,0.04\n")
    assert found.closed
    assert found.points.tolist() == [[0, 0.02], [10, 0], [10, 10]]
    assert not load("a.csv", "0,0\n10,0\n10,10\n0,0.4\n").closed
    near = load("a.csv", "0,0\n10,0\n10,10\n0,0.06\n")
    assert near.closed
    assert near.notes == ("the outline's ends are 0.06 mm apart at (0.0, 0.0): it was closed",)


@pytest.mark.parametrize(
    "text",
    [
        "0,0\n10,10\n10,0\n0,10\n0,0\n",  # a bow tie
        "0,0\n10,10\n10,0\n0,10\n",  # open, but crossing
        "0,0\n10,0\n5,0\n5,5\n0,0\n",  # back over itself
    ],
)
def test_line_that_crosses_itself(load, text):
    with pytest.raises(NoObject, match="crosses or touches itself"):
        load("a.csv", text)


def test_dxf_lines_join_whatever_their_order_and_direction(dxf):
    def draw(msp, _):
        msp.add_line((20, 0), (20, 10))
        msp.add_line((0, 0), (20, 0.03))
        msp.add_line((0, 0), (0, 10))
        msp.add_line((0.03, 10), (20, 10))

    assert_same_ring(dxf(draw), SQUARE, atol=0.03)


def test_dxf_doubled_lines_count_once(dxf):
    def draw(msp, _):
        for a, b in zip(SQUARE, SQUARE[1:] + SQUARE[:1], strict=True):
            msp.add_line(a, b)
            msp.add_line(b, a)

    assert_same_ring(dxf(draw), SQUARE)


def test_dxf_open_chain_of_line_and_arc(dxf):
    def draw(msp, _):
        msp.add_arc((0, 0), radius=30, start_angle=0, end_angle=90)
        msp.add_line((30, -20), (30, 0))

    found = dxf(draw)
    assert not found.closed
    ends = sorted(found.points[[0, -1]].round(6).tolist())
    assert ends == [[0, 30], [30, -20]]
    arc = found.points[found.points[:, 1] >= -1e-9]
    np.testing.assert_allclose(np.hypot(*arc.T), 30, atol=1e-5)


def test_dxf_curve_in_crumbs_stays_whole(dxf):
    angle = np.linspace(0, 2 * np.pi, 3001)
    ring = 10 * np.column_stack([np.cos(angle), np.sin(angle)])  # pieces of 0.02 mm

    def draw(msp, _):
        for a, b in zip(ring[:-1].tolist(), ring[1:].tolist(), strict=True):
            msp.add_line(a, b)

    found = dxf(draw)
    assert len(found.points) == 3000
    assert_circle(found, (0, 0), 10)


def test_dxf_the_outer_of_several(dxf):
    def draw(msp, _):
        msp.add_lwpolyline(SQUARE, close=True)
        msp.add_circle((5, 5), 2)
        msp.add_line((8, 5), (12, 5))

    assert_same_ring(dxf(draw), SQUARE)


def test_dxf_crumbs_beside_the_profile(dxf):
    def draw(msp, _):
        msp.add_lwpolyline([(0, 0), (5, -60), (0, -120)])
        msp.add_circle((100, 0), 1)

    assert dxf(draw).points.tolist() == [[0, 0], [5, -60], [0, -120]]
