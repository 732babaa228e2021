import logging
import subprocess
import sys

import ezdxf
import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from profiletool.errors import NoObject, UnreadableInput
from profiletool.profile.drawing.load import load_vector

PX = 25.4 / 96


@pytest.fixture
def load(tmp_path):
    def from_text(name, text):
        path = tmp_path / name
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return load_vector(path)

    return from_text


@pytest.fixture
def dxf(tmp_path):
    """Save a drawing that ``draw(modelspace, document)`` makes, and load it."""

    def through_file(draw, units=4, name="drawing.dxf", version="R2000"):
        document = ezdxf.new(version, units=units)
        draw(document.modelspace(), document)
        path = tmp_path / name
        document.saveas(path)
        return load_vector(path)

    return through_file


def svg(body, head='width="100mm" height="100mm" viewBox="0 0 100 100"'):
    return f'<svg xmlns="http://www.w3.org/2000/svg" {head}>{body}</svg>'


def assert_same_ring(found, expected, atol=1e-9):
    """Same closed polygon, whatever its start and direction."""
    assert found.closed
    assert len(found.points) == len(expected)
    mine, theirs = shapely.LinearRing(found.points), shapely.LinearRing(expected)
    assert shapely.hausdorff_distance(mine, theirs) <= atol


def assert_circle(found, centre, radius, sagitta=0.0101):
    assert found.closed
    distance = np.hypot(*(found.points - centre).T)
    np.testing.assert_allclose(distance, radius, atol=1e-4)
    ring = shapely.LinearRing(found.points)
    assert radius - shapely.Point(centre).distance(ring) < sagitta
    assert ring.length == pytest.approx(2 * np.pi * radius, rel=2e-3)


# --- CSV --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "text",
    [
        "0,0\n10,0\n10,-5\n",
        "x_mm,y_mm\n0,0\n10,0\n10,-5\n",
        "\ufeffx;y\n0;0\n10,0;0\n1,0e1;-5\n",
        "# note\n\n0\t0\r\n10\t0\r\n10\t-5\r\n",
        "0 0\n10   0\n  10 -5 # the end\n",
        "0,0\r10,0\r10,-5\r",
        "0.;.0\n+10;0\n10;-5,0\n",
    ],
)
def test_csv_dialects(load, text):
    found = load("a.csv", text)
    assert found.points.tolist() == [[0, 0], [10, 0], [10, -5]]
    assert found.closed is False


def test_csv_header_in_latin_1(load):
    assert load("a.CSV", "höhe,x\n0,0\n1,0\n1,1\n".encode("latin-1")).points.shape == (3, 2)


def test_csv_closed_when_the_last_point_is_the_first(load):
    found = load("a.csv", "0,0\n10,0\n10,0\n10,10\n0,10\n0,0\n")
    assert found.closed
    assert found.points.tolist() == [[0, 0], [10, 0], [10, 10], [0, 10]]


def test_csv_ends_within_the_tolerance_are_one(load):
    found = load("a.csv", "0,0\n10,0\n10,10\n0,0.04\n")
    assert found.closed
    assert found.points.tolist() == [[0, 0.02], [10, 0], [10, 10]]
    assert not load("a.csv", "0,0\n10,0\n10,10\n0,0.06\n").closed


