"""The PDF writer, read back: pages, lines and clip boxes in mm."""

from __future__ import annotations

import re
import shutil
import subprocess
import time

import numpy as np
import pytest
from reportlab.pdfbase.pdfmetrics import stringWidth

from profiletool.template.drawing import Drawing, Line, Text, polyline
from profiletool.template.layout import build_sheet
from profiletool.template.pdf import LETTER_MM, write_pdf
from tests.template.designs import bulb
from tests.template.pages import (
    DRAWINGS,
    FRAME,
    MARGIN,
    NEAR,
    OVERLAP,
    PAPERS,
    PIECE,
    colour,
    dotted,
    layer_of,
    lines_of,
    offset_of,
    piece,
    printed,
    read,
    read_text,
    rectangle,
    sheet,
    spoken,
    windows_of,
)


@pytest.fixture(scope="module", params=[(d, p) for d in DRAWINGS for p in PAPERS], ids="-".join)
def written(request):
    name, paper = request.param
    drawing = DRAWINGS[name]()
    return drawing, PAPERS[paper], printed(drawing, paper)


def test_pages_are_of_the_paper(written):
    _, paper, pages = written
    for page in pages:
        np.testing.assert_allclose(sorted(page.size), paper, atol=NEAR)


def test_nothing_outside_the_printable_area(written):
    for page in written[2]:
        low, high = np.array([MARGIN, MARGIN]), np.array(page.size) - MARGIN
        assert (page.clip[0] >= low - NEAR).all()
        assert (page.clip[1] <= high + NEAR).all()
        for stroke in page.footer:
            assert (stroke.points - stroke.width / 2 >= low - NEAR).all()
            assert (stroke.points + stroke.width / 2 <= high + NEAR).all()


def test_what_is_not_tiled_is_not_clipped(written):
    for page in written[2]:
        for stroke in () if spoken(page.footer, "tile") else page.drawn:
            assert (stroke.points - stroke.width / 2 >= page.clip[0] - NEAR).all()
            assert (stroke.points + stroke.width / 2 <= page.clip[1] + NEAR).all()


def test_the_footer_stands_below_the_drawing(written):
    for page in written[2]:
        top = max(s.points[:, 1].max() + s.width / 2 for s in page.footer)
        assert top < page.clip[0, 1] - 1.0


def test_every_page_says_what_it_is(written):
    drawing, _, pages = written
    for number, page in enumerate(pages, start=1):
        assert {stroke.colour for stroke in page.footer} == {colour("REF")}
        (told,) = spoken(page.footer, f"page {number} of {len(pages)} - print at 100 %, no scaling")
        assert told[1, 0] == pytest.approx(page.size[0] - MARGIN, abs=0.1)
        assert not drawing.title or spoken(page.footer, drawing.title[:8])
        for alarm in ("INFEASIBLE", "NOT VERIFIED"):
            found = spoken(page.footer, alarm)
            assert len(found) == (alarm in drawing.title)
            right = (spoken(page.footer, "tile") or [told])[0]
            assert all(box[1, 0] < right[0, 0] - LETTER_MM for box in found)


def test_every_page_can_be_measured(written):
    for page in written[2]:
        for strokes in (page.drawn, page.footer):
            grey = [s.points for s in strokes if layer_of(s) == "REF" and len(s.points) == 2]
            bars = [p for p in grey if abs(np.ptp(p[:, 0]) - 100) < NEAR and not np.ptp(p[:, 1])]
            if bars:
                break
        assert bars or written[0].title == "No room"
        if strokes is page.footer and bars:
            upright = np.array([p[p[:, 1].argmin()] for p in grey if not np.ptp(p[:, 0])])
            ticks = upright[np.abs(upright[:, 1] - bars[0][0, 1]) < NEAR, 0] - bars[0][0, 0]
            ticks = np.sort(ticks[(ticks > -NEAR) & (ticks < 100 + NEAR)])
            np.testing.assert_allclose(ticks, np.arange(0, 101, 10), atol=NEAR)


def test_lines_are_thin_and_round(written):
    for page in written[2]:
        for stroke in page.drawn + page.footer:
            low, high = (0.1, 0.2) if layer_of(stroke).startswith("CUT") else (0.15, 0.25)
            assert low <= stroke.width <= high
            assert stroke.style == (1, 1)


def test_every_point_of_the_piece_is_on_a_page(written):
    drawing, _, pages = written
    lines = lines_of(drawing, PIECE)
    dots = [dotted(line) for line in lines]
    found = [np.zeros(len(at), dtype=bool) for at in dots]
    kinds = [(line.layer, line.closed, len(line.points)) for line in lines]
    numbers = {kind: [k for k, other in enumerate(kinds) if other == kind] for kind in {*kinds}}
    like = {kind: (ks, np.array([lines[k].points for k in ks])) for kind, ks in numbers.items()}
    pages = [page for page in pages if any(layer_of(s) == "CUT_OUTER" for s in page.drawn)]
    outline = next(line.points for line in lines if line.layer == "CUT_OUTER")
    for page, window in zip(pages, windows_of(pages, outline), strict=True):
        for stroke in page.drawn:
            if layer_of(stroke) not in PIECE:
                continue
            points = stroke.points - page.clip[0] + window[0]
            numbers, candidates = like[layer_of(stroke), stroke.closed, len(points)]
            off = np.abs(candidates - points).max(axis=(1, 2))
            assert off.min() < NEAR
            k = numbers[off.argmin()]
            found[k] |= ((dots[k] >= window[0]) & (dots[k] <= window[1])).all(axis=1)
    assert all(seen.all() for seen in found)


