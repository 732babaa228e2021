"""The PDF writer, read back: pages, lines and clip boxes in mm."""

from __future__ import annotations

import base64
import re
import time
import zlib
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import pytest

from profiletool.template.drawing import COLOURS, Drawing, Line, Text, circle, polyline
from profiletool.template.layout import build_sheet
from profiletool.template.pdf import LETTER_MM, write_pdf
from tests.template.designs import bulb, long_tube, tight

PAPERS = {"a4": (210.0, 297.0), "letter": (215.9, 279.4)}
MARGIN, OVERLAP = 5.0, 10.0
MM_PER_PT = 25.4 / 72
NEAR = 1e-3
PIECE = ("CUT_OUTER", "CUT_INNER", "MARK")
FRAME = ["A1", "A2", "A3", "A4", "B1", "B4", "C1", "C2", "C3", "C4"]
ALARMS = " - INFEASIBLE - NOT VERIFIED"
OPERANDS = {"cm": 6, "RG": 3, "w": 1, "J": 1, "j": 1, "m": 2, "l": 2, "re": 4}


@dataclass(frozen=True)
class Stroke:
    """A line on a page, mm from its lower left corner."""

    points: np.ndarray
    closed: bool
    colour: tuple[float, ...]
    width: float
    style: tuple[int, int]


@dataclass(frozen=True)
class Page:
    size: tuple[float, float]
    clip: np.ndarray  # (2 corners, 2)
    drawn: list[Stroke]
    footer: list[Stroke]


def colour(layer):
    return tuple(round(int(COLOURS[layer][1][k : k + 2], 16) / 255, 3) for k in (1, 3, 5))


LAYERS = {colour(name): name for name in COLOURS}


def read(data: bytes) -> list[Page]:
    objects = dict(re.findall(rb"(\d+) 0 obj\b(.*?)endobj", data, re.DOTALL))
    (kids,) = re.findall(rb"/Kids \[(.*?)\]", b"".join(objects.values()), re.DOTALL)
    return [read_page(objects, objects[key]) for key in re.findall(rb"(\d+) 0 R", kids)]


def read_page(objects, body) -> Page:
    box = [float(n) for n in re.search(rb"/MediaBox \[(.*?)\]", body).group(1).split()]
    assert box[:2] == [0, 0]
    content = objects[re.search(rb"/Contents (\d+) 0 R", body).group(1)]
    assert b"/FlateDecode" in content
    coded = re.search(rb"stream\n(.*?)endstream", content, re.DOTALL).group(1).strip()
    text = zlib.decompress(base64.a85decode(coded.removesuffix(b"~>"))).decode("ascii")
    clip, strokes = run(text)
    drawn = [s for s, clipped in strokes if clipped]
    footer = [s for s, clipped in strokes if not clipped]
    return Page((box[2] * MM_PER_PT, box[3] * MM_PER_PT), clip, drawn, footer)


def run(text: str):
    """Follow a page's operators; return its clip box, and its strokes with whether clipped."""
    matrix, state, stack, path, strokes = np.eye(3), {}, [], [], []
    clip, clipping = None, False

    def placed(points):
        return (np.column_stack([points, np.ones(len(points))]) @ matrix)[:, :2] * MM_PER_PT

    for word in re.sub(r"BT.*?ET", "", text).split():
        if word[-1].isdigit():
            stack.append(float(word))
            continue
        assert len(stack) == OPERANDS.get(word, 0), word
        values, stack = stack, []
        if word == "cm":
            assert not path
            matrix = np.column_stack([np.reshape(values, (3, 2)), [0, 0, 1]]) @ matrix
        elif word in ("RG", "w", "J", "j"):
            state[word] = values
        elif word == "m":
            path.append(([values], []))
        elif word == "l":
            path[-1][0].append(values)
        elif word == "h":
            path[-1][1].append(word)
        elif word == "re":
            x, y, width, height = values
            path.append(([[x, y], [x + width, y + height]], [word]))
        elif word in ("W", "W*"):
            clipping = True
        elif word == "n":
            if clipping:
                assert clip is None
                ((corners, _),) = path
                clip, clipping = placed(corners), False
            path = []
        elif word == "S":
            rgb = tuple(round(value, 3) for value in state["RG"])
            width = state["w"][0] * matrix[0, 0] * MM_PER_PT
            style = int(state["J"][0]), int(state["j"][0])
            for points, closed in path:
                stroke = Stroke(placed(points), bool(closed), rgb, width, style)
                strokes.append((stroke, clip is not None))
            path = []
        else:
            raise AssertionError(word)
    return clip, strokes