@given(
    x=st.lists(st.floats(0.1, 100), min_size=3, max_size=30),
    y=st.lists(st.floats(-1000, 1000), min_size=30, max_size=30),
    style=st.sampled_from([",", ";", "\t", " ", "; comma"]),
)
def test_csv_round_trip(tmp_path_factory, x, y, style):
    points = np.column_stack([np.cumsum(x), y[: len(x)]])
    separator = style[0]
    lines = [separator.join(repr(float(v)) for v in row) for row in points]
    text = "\n".join(lines)
    path = tmp_path_factory.mktemp("csv") / "a.csv"
    path.write_text(text.replace(".", ",") if "comma" in style else text)
    found = load_vector(path)
    assert not found.closed
    np.testing.assert_array_equal(found.points, points)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("0,0\n1,zwei\n2,2\n", "line 2: 'zwei' is no number"),
        ("0,0\n1,1\n\n2,nan\n", "line 4: 'nan' is not finite"),
        ("x,y\n0,-Infinity\n1,1\n2,2", "line 2: '-Infinity' is not finite"),
        ("0,0\n1,1,1\n2,2\n", "line 2 holds 3 fields"),
        ("0,0\n1,5 2,5\n2,2\n", "line 2 holds 3 fields"),
        ("x,y\nmm,mm\n0,0\n1,1\n2,2\n", "line 2: 'mm' is no number"),
        ("0,0\n1_0,1\n2,2\n", "line 2: '1_0' is no number"),
        ("0,0\n١,1\n2,2\n", "line 2"),
        ("0,0\n1,1\n", "only 2 points"),
        ("x,y\n", "only 0 points"),
        ("0,0\n0,0\n1,1\n1,1\n", "only 2 distinct points"),
        ("0,0\n1,1\n1e6,2\n", "beyond"),
        ("0,0\n1,1\n1e999,2\n", "not finite"),
        (b"0,0\n1,\x001\n2,2\n", "plain text"),
        (b"\xff\xfe0\x00,\x000\x00", "plain text"),
        ("", "empty"),
        (" \n\n", "empty"),
    ],
)
def test_csv_refused(load, text, words):
    with pytest.raises(UnreadableInput, match=r"a\.csv: ") as failure:
        load("a.csv", text)
    assert words in str(failure.value)
    assert "\n" not in str(failure.value)


def test_too_many_points(load, monkeypatch):
    monkeypatch.setattr("profiletool.profile.drawing.read_csv.MAX_POINTS", 5)
    with pytest.raises(UnreadableInput, match="more than 5 points"):
        load("a.csv", "\n".join(f"{i},0" for i in range(6)))
    with pytest.raises(UnreadableInput, match="more than 5 lines"):
        load("a.csv", "\n" * 20 + "0,0")


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


# --- files ------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["none.csv", "none.svg", "none.dxf", "with\nline\x1b.csv"])
def test_missing_file(tmp_path, name):
    with pytest.raises(UnreadableInput, match="no such file") as failure:
        load_vector(tmp_path / name)
    assert str(failure.value).isprintable()


def test_not_a_file(tmp_path):
    (tmp_path / "folder.csv").mkdir()
    with pytest.raises(UnreadableInput, match="a folder"):
        load_vector(tmp_path / "folder.csv")
    with pytest.raises(UnreadableInput, match="cannot be opened"):
        load_vector(tmp_path / ("x" * 5000 + ".csv"))


def test_unknown_suffix(load):
    with pytest.raises(UnreadableInput, match="give DXF, SVG or CSV"):
        load("a.step", "0,0\n1,0\n1,1\n")


def test_too_large(load, monkeypatch):
    monkeypatch.setattr("profiletool.profile.drawing.load.MAX_BYTES", 10)
    with pytest.raises(UnreadableInput, match="larger than"):
        load("a.csv", "0,0\n1,0\n1,1\n2,2\n")


