"""PDF pages read back: lines and clip boxes in mm."""

from __future__ import annotations

import base64
import re
import zlib
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

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


def read_text(data: bytes) -> str:
    """Operators of a file of one page."""
    objects = dict(re.findall(rb"(\d+) 0 obj\b(.*?)endobj", data, re.DOTALL))
    (content,) = (body for body in objects.values() if b"/FlateDecode" in body)
    coded = re.search(rb"stream\n(.*?)endstream", content, re.DOTALL).group(1).strip()
    return zlib.decompress(base64.a85decode(coded.removesuffix(b"~>"))).decode("latin-1")


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