def spoken(strokes, text, height=LETTER_MM):
    """Return where ``text`` is lettered among ``strokes``: corners (2, 2) each time."""
    wanted = Text("REF", text, 0.0, 0.0, height).lines()
    found = []
    for k in range(len(strokes) - len(wanted) + 1):
        points = [s.points for s in strokes[k : k + len(wanted)]]
        if all(len(a) == len(b) for a, b in zip(points, wanted, strict=True)):
            shift = np.concatenate(points) - np.concatenate(wanted)
            if np.ptp(shift, axis=0).max() < NEAR:
                every = np.concatenate(points)
                found.append(np.array([every.min(axis=0), every.max(axis=0)]))
    return found


def lines_of(drawing, layers=tuple(COLOURS)):
    return [line for layer in drawing.layers if layer.name in layers for line in layer.lines]


def offset_of(page, lines):
    """Return where the drawing's origin lies on a page that shows all ``lines`` at true scale."""
    shift = page.drawn[0].points[0] - lines[0].points[0]
    for stroke, line in zip(page.drawn, lines, strict=True):
        np.testing.assert_allclose(stroke.points - shift, line.points, atol=NEAR)
        assert (stroke.closed, stroke.colour) == (line.closed, colour(line.layer))
    return shift


def layer_of(stroke):
    return LAYERS[stroke.colour]


def dotted(line):
    """Points (N, 2) along a line, no farther than 1 mm apart."""
    ends = np.vstack([line.points, line.points[:1]]) if line.closed else line.points
    dots = []
    for a, b in pairwise(ends):
        share = np.linspace(0, 1, 2 + int(np.hypot(*(b - a))))[:, None]
        dots.append(a + share * (b - a))
    return np.concatenate(dots)


def windows_of(pages, outline):
    """Return what each page shows of the drawing (N, 2 corners, 2), by where its outline lies."""
    found = [next(s for s in page.drawn if layer_of(s) == "CUT_OUTER") for page in pages]
    shifts = [stroke.points[0] - outline[0] for stroke in found]
    return np.array([page.clip - shift for page, shift in zip(pages, shifts, strict=True)])


def rectangle(layer, width, height):
    corners = np.array([[0.0, 0.0], [width, 0.0], [width, height], [0.0, height]])
    return Line(layer, corners, closed=True)


def piece(width, height, title="Plate: part.svg", texts=()):
    slits = [polyline("CUT_INNER", (x, 5), (x, height - 5)) for x in np.arange(7.123457, width, 20)]
    mark = circle("MARK", width / 2, height / 2, min(width, height) / 3)
    return Drawing(title, (rectangle("CUT_OUTER", width, height), *slits, mark), texts)


def sheet(width, height, title="Plate: part.svg", above=10):
    """Build a piece with a title above it, and a bar of 100 mm with a legend below."""
    plate = piece(width, height, title)
    bar = polyline("REF", (0, -10), (100, -10))
    texts = (
        Text("NOTE", "Title", 0, height + above, 5.0),
        Text("NOTE", "Legend", 0, -20, 2.5),
        Text("REF", "100 mm", 50, -15, 2.5, "centre"),
    )
    return Drawing(title, (*plate.drawn, bar), texts)


def printed(drawing, paper="a4"):
    """Read the pages of a drawing whose piece and notes, closed up, stand apart if they must."""
    piece = tuple(line for line in drawing.drawn if line.layer in PIECE)
    notes = tuple(line for line in drawing.drawn if line.layer not in PIECE)
    marks = tuple(text for text in drawing.texts if text.layer in PIECE)
    words = tuple(
        replace(text, y=min(text.y, 0.0)) for text in drawing.texts if text.layer not in PIECE
    )
    parts = Drawing(drawing.title, piece, marks), Drawing(drawing.title, notes, words)
    return read(write_pdf(drawing, paper, parts))


DRAWINGS = {
    **{b.__name__: lambda b=b: build_sheet(b()).drawing for b in (bulb, long_tube, tight)},
    "small": lambda: sheet(60, 40),
    "long": lambda: sheet(250, 130, above=70),
    "large": lambda: sheet(320, 400),
    "brim": lambda: piece(199.9, 100),
    "no room": lambda: piece(199.5, 280.5, "No room"),
    "untitled": lambda: piece(30, 20, ""),
    "alarming": lambda: sheet(320, 400, "Plate: " + "a long name " * 7 + ALARMS),
}


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
    for page, window in zip(pages, windows_of(pages, lines[0].points), strict=True):
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
