"""The writers. PROFILETOOL_REGENERATE=1 writes the golden files anew."""

from __future__ import annotations

import os
from collections import Counter
from pathlib import Path
from xml.etree import ElementTree

import ezdxf
import numpy as np
import pytest

from profiletool.template.dxf import write_dxf
from profiletool.template.layout import build_sheet
from profiletool.template.svg import write_svg
from tests.template.designs import bulb, long_tube, short_tube, skew
from tests.template.geometry import read_back

GOLDEN = Path(__file__).resolve().parents[1] / "golden"
COLOURS = {"CUT_OUTER": 7, "CUT_INNER": 5, "MARK": 3, "NOTE": 1, "REF": 8}
SVG = "{http://www.w3.org/2000/svg}"
DESIGNS = [bulb, short_tube, skew, pytest.param(long_tube, marks=pytest.mark.slow)]


@pytest.mark.parametrize("build", DESIGNS)
def test_dxf_reads_back(build):
    sheet = build_sheet(build())
    doc = read_back(write_dxf(sheet.drawing))
    assert doc.dxfversion == "AC1015"
    assert doc.header["$INSUNITS"] == 4
    assert doc.header["$MEASUREMENT"] == 1
    assert {name: doc.layers.get(name).color for name in COLOURS} == COLOURS
    entities = list(doc.modelspace())
    assert {entity.dxftype() for entity in entities} == {"LWPOLYLINE"}
    counts = Counter(entity.dxf.layer for entity in entities)
    assert counts == {layer.name: len(layer.lines) for layer in sheet.drawing.layers}
    assert counts["CUT_INNER"] == len(sheet.slits)
    assert [e.dxf.layer for e in entities if e.closed and e.dxf.layer.startswith("CUT")] == [
        "CUT_OUTER"
    ]
    outline = np.array(
        [p[:2] for e in entities if e.dxf.layer == "CUT_OUTER" for p in e.get_points()]
    )
    np.testing.assert_allclose(outline.min(axis=0), [-20, 0], atol=1e-9)
    np.testing.assert_allclose(outline.max(axis=0), [build().tube.length_mm, 130.38], atol=0.01)
    cuts = [[p[:2] for p in e.get_points()] for e in entities if e.dxf.layer == "CUT_INNER"]
    expected = [[(s.x_mm, s.y_start_mm), (s.x_mm, s.y_end_mm)] for s in sheet.slits]
    np.testing.assert_allclose(cuts, expected, atol=1e-6)


def test_reference_measures_are_true():
    doc = read_back(write_dxf(build_sheet(bulb()).drawing))
    lines = [
        np.array([p[:2] for p in e.get_points()])
        for e in doc.modelspace().query('LWPOLYLINE[layer=="REF"]')
    ]
    sizes = {tuple(np.round(np.ptp(line, axis=0), 6)) for line in lines}
    assert {(100.0, 0.0), (100.0, 50.0)} <= sizes
    assert max(line[:, 1].max() for line in lines) < 0


def test_dxf_leaves_ezdxf_as_it_was():
    sheet = build_sheet(short_tube())
    for state in (False, True):
        ezdxf.options.write_fixed_meta_data_for_testing = state
        try:
            write_dxf(sheet.drawing)
            assert ezdxf.options.write_fixed_meta_data_for_testing is state
        finally:
            ezdxf.options.write_fixed_meta_data_for_testing = False


def test_dxf_tells_neither_time_nor_version():
    data = write_dxf(build_sheet(bulb()).drawing)
    for stamp in (b"$TDCREATE", b"$TDUCREATE", b"$TDUPDATE", b"$TDUUPDATE"):
        assert stamp + b"\n 40\n2451545.0\n" in data
    metadata = read_back(data).ezdxf_metadata()
    for key in ("CREATED_BY_EZDXF", "WRITTEN_BY_EZDXF"):
        assert ezdxf.__version__ not in metadata[key]
        assert "2000-01-01" in metadata[key]


@pytest.mark.parametrize("build", DESIGNS)
def test_svg_shows_the_same_lines(build):
    sheet = build_sheet(build())
    root = ElementTree.fromstring(write_svg(sheet.drawing))
    width, height = root.get("width"), root.get("height")
    assert width.endswith("mm")
    assert height.endswith("mm")
    assert root.get("viewBox") == f"0 0 {width[:-2]} {height[:-2]}"
    assert {e.tag for e in root.iter()} == {
        SVG + tag for tag in ("svg", "title", "g", "polygon", "polyline")
    }
    groups = root.findall(f"{SVG}g")
    assert [g.get("id") for g in groups] == [layer.name for layer in sheet.drawing.layers]
    x0, _, _, y1 = sheet.drawing.bounds
    for group, layer in zip(groups, sheet.drawing.layers, strict=True):
        assert len(group) == len(layer.lines)
        for shape, line in zip(group, layer.lines, strict=True):
            points = np.array([[*map(float, p.split(","))] for p in shape.get("points").split()])
            np.testing.assert_allclose(
                points, (line.points - (x0 - 5, y1 + 5)) * (1, -1), atol=1e-4
            )
            assert points.min() >= 5 - 1e-4


@pytest.mark.parametrize("ending", ["dxf", "svg"])
def test_golden_files(ending):
    def write() -> bytes:
        sheet = build_sheet(bulb())
        return write_dxf(sheet.drawing) if ending == "dxf" else write_svg(sheet.drawing).encode()

    data = write()
    assert data == write()
    path = GOLDEN / f"template_bulb.{ending}"
    if os.environ.get("PROFILETOOL_REGENERATE") == "1":
        path.write_bytes(data)
    assert data == path.read_bytes()


def test_golden_files_reread():
    doc = read_back((GOLDEN / "template_bulb.dxf").read_bytes())
    cuts = doc.modelspace().query('LWPOLYLINE[layer=="CUT_INNER"]')
    # 4 + 4 + 4 + 4 + 3 rows on two turns, 5 rows in three pieces.
    assert len(cuts) == 2 * 19 + 3 * 5
    root = ElementTree.parse(GOLDEN / "template_bulb.svg").getroot()
    assert len(root.find(f"{SVG}g[@id='CUT_INNER']")) == 2 * 19 + 3 * 5


@pytest.mark.slow
@pytest.mark.parametrize(
    "build",
    [short_tube, *(pytest.param(b, marks=pytest.mark.slow) for b in (bulb, skew, long_tube))],
)
def test_r12_holds_the_same_lines(build, caplog):
    sheet = build_sheet(build())
    doc = read_back(write_dxf(sheet.drawing, "R12"))
    assert doc.dxfversion == "AC1009"
    entities = list(doc.modelspace())
    assert {entity.dxftype() for entity in entities} == {"POLYLINE"}
    drawn = [line for layer in sheet.drawing.layers for line in layer.lines]
    assert len(entities) == len(drawn)
    for entity, line in zip(entities, drawn, strict=True):
        assert (entity.dxf.layer, entity.is_closed) == (line.layer, line.closed)
        points = [tuple(point)[:2] for point in entity.points()]
        np.testing.assert_allclose(points, line.points, atol=1e-6)
    assert caplog.records == []


def test_the_outline_is_cut_last():
    """A part that is cut loose moves, so marks and slits come before."""
    drawing = build_sheet(bulb()).drawing
    layers = [e.dxf.layer for e in read_back(write_dxf(drawing)).modelspace()]
    groups = [g.get("id") for g in ElementTree.fromstring(write_svg(drawing)).findall(f"{SVG}g")]
    for order in (layers, groups):
        cut = order.index("CUT_OUTER")
        assert not {"CUT_INNER", "MARK"} & set(order[cut:])