@pytest.mark.parametrize("paper", PAPERS)
@pytest.mark.parametrize(
    ("drawing", "upright"),
    [(sheet(60, 40), True), (sheet(190, 200), True), (sheet(250, 130), False)],
)
def test_one_page_where_possible(drawing, upright, paper):
    low = Drawing(drawing.title, drawing.drawn, ())
    (page,) = printed(low, paper)
    assert (page.size[0] < page.size[1]) == upright
    offset_of(page, lines_of(low))
    points = np.concatenate([stroke.points for stroke in page.drawn])
    middle = (points.min(axis=0) + points.max(axis=0)) / 2
    np.testing.assert_allclose(middle, page.clip.mean(axis=0), atol=NEAR)
    assert middle[0] == pytest.approx(page.size[0] / 2, abs=NEAR)


def test_bulb_is_one_page_of_a4():
    drawing = build_sheet(bulb()).drawing
    (page,) = printed(drawing)
    assert page.size[0] < page.size[1]
    offset_of(page, lines_of(drawing))


def test_no_bar_rather_than_tiles():
    drawing = piece(199.5, 280.5)
    (page,) = printed(drawing)
    offset_of(page, lines_of(drawing))


def test_piece_of_250_by_130_has_a_page_of_its_own():
    drawing = sheet(250, 130, above=70)
    first, second = printed(drawing)
    assert first.size[0] > first.size[1]
    offset_of(first, lines_of(drawing, PIECE))
    outline = next(s.points for s in first.drawn if layer_of(s) == "CUT_OUTER")
    np.testing.assert_allclose(np.ptp(outline, axis=0), [250, 130], atol=0.001)
    assert {layer_of(stroke) for stroke in second.drawn} == {"NOTE", "REF"}


@pytest.mark.parametrize("paper", PAPERS)
def test_large_piece_is_tiled(paper):
    drawing = sheet(320, 400)
    *tiles, notes = printed(drawing, paper)
    assert len(tiles) == 4
    for page, name in zip(tiles, ("A1", "A2", "B1", "B2"), strict=True):
        assert spoken(page.footer, f"tile {name} of 2 x 2")
        assert spoken(page.footer, name, 2 * LETTER_MM)
        assert {layer_of(stroke) for stroke in page.drawn} == {*PIECE, "REF"}
    assert not spoken(notes.footer, "tile")
    windows = windows_of(tiles, drawing.drawn[0].points)
    (a1, a2, b1, b2) = windows
    for left, right in ((a1, a2), (b1, b2)):
        assert left[1, 0] - right[0, 0] == pytest.approx(OVERLAP, abs=NEAR)
        np.testing.assert_allclose(left[:, 1], right[:, 1], atol=NEAR)
    for upper, lower in ((a1, b1), (a2, b2)):
        assert lower[1, 1] - upper[0, 1] == pytest.approx(OVERLAP, abs=NEAR)
        np.testing.assert_allclose(upper[:, 0], lower[:, 0], atol=NEAR)
    low, high = windows[:, 0].min(axis=0), windows[:, 1].max(axis=0)
    np.testing.assert_allclose(low + high, [320, 400], atol=NEAR)  # in the middle


def test_neighbours_share_their_crosses():
    drawing = sheet(320, 400)
    tiles = printed(drawing)[:4]
    shared = []
    for page, window in zip(tiles, windows_of(tiles, drawing.drawn[0].points), strict=True):
        arms = [s for s in page.drawn if layer_of(s) == "REF"]
        assert len(arms) == 8
        for arm in arms:
            assert (arm.points >= page.clip[0]).all()
            assert (arm.points <= page.clip[1]).all()
        middles = np.array([arm.points.mean(axis=0) for arm in arms]) - page.clip[0] + window[0]
        np.testing.assert_allclose(middles[::2], middles[1::2], atol=NEAR)
        shared += middles[::2].tolist()
        inset = window + np.array([[OVERLAP / 2], [-OVERLAP / 2]])
        np.testing.assert_allclose(middles.min(axis=0), inset[0], atol=NEAR)
        np.testing.assert_allclose(middles.max(axis=0), inset[1], atol=NEAR)
    assert len(np.unique(np.round(shared, 2), axis=0)) == 9


@pytest.mark.parametrize(
    ("width", "height", "upright", "count"), [(380, 270, True, 2), (270, 380, False, 3)]
)
def test_paper_is_turned_for_fewer_tiles(width, height, upright, count):
    pages = printed(piece(width, height))
    assert [page.size[0] < page.size[1] for page in pages] == [upright] * count


