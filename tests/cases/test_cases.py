"""Inputs that people really have: read as they look, or refused for the true reason."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from profiletool import find_subject
from profiletool.api import request_for
from profiletool.errors import ProfiletoolError
from profiletool.rubber.presets import parse_rubber
from profiletool.subject.find import drawing_notes
from tests.calls import call, error_of

FILES = Path(__file__).parent / "files"
EGG = (98.1, 80.7)  # mm to follow, and how high that part is
HEIGHT = {"height_mm": 90.0}
SAYS_UNIT = "names no unit, so its numbers were taken for mm"


def seen(name: str, options: dict[str, Any]) -> tuple[float, float, str]:
    """Length and height of the profile, mm, and all notes in one text."""
    request = request_for(FILES / name, **options)
    subject = find_subject(request)
    points = subject.profile.points
    notes = " | ".join(drawing_notes(request, subject))
    return subject.profile.length_mm, float(np.ptp(points[:, 1])), notes


@pytest.mark.parametrize(
    ("name", "options", "note"),
    [
        # no unit, or a wrong one
        ("svg-illustrator-px.svg", {}, "Illustrator has 72 px per inch"),
        ("svg-illustrator-px.svg", HEIGHT, ""),
        ("svg-percent-144dpi.svg", HEIGHT, ""),
        ("svg-inkscape-091.svg", {}, "Inkscape 0.91 has 90 px per inch"),
        ("dxf-no-header.dxf", {}, SAYS_UNIT),
        ("dxf-metres-mm-drawn.dxf", HEIGHT, "the drawing itself is 6.368e+04 x 9e+04 mm"),
        ("dxf-r12-inch.dxf", HEIGHT, ""),
        ("dxf-measurement-inch.dxf", {}, "its $MEASUREMENT says inches"),
        # something round the object
        ("svg-ground-path.svg", {}, ""),
        ("svg-border-rect.svg", {}, "96.0 x 106.0 mm at (50.0, -55.0), was taken for a frame"),
        ("svg-bleed-rect.svg", {}, ""),
        ("svg-opacity-0.svg", {}, ""),
        ("svg-clip.svg", {}, ""),
        ("dxf-frame-a6.dxf", {}, "104.0 x 148.0 mm at (0.0, 0.0), was taken for a frame"),
        ("dxf-block-and-lines.dxf", {}, "were left out as a frame"),
        ("svg-symbol.svg", {}, ""),
        ("dxf-front-view-edges.dxf", {}, "the outline round all 6 lines was taken"),
        # not quite closed
        ("csv-not-closed.csv", {}, "ends are 1.8 mm apart at (30.0, 0.0): it was closed"),
        ("dxf-polyline-open.dxf", {}, "ends are 1.8 mm apart at (30.0, 0.0): it was closed"),
        ("svg-filled-not-closed.svg", {}, ""),
        ("dxf-gap.dxf", {}, "ends are 0.18 mm apart at (0.0, 45.0): it was closed"),
        ("dxf-partly-doubled.dxf", {}, "the outline round all 3 lines was taken"),
        # curves
        ("dxf-r12-spline-fit.dxf", {}, SAYS_UNIT),
        # dialects
        ("svg-doctype.svg", {}, ""),
        ("svg-traced-doctype-pt.svg", {}, ""),
        ("svg-latin1.svg", {}, ""),
        ("svg-gzip.svgz", {}, ""),
        ("csv-units-row.csv", {}, ""),
        ("csv-sep-line.csv", {}, ""),
        ("csv-quoted.csv", {}, ""),
        ("csv-empty-rows.csv", {}, ""),
        ("csv-index.csv", {}, ""),
        ("csv-tab-decimal-comma.csv", {}, ""),
        ("csv-minus-sign.csv", {}, ""),
        ("csv-utf16.csv", {}, ""),
        ("csv-tabs.txt", {}, ""),
        ("dxf-paper-space.dxf", {}, "all lies in paper space: 'Layout1' was read"),
        ("dxf-far-origin.dxf", {}, "5232 m from its origin: it was moved"),
        # pictures
        ("img-12bit-in-16.tif", HEIGHT, ""),
        ("img-pixels-not-square.tif", HEIGHT, "2 times as high as wide: it was stretched"),
        pytest.param(
            "img-sheet-paper-cutout.jpg", {"flat": True}, "", marks=pytest.mark.slow
        ),
    ],
)  # fmt: skip
def test_the_egg(name: str, options: dict[str, Any], note: str) -> None:
    length, high, notes = seen(name, options)
    assert (length, high) == pytest.approx(EGG, abs=0.5)
    assert note in notes
    assert bool(note) == bool(notes), notes


@pytest.mark.parametrize(
    ("name", "options", "length", "within", "note"),
    [
        ("svg-unit-capitals.svg", {}, 196.1, 1.0, ""),
        ("svg-two-shapes.svg", {}, 125.8, 0.5, "the outline round all 2 lines was taken"),
        ("csv-pixel-steps-3.csv", {}, 98.1, 2.0, "the points scatter"),
        ("csv-scatter-010.csv", {}, 98.1, 2.0, "the points scatter by 0.1 mm"),
        ("csv-scatter-005-dense.csv", {}, 98.1, 2.0, "the points scatter by 0.051 mm"),
        ("dxf-spline-unclamped.dxf", {}, 86.5, 0.1, ""),
        ("csv-cm.csv", {}, 489.1, 1.0, ""),
        ("img-bmp-alpha-zero.bmp", HEIGHT, 99.2, 0.5, ""),  # an egg that is 71.4 mm wide
    ],
)
def test_other_sizes(
    name: str, options: dict[str, Any], length: float, within: float, note: str
) -> None:
    found, _, notes = seen(name, options)
    assert found == pytest.approx(length, abs=within)
    assert note in notes
    assert "too tight" not in notes


@pytest.mark.parametrize(
    ("name", "options", "code", "says"),
    [
        ("svg-percent-144dpi.svg", {}, 4, "the file states no physical size; give `height_mm`"),
        ("dxf-metres-mm-drawn.dxf", {}, 4, "unit is meters, which makes the profile 6.368e+04 x"),
        ("dxf-r12-inch.dxf", {}, 4, "taken for mm, which makes the profile 2.507 x 3.543 mm; give"),
        ("img-camera-200dpi.png", {}, 4, "nothing says how large the object is"),
        (
            "img-marker-touched.jpg", {"marker_mm": 40.0, "camera_distance_mm": 700.0}, 4,
            "something touches or covers the marker's edge",
        ),
        ("img-marker-6x6.png", {"marker_mm": 40.0}, 4, "another dictionary is seen (DICT_6X6_1000"),
        ("img-marker-mirrored.png", {"marker_mm": 40.0}, 4, "one is seen mirrored"),
        ("img-marker-glare.png", {"marker_mm": 40.0}, 4, "its cells cannot be read: glare"),
    ],
)  # fmt: skip
def test_refused_for_the_true_reason(
    name: str, options: dict[str, Any], code: int, says: str
) -> None:
    with pytest.raises(ProfiletoolError) as refusal:
        seen(name, options)
    assert refusal.value.exit_code == code
    assert says in str(refusal.value)
    assert "\n" not in str(refusal.value)


@pytest.mark.slow
def test_a_flat_thing_taken_for_a_round_one_is_told_and_within_its_error() -> None:
    subject = find_subject(FILES / "img-sheet-paper-cutout.jpg")
    outline = subject.profile.outline
    assert outline is not None
    high = float(np.ptp(outline[:, 1]))
    assert abs(high / 90.0 - 1.0) < (subject.scale.error_share or 0.0)
    assert any(re.search("taken for a round one, 6[01] mm thick", note) for note in subject.notes)


@pytest.mark.parametrize(
    "name", ["rubber-kgf-cm2.csv", "rubber-load-unload.csv", "rubber-units-row.csv"]
)
def test_rubbers(name: str) -> None:
    found = parse_rubber(str(FILES / name))
    assert found.law.constants["C10"] == pytest.approx(0.0694, abs=2e-4)
    assert found.law.constants["C01"] == pytest.approx(0.0628, abs=2e-4)
    assert ("first loading alone of 160" in found.source) == (name == "rubber-load-unload.csv")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "words", "code"),
    [
        ("dxf-frame-a6.dxf", (), 0),
        ("svg-percent-144dpi.svg", ("--height", 90), 0),
        ("csv-cm.csv", (), 6),
        ("dxf-metres-mm-drawn.dxf", (), 4),
    ],
)
def test_on_the_command_line(
    tmp_path: Path, name: str, words: tuple[object, ...], code: int
) -> None:
    out = tmp_path / "out"
    result = call("design", FILES / name, *words, "--no-verify", "--out", out)
    assert result.exit_code == code
    assert (code == 0) == ("error: " not in result.stderr)
    if code:
        assert error_of(result)
    assert out.exists() == (code in (0, 6))


@pytest.mark.parametrize("name", ["img-cutout-shadow", "img-window-shadow", "img-outline-drawing"])
def test_shadows_and_line_drawings(name: str) -> None:
    outline, notes, code = None, (), 0
    try:
        subject = find_subject(FILES / f"{name}.png", height_mm=90.0)
        outline, notes = subject.profile.outline, subject.notes
    except ProfiletoolError as refusal:
        code = refusal.exit_code
    if outline is None:
        assert (code, name) == (5, "img-window-shadow")
        return
    width = float(np.ptp(outline[:, 0]))
    transparent = any("transparent" in note for note in notes)
    assert width == pytest.approx(63.7, abs=1.0) or (transparent and "cutout" in name)