def test_importing_is_cheap():
    code = (
        "import sys, profiletool.profile.drawing.load\n"
        "print([m for m in ('ezdxf', 'svgelements', 'shapely', 'scipy') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


# --- DXF --------------------------------------------------------------------------------------


SQUARE = [(0, 0), (20, 0), (20, 10), (0, 10)]


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


def two_circles(msp, _):
    msp.add_circle((0, 0), 10)
    msp.add_circle((50, 0), 12)


def wide_gap(msp, _):
    msp.add_line((0, 0), (0, -20))
    msp.add_line((0.2, -20), (5, -50))


def three_in_one_place(msp, _):
    for end in ((0, 20), (20, 0), (-20, -5)):
        msp.add_line((0, 0), end)


def block_alone(msp, document):
    document.blocks.new("A").add_circle((0, 0), 5)
    msp.add_blockref("A", (0, 0))


@pytest.mark.parametrize(
    ("draw", "words"),
    [
        (two_circles, "several separate lines (2)"),
        (wide_gap, "several separate lines (2)"),
        (three_in_one_place, "several separate lines (3)"),
        (block_alone, "explode"),
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


def dxf_text(draw):
    import io

    document = ezdxf.new("R2000", units=4)
    draw(document.modelspace())
    stream = io.StringIO()
    document.write(stream)
    return stream.getvalue()


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


# --- SVG --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "body",
    [
        '<rect x="10" y="20" width="20" height="10"/>',
        '<polygon points="10,20 30,20 30,30 10,30"/>',
        '<polyline points="10 20 30 20 30 30 10 30 10 20"/>',
        '<path d="M10 20h20v10h-20z"/>',
        '<path d="m10,20 20,0 0,10 -20,0 0-10"/>',
        '<line x1="10" y1="20" x2="30" y2="20"/><path d="M30 30V20M10 30H30M10 20V30"/>',
        '<g transform="translate(10 20)"><rect width="10" height="5" transform="scale(2)"/></g>',
        '<rect x="20" y="-30" width="10" height="20" transform="rotate(90)"/>',
        '<rect x="10" y="20" width="20" height="10" transform="matrix(1 0 0 1 0 0)"/>',
        '<defs><rect id="r" width="20" height="10"/></defs><use href="#r" x="10" y="20"/>',
        '<rect width="100" height="100" fill="white"/><path d="M10 20h20v10h-20z"/>',
        '<style>.no{display:none}</style><circle class="no" r="90"/><path d="M10 20h20v10h-20z"/>',
        '<path d="M10 20h20v10h-20z"/><g style="display:none"><circle r="90"/></g>',
        '<path d="M10 20h20v10h-20z"/><circle r="90" visibility="hidden"/>',
        '<path d="M10 20h20v10h-20z"/><text x="3" y="4">90 mm</text>',
        '<path d="M10 20h20v10h-20z"/><marker><circle r="90"/></marker>',
        '<clipPath id="c"><circle r="90"/></clipPath><path d="M10 20h20v10h-20z"/>',
    ],
)
def test_svg_same_square(load, body):
    found = load("a.svg", svg(body))
    assert_same_ring(found, [(10, -20), (30, -20), (30, -30), (10, -30)], atol=1e-6)


@pytest.mark.parametrize(
    ("head", "unit"),
    [
        ("", PX),
        ('width="200" height="100"', PX),
        ('width="200px" height="100px" viewBox="0 0 200 100"', PX),
        ('viewBox="0 0 200 100"', PX),
        ('width="100%" height="100%" viewBox="0 0 200 100"', PX),
        ('width="200mm" height="100mm" viewBox="0 0 200 100"', 1),
        ('width="200mm" viewBox="0 0 200 100"', 1),
        ('height="100mm" width="auto" viewBox="0 0 200 100"', 1),
        ('width="20cm" height="10cm" viewBox="0 0 100 50"', 2),
        ('width="2in" height="1in" viewBox="0 0 2000 1000"', 0.0254),
        ('width="72pt" height="72pt" viewBox="0 0 1 1"', 25.4),
    ],
)
def test_svg_units(load, head, unit):
    found = load("a.svg", svg('<path d="M0 0 40 0 40 10 0 30z"/>', head))
    expected = np.array([(0, 0), (40, 0), (40, -10), (0, -30)]) * unit
    assert_same_ring(found, expected, atol=1e-6)


def test_svg_view_box_offset_and_lengths_with_units(load):
    body = '<rect x="1cm" y="0" width="2cm" height="1cm"/>'
    found = load(
        "a.svg", svg(body, 'width="50mm" height="50mm" viewBox="0 0 188.976378 188.976378"')
    )
    assert_same_ring(found, [(10, 0), (30, 0), (30, -10), (10, -10)], atol=1e-4)


@pytest.mark.parametrize(
    "body",
    [
        '<circle cx="50" cy="40" r="30"/>',
        '<ellipse cx="50" cy="40" rx="30" ry="30"/>',
        '<path d="M20 40a30 30 0 0 1 60 0 30 30 0 0 1-60 0z"/>',
        '<ellipse cx="25" cy="40" rx="15" ry="30" transform="scale(2 1)"/>',
        '<circle cx="0" cy="0" r="15" transform="translate(50 40) rotate(30) scale(2)"/>',
        '<path d="M20 40a30 30 0 0 1 60 0M20 40A30 30 0 0 0 80 40"/>',
    ],
)
def test_svg_circle(load, body):
    assert_circle(load("a.svg", svg(body)), (50, -40), 30)


def test_svg_circle_under_a_skew(load):
    found = load("a.svg", svg('<circle cx="50" cy="40" r="10" transform="skewX(45)"/>'))
    x, y = found.points[:, 0], -found.points[:, 1]
    np.testing.assert_allclose(np.hypot(x - y - 50, y - 40), 10, atol=1e-6)


def test_svg_curves(load):
    cubic = load("a.svg", svg('<path d="M0 0C0 40 30 40 30 0"/>'))
    assert not cubic.closed
    assert shapely.LineString(cubic.points).distance(shapely.Point(15, -30)) < 0.01
    smooth = load("a.svg", svg('<path d="M0 0Q10 20 20 0T40 0"/>'))
    line = shapely.LineString(smooth.points)
    for middle in [(10, -10), (30, 10)]:
        assert line.distance(shapely.Point(middle)) < 0.01
    assert 20 < len(smooth.points) < 200


BOMB = "".join(f'<g id="a{i}">' + f'<use href="#a{i - 1}"/>' * 10 + "</g>" for i in range(1, 9))


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('<!DOCTYPE svg [<!ENTITY a "b">]>' + svg("&a;"), "DOCTYPE"),
        ('<!DOCTYPE svg SYSTEM "http://example.org/a.dtd">' + svg("<g/>"), "DOCTYPE"),
        (svg('<path d="M0 0h9v9z"/>').encode("utf-16"), "well-formed"),
        ('<?xml version="1.0" encoding="cp037"?>'.encode("cp037"), "well-formed"),
        (svg("<path>"), "well-formed"),
        ("plain words", "well-formed"),
        ("<html><body/></html>", "<html>"),
        ('<svg xmlns="http://example.org/other"><path d="M0 0h9v9z"/></svg>', "no <svg>"),
        (svg('<path d="M0 0 L 9 nine 9 0"/>'), "bad 'd'"),
        (svg('<polygon points="0,0 nan,3 4,4"/>'), "bad 'points'"),
        (svg('<circle r="ten"/>'), "length 'ten'"),
        (svg('<circle r="nan"/>'), "length 'nan'"),
        (svg('<circle r="1e9"/>'), "beyond"),
        (svg('<path d="M0 0C1e300 0 9 9 0 5z"/>'), "beyond"),
        (svg('<path d="M0 0L1e999 0 9 9z"/>'), "beyond"),
        (svg('<g id="a"><use href="#a"/></g>'), "circle"),
        (svg(f'<g id="a0"><circle r="1"/></g>{BOMB}'), "<use> makes"),
        (svg("<g>" * 300 + "</g>" * 300), "nested"),
        (svg('<line x1="0" y1="0" x2="9" y2="0"/>'), "only 2 distinct"),
        (svg('<rect width="9" height="9" transform="rotate(x)"/>'), ""),
    ],
)
def test_svg_refused(load, text, words):
    with pytest.raises(UnreadableInput, match=r"a\.svg: ") as failure:
        load("a.svg", text)
    assert words in str(failure.value)
    assert str(failure.value).isprintable()


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (svg(""), "nothing drawable"),
        (svg("<text>words</text>"), "nothing drawable"),
        (svg('<image href="file:///etc/passwd" width="9" height="9"/>'), "nothing drawable"),
        (svg('<use href="other.svg#part"/>'), "nothing drawable"),
        (svg('<circle r="9"/>', 'width="0" height="9" viewBox="0 0 9 9"'), "width"),
        (svg('<circle r="9"/><circle cx="40" r="9"/>'), "several"),
        (svg('<path d="M0 0L9 9 9 0 0 9z"/>'), "crosses"),
        (svg('<path d="M0 0h9v9h-9z"/><path d="M0 0L-9-9"/>'), "several"),
    ],
)
def test_svg_without_a_profile(load, text, words):
    with pytest.raises(NoObject) as failure:
        load("a.svg", text)
    assert words in str(failure.value)


