"""The sheet to photograph an object on, as PDF at true scale."""

from __future__ import annotations

import hashlib

import numpy as np
from reportlab.pdfgen.canvas import Canvas
from reportlab.pdfgen.pathobject import PDFPathObject

from profiletool.image.sheet.board import Board, Paper, board_for, ink
from profiletool.records.units import FloatArray
from profiletool.template.drawing import RULER_MM, Text
from profiletool.template.pdf import PT_PER_MM

_DECIMALS = 4  # of the coordinates, mm
_PEN_MM = 0.2
_BAR_MM = 3.8  # from the frame: clear of it, and of the paper's edge that printers do not reach
_TICK_MM, _LETTER_MM = 1.6, 2.0


def calibration_sheet(paper: Paper) -> bytes:
    """Return the bytes of a PDF file of the sheet, at 100 %.

    Squares and markers are filled; a bar of 100 mm stands along the left edge and along the lower
    one, since printers may stretch one direction only. The same paper gives the same bytes.

    Parameters
    ----------
    paper : {"a4", "letter"}
    """
    board = board_for(paper)
    width, height = board.paper_mm
    canvas = Canvas(
        "", pagesize=(width * PT_PER_MM, height * PT_PER_MM), pageCompression=1, invariant=1
    )
    # A date set in the environment (SOURCE_DATE_EPOCH) would still get into date and identifier.
    canvas.setDateFormatter(lambda *_: "D:20000101000000Z")
    canvas._doc.signature = hashlib.md5(usedforsecurity=False)
    canvas.setTitle(_name(board))
    canvas.setCreator("profiletool")
    canvas.setAuthor("")
    canvas.setSubject("")
    canvas.setViewerPreference("PrintScaling", "None")
    canvas.scale(PT_PER_MM, PT_PER_MM)
    _fill(canvas, board)
    _rule(canvas, board)
    canvas.showPage()
    return bytes(canvas.getpdfdata())


def _name(board: Board) -> str:
    return f"profiletool sheet {board.name}"


def _fill(canvas: Canvas, board: Board) -> None:
    """Fill all cells as one path: apart, neighbours would show a seam between them."""
    left, top = board.origin_mm
    path = canvas.beginPath()
    for x0, y0, x1, y1 in np.round(ink(board), _DECIMALS).tolist():
        path.rect(
            round(left + x0, _DECIMALS),
            round(board.paper_mm[1] - top - y1, _DECIMALS),
            round(x1 - x0, _DECIMALS),
            round(y1 - y0, _DECIMALS),
        )
    canvas.setFillGray(0)
    canvas.drawPath(path, stroke=0, fill=1)


def _rule(canvas: Canvas, board: Board) -> None:
    """Draw the bars and the lettering, in the margin."""
    left, below = board.origin_mm
    canvas.setStrokeGray(0)
    canvas.setLineWidth(_PEN_MM)
    x, y = left - _BAR_MM, below - _BAR_MM
    path = canvas.beginPath()
    for start, along, out in (
        (np.array([left, y]), np.array([1.0, 0.0]), np.array([0.0, -1.0])),
        (np.array([x, below]), np.array([0.0, 1.0]), np.array([-1.0, 0.0])),
    ):
        _line(path, np.array([start, start + RULER_MM * along]))
        for k in range(11):
            foot = start + k * RULER_MM / 10.0 * along
            length = _TICK_MM if k % 5 == 0 else _TICK_MM / 2.0
            _line(path, np.array([foot, foot + length * out]))
    after = left + RULER_MM + 2.0 * _LETTER_MM
    lower, upper = y - _TICK_MM, board.paper_mm[1] - below + _BAR_MM - _LETTER_MM
    for text in (
        Text("NOTE", "print at 100 %, measure both bars: 100 mm", after, lower, _LETTER_MM),
        Text("NOTE", _name(board), left, upper, _LETTER_MM),
        Text(
            "NOTE",
            "lay the object in the white field, its top up",
            board.paper_mm[0] - left,
            upper,
            _LETTER_MM,
            "right",
        ),
    ):
        for stroke in text.lines():
            _line(path, stroke)
    canvas.drawPath(path, stroke=1, fill=0)


def _line(path: PDFPathObject, points: FloatArray) -> None:
    first, *others = np.round(points, _DECIMALS).tolist()
    path.moveTo(*first)
    for point in others:
        path.lineTo(*point)
