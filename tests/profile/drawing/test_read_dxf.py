"""Drawings as DXF."""

import logging

import numpy as np
import pytest
import shapely

from profiletool.errors import NoObject, UnreadableInput
from tests.profile.drawing.drawings import SQUARE, assert_circle, assert_same_ring, dxf_text


def test_dxf_circle(dxf):
    assert_circle(dxf(lambda msp, _: msp.add_circle((5, -3), 30)), (5, -3), 30)


def test_dxf_circle_seen_from_below(dxf):
    found = dxf(lambda msp, _: msp.add_circle((5, -3), 30, dxfattribs={"extrusion": (0, 0, -1)}))
    assert_circle(found, (-5, -3), 30)


def test_dxf_ellipse(dxf):
    found = dxf(lambda msp, _: msp.add_ellipse((1, 2), major_axis=(20, 0), ratio=0.5))
    assert found.closed
    x, y = (found.points - (1, 2)).T
    np.testing.assert_allclose((x / 20) ** 2 + (y / 10) ** 2, 1, atol=1e-5)


def test_dxf_bulge_is_a_half_circle(dxf):
    def draw(msp, _):
        msp.add_lwpolyline([(-10, 0, 1), (10, 0, 1)], format="xyb", close=True)

    assert_circle(dxf(draw), (0, 0), 10)


def test_dxf_bulge_turns_the_right_way(dxf):
    found = dxf(lambda msp, _: msp.add_lwpolyline([(0, 0, 1), (20, 0, 0)], format="xyb"))
    assert not found.closed
    assert found.points[:, 1].min() == pytest.approx(-10, abs=0.01)
    assert found.points[:, 1].max() == pytest.approx(0, abs=1e-9)


@pytest.mark.parametrize("method", ["add_lwpolyline", "add_polyline2d", "add_polyline3d"])
def test_dxf_polylines(dxf, method):
    def draw(msp, _):
        getattr(msp, method)([*SQUARE] if "lw" in method else [(*p,) for p in SQUARE], close=True)

    assert_same_ring(dxf(draw), SQUARE)


def test_dxf_splines(dxf):
    # As a cubic with these control points, a Bézier curve; its middle is known.
    found = dxf(lambda msp, _: msp.add_open_spline([(0, 0), (0, 40), (30, 40), (30, 0)]))
    assert found.points[[0, -1]].tolist() == [[0, 0], [30, 0]]
    line = shapely.LineString(found.points)
    assert line.distance(shapely.Point(15, 30)) < 0.01


def test_dxf_rational_spline_is_a_circle(dxf):
    def draw(msp, _):
        from ezdxf.math import rational_bspline_from_arc

        tool = rational_bspline_from_arc((0, 0), 25, 0, 360)
        msp.add_spline().apply_construction_tool(tool)

    assert_circle(dxf(draw), (0, 0), 25)


@pytest.mark.parametrize(
    ("units", "factor"), [(0, 1), (1, 25.4), (2, 304.8), (4, 1), (5, 10), (6, 1000), (13, 1e-3)]
)
def test_dxf_units(dxf, units, factor):
    size = 20 / factor
    found = dxf(lambda msp, _: msp.add_circle((0, 0), size), units=units)
    assert_circle(found, (0, 0), 20)


@pytest.mark.parametrize("version", ["R12", "R2000", "R2018"])
def test_dxf_versions(dxf, version):
    assert_circle(dxf(lambda msp, _: msp.add_circle((0, 0), 20), version=version), (0, 0), 20)


def test_dxf_hidden_things_do_not_count(dxf):
    def draw(msp, document):
        document.layers.add("Off").off()
        document.layers.add("Frozen").freeze()
        msp.add_lwpolyline(SQUARE, close=True)
        msp.add_line((-50, 5), (50, 5), dxfattribs={"layer": "OFF"})
        msp.add_circle((100, 0), 10, dxfattribs={"layer": "Frozen"})
        msp.add_circle((100, 0), 11, dxfattribs={"layer": "Defpoints"})
        msp.add_circle((100, 0), 12, dxfattribs={"invisible": 1})
        msp.add_text("100")
        document.layout("Layout1").add_circle((100, 0), 12)

    assert_same_ring(dxf(draw), SQUARE)


def two_circles(msp, _):
    msp.add_circle((0, 0), 10)
    msp.add_circle((50, 0), 12)


def wide_gap(msp, _):
    msp.add_line((0, 0), (0, -20))
    msp.add_line((0.2, -20), (5, -50))


def three_in_one_place(msp, _):
    for end in ((0, 20), (20, 0), (-20, -5)):
        msp.add_line((0, 0), end)


@pytest.mark.parametrize(
    ("draw", "words"),
    [
        (two_circles, "several separate lines (2)"),
        (wide_gap, "several separate lines (2)"),
        (three_in_one_place, "several separate lines (3)"),
        (lambda msp, _: msp.add_text("nothing"), "nothing drawable"),
        (
            lambda msp, _: msp.add_lwpolyline([(0, 0), (9, 9), (9, 0), (0, 9)], close=True),
            "crosses",
        ),
    ],
)
def test_dxf_without_a_profile(dxf, draw, words):
    with pytest.raises(NoObject) as failure:
        dxf(draw)
    assert words in str(failure.value)


@pytest.mark.parametrize(
    ("draw", "words"),
    [
        (lambda msp, _: msp.add_circle((0, 0), 1e6), "beyond"),
        (lambda msp, _: msp.add_circle((0, 0), 1e300), "beyond"),
        (lambda msp, _: msp.add_line((0, 0), (1e300, 0)), "beyond"),
        (lambda msp, _: msp.add_lwpolyline([(0, 0), (float("nan"), 0), (1, 1)]), "not finite"),
        (lambda msp, _: msp.add_lwpolyline([(0, 0, 1e-320), (9, 0)], format="xyb"), "only 2"),
        (lambda msp, _: msp.add_open_spline([(0, 0, 0), (0, 4, 1e300), (3, 4), (3, 0)]), "beyond"),
        (lambda msp, _: msp.add_line((0, 0), (5, 0)), "only 2 distinct points"),
    ],
)
def test_dxf_refused(dxf, draw, words):
    with pytest.raises(UnreadableInput) as failure:
        dxf(draw)
    assert words in str(failure.value)


def test_dxf_too_many_points(dxf, monkeypatch):
    monkeypatch.setattr("profiletool.profile.drawing.read_dxf.MAX_POINTS", 50)
    with pytest.raises(UnreadableInput, match="more than 50 points"):
        dxf(lambda msp, _: msp.add_circle((0, 0), 100))


def test_dxf_slight_damage_is_repaired(load, caplog):
    text = dxf_text(lambda msp: msp.add_circle((0, 0), 20))
    damaged = text[: text.rindex("ENDSEC")]  # breaks off
    with caplog.at_level(logging.CRITICAL):
        assert_circle(load("a.dxf", damaged), (0, 0), 20)


@pytest.mark.parametrize(
    "data",
    [
        b"not a drawing",
        b"AC1015\0\0\0\0\0\0binary",
        b"AutoCAD Binary DXF\r\n\x1a\0\xff\xff\xff",
        b"\x89PNG\r\n\x1a\n",
        b"0\nSECTION\n2\nENTITIES\n0\nLINE\n10\nzero\n",
        bytes(range(256)) * 20,
    ],
)
def test_dxf_that_is_none(load, data, capfd):
    with pytest.raises((UnreadableInput, NoObject)) as failure:
        load("a.dxf", data)
    assert str(failure.value).isprintable()
    assert capfd.readouterr() == ("", "")