def test_svg_too_much(load, monkeypatch):
    monkeypatch.setattr("profiletool.profile.drawing.svg_tree.MAX_NUMBERS", 5)
    with pytest.raises(UnreadableInput, match="more than 5 numbers"):
        load("a.svg", svg('<path d="M0 0 9 0 9 9z"/>'))
    monkeypatch.setattr("profiletool.profile.drawing.svg_tree.MAX_ELEMENTS", 5)
    with pytest.raises(UnreadableInput, match="more than 5 elements"):
        load("a.svg", svg("<g/>" * 10))


# --- hostile text -----------------------------------------------------------------------------


def mutated(text, rng, count):
    data = bytearray(text)
    for _ in range(count):
        at = int(rng.integers(max(len(data), 1)))
        kind = rng.integers(4)
        if kind == 0:
            data[at : at + 1] = [int(rng.integers(256))]
        elif kind == 1:
            del data[at : at + int(rng.integers(1, 40))]
        elif kind == 2:
            data[at:at] = data[at : at + int(rng.integers(1, 40))]
        else:
            data[at:at] = [b"1e400", b"-", b"nan", b"9" * 30, b"\n", b"<"][int(rng.integers(6))]
    return bytes(data)


SEEDS = {
    "a.svg": svg(
        '<g transform="rotate(9) scale(2)"><path d="M0 0C0 40 30 40 30 0A9 9 0 0 1 9 9Q1 2 3 4z"/>'
        '</g><rect x="1mm" width="9" height="9" rx="2"/><use href="#a"/><circle id="a" r="4"/>'
    ),
    "a.csv": "x;y\n0;0\n10,5;0\n10;-5,25\n",
    "a.dxf": dxf_text(
        lambda msp: (
            msp.add_circle((0, 0), 20),
            msp.add_open_spline([(0, 0), (0, 4), (3, 4), (3, 0)]),
            msp.add_lwpolyline([(0, 0, 1), (2, 0, 0)], format="xyb"),
            msp.add_ellipse((1, 2), major_axis=(2, 0), ratio=0.5),
            msp.add_polyline2d([(0, 0), (3, 3), (4, 0)]),
        )
    ),
}


@pytest.mark.parametrize(("name", "rounds"), [("a.svg", 250), ("a.csv", 250), ("a.dxf", 25)])
def test_damage_ends_in_a_profile_or_one_line(load, capfd, name, rounds):
    rng = np.random.default_rng(7)
    seed, messages = SEEDS[name].encode(), []
    for _ in range(rounds):
        try:
            found = load(name, mutated(seed, rng, int(rng.integers(1, 12))))
        except (UnreadableInput, NoObject) as failure:
            messages.append(str(failure))
        else:
            assert np.all(np.isfinite(found.points))
    assert all(message.isprintable() for message in messages)
    assert capfd.readouterr() == ("", "")