def test_empty_tiles_are_left_out():
    drawing = Drawing("Frame", (rectangle("CUT_OUTER", 600, 800),), ())
    pages = printed(drawing)
    names = [
        name for name in FRAME for page in pages if spoken(page.footer, f"tile {name} of 3 x 4")
    ]
    assert names == FRAME
    assert len(pages) == len(FRAME)


def test_tiles_are_those_that_a_line_crosses():
    slant = Drawing("Slant", (polyline("CUT_OUTER", (0, 0), (600, 800)),), ())
    pages = printed(slant)
    windows = windows_of(pages, slant.drawn[0].points)
    at = np.linspace(0, 1, 2001)[:, None, None] * [600, 800]
    inside = ((at > windows[:, 0] - NEAR) & (at < windows[:, 1] + NEAR)).all(axis=2)
    assert inside.any(axis=1).all()
    assert inside.any(axis=0).all()


def test_large_notes_are_tiled_too():
    texts = tuple(Text("NOTE", f"Note {k}", 40 * k, 260, 3.0) for k in range(9))
    pages = printed(piece(320, 200, texts=texts))
    tiled = [bool(spoken(page.footer, "tile")) for page in pages]
    assert tiled == [True] * 4
    names = [
        n
        for page in pages
        for n in ("A1", "A2", "B1", "B2")
        if spoken(page.footer, f"tile {n} of 1 x 2")
    ]
    assert names == ["A1", "A2", "B1", "B2"]
    for k in range(9):
        assert any(spoken(page.drawn, f"Note {k}", 3.0) for page in pages[2:])


def test_parts_stand_apart_in_their_order():
    side, plan = piece(150, 250), Drawing("Plan", (rectangle("NOTE", 100, 90),), ())
    shifted = Line("NOTE", plan.drawn[0].points + np.array([0, 300]))
    whole = Drawing("Whole", (*side.drawn, shifted), ())
    pages = read(write_pdf(whole, parts=(plan, side)))
    assert len(pages) == 2
    for page, part in zip(pages, (plan, side), strict=True):
        offset_of(page, lines_of(part))
        assert spoken(page.footer, "Whole")
    tiles = read(write_pdf(whole, parts=(whole,)))
    assert all(spoken(page.footer, "tile") for page in tiles)
    (page,) = read(write_pdf(plan, parts=(plan, side)))
    offset_of(page, lines_of(plan))


def test_printers_are_told_not_to_scale():
    data = write_pdf(sheet(60, 40))
    (catalogue,) = re.findall(
        rb"obj\s*<<(?:(?!endobj).)*?/Type /Catalog(?:(?!endobj).)*", data, re.DOTALL
    )
    key = re.search(rb"/ViewerPreferences (\d+) 0 R", catalogue)
    if key:
        catalogue = re.search(rb"\b%s 0 obj(.*?)endobj" % key.group(1), data, re.DOTALL).group(1)
    assert re.search(rb"/PrintScaling /None\b", catalogue)
    assert b"/Title (Plate: part.svg)" in data


def test_same_drawing_same_bytes(monkeypatch):
    drawing = sheet(320, 400)
    data = write_pdf(drawing)
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1234567890")
    assert write_pdf(sheet(320, 400)) == data
    monkeypatch.delenv("SOURCE_DATE_EPOCH")
    with monkeypatch.context() as patch:
        patch.setattr(time, "time", lambda: 1.0e9)
        again = write_pdf(drawing)
    assert again == data
    assert b"2000010100" in data


def test_file_is_small():
    assert len(write_pdf(build_sheet(bulb()).drawing)) < 60_000


def test_nothing_drawn():
    with pytest.raises(ValueError, match="at least one"):
        write_pdf(Drawing("Empty", (), ()))


@pytest.mark.skipif(shutil.which("pdftotext") is None, reason="needs poppler")
def test_lettering_can_be_searched(tmp_path):
    """As poppler reads it: every text of the sheet, none on a page that does not show it."""
    sheet = build_sheet(bulb())
    file = tmp_path / "template.pdf"
    file.write_bytes(write_pdf(sheet.drawing, "letter", sheet.parts))
    words = subprocess.run(
        ["pdftotext", "-layout", file, "-"], capture_output=True, text=True, check=True
    ).stdout
    first, second, *_ = words.split("\f")
    for said in ("x = 0: edge of the clamp", "Turn 2", "Closed end"):
        assert said in first
        assert said not in second
    for said in ("Cut template: bulb.png", "Cut the blue lines only", "seam 270°", "100 mm"):
        assert said in second


def test_lettering_that_is_searched_lies_on_its_strokes():
    drawing = Drawing("", (), (Text("NOTE", "Weld 7°", 10.0, 20.0, 5.0),))
    data = read_text(write_pdf(drawing))
    x0, _, x1, _ = drawing.texts[0].box
    size = 5.0 / 0.718  # Helvetica's capitals
    (scale,) = re.findall(rf"/F1 {size:.6f} Tf \S+ TL 3 Tr ([\d.]+) Tz", data)
    wide = stringWidth("Weld 7°", "Helvetica", size) * float(scale) / 100.0
    assert wide == pytest.approx(x1 - x0, abs=0.01)
