"""Drawings as PDF at true scale, for office printers: on one page, on pages by part, in tiles."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import replace
from itertools import groupby
from typing import Literal

import numpy as np
from reportlab.pdfbase.pdfmetrics import stringWidth
from reportlab.pdfgen.canvas import Canvas

from profiletool.template.drawing import COLOURS, RULER_MM, Drawing, Line, Text, ruler
from profiletool.template.paging import (
    CUT_MM,
    FOOTER_MM,
    INK_MM,
    MARGIN_MM,
    PEN_MM,
    Page,
    Size,
    pages_of,
    strip_mm,
)  # fmt: skip

Paper = Literal["a4", "letter"]

PAPERS_MM: dict[Paper, Size] = {"a4": (210.0, 297.0), "letter": (215.9, 279.4)}
PT_PER_MM = 72 / 25.4
DECIMALS = 4  # of the coordinates, mm
LETTER_MM = 2.2
_FONT, _CAPITAL = "Helvetica", 0.718  # every reader has it; height of its capitals


def write_pdf(drawing: Drawing, paper: Paper = "a4", parts: Sequence[Drawing] = ()) -> bytes:
    """Return the bytes of a PDF file of ``drawing`` at true scale.

    A drawing that fits one page, upright or across, stands on one. Otherwise each part has pages
    of its own, and a part larger than a page is tiled: neighbouring tiles overlap by 10 mm and
    share crosses. Every page says what it is, and can be measured: it shows a bar of 100 mm,
    unless what just fits on it leaves no room. The same drawing gives the same bytes.

    Parameters
    ----------
    drawing : Drawing
    paper : {"a4", "letter"}
    parts : sequence of Drawing
        What stands apart where the drawing does not fit one page, in the order of the pages; by
        default the drawing is tiled as it is.

    Returns
    -------
    bytes

    Raises
    ------
    ValueError
        Nothing is drawn.
    """
    pages = pages_of(drawing, PAPERS_MM[paper], parts)
    canvas = Canvas("", pageCompression=1, invariant=1)
    # A date set in the environment (SOURCE_DATE_EPOCH) would still get into date and identifier.
    canvas.setDateFormatter(lambda *_: "D:20000101000000Z")
    canvas._doc.signature = hashlib.md5(usedforsecurity=False)
    canvas.setTitle(drawing.title)
    canvas.setCreator("profiletool")
    canvas.setAuthor("")
    canvas.setSubject("")
    canvas.setViewerPreference("PrintScaling", "None")
    for number, page in enumerate(pages, start=1):
        _draw(canvas, page, _footer(page, drawing.title, f"page {number} of {len(pages)}"))
    return bytes(canvas.getpdfdata())


def _footer(page: Page, title: str, number: str) -> tuple[list[Line], list[Text]]:
    """Return what stands below the drawing, in page coordinates, mm."""
    left, right = MARGIN_MM + INK_MM, page.size[0] - MARGIN_MM - INK_MM
    y = MARGIN_MM + INK_MM
    said = [f"tile {page.tile} of {page.rows} x {page.columns}"] if page.tile else []
    said += [number, "print at 100 %, no scaling"]
    end = Text("REF", " - ".join(said), right, y, LETTER_MM, "right")
    name = Text("REF", title, left, y, LETTER_MM)
    texts = [end, _shortened(name, end.box[0] - 2 * LETTER_MM - left)]
    lines: list[Line] = []
    if page.bar:
        y += FOOTER_MM - 1.0
        lines += ruler(left, y)
        texts.append(Text("REF", "100 mm", left + RULER_MM + LETTER_MM, y, LETTER_MM))
        texts.append(Text("REF", page.tile, right, y, 2 * LETTER_MM, "right"))
    return lines, texts


def _shortened(text: Text, width: float) -> Text:
    """Return ``text`` no wider than ``width`` mm: its end tells what is wrong, so that is kept."""
    whole = short = text.text
    kept = len(whole)
    while kept and replace(text, text=short).width > width:
        kept -= 1
        head = kept // 3
        short = f"{whole[:head]}...{whole[len(whole) - kept + head :]}"
    return replace(text, text=short)


def _draw(canvas: Canvas, page: Page, footer: tuple[list[Line], list[Text]]) -> None:
    """Add ``page`` to ``canvas``; on the page the drawing stands above the footer."""
    width, height = page.size
    x0, y0, x1, y1 = page.shown
    left, bottom = MARGIN_MM, MARGIN_MM + strip_mm(page.bar)
    canvas.setPageSize((width * PT_PER_MM, height * PT_PER_MM))
    canvas.scale(PT_PER_MM, PT_PER_MM)
    canvas.setLineCap(1)
    canvas.setLineJoin(1)
    lines, texts = footer
    strokes = [Line(text.layer, stroke) for text in texts for stroke in text.lines()]
    _stroke(canvas, lines + strokes, (0.0, 0.0))
    _write(canvas, texts, (0.0, 0.0))
    frame = canvas.beginPath()
    frame.rect(left, bottom, x1 - x0, y1 - y0)
    canvas.clipPath(frame, stroke=0)
    _stroke(canvas, page.lines, (left - x0, bottom - y0))
    _write(canvas, page.texts, (left - x0, bottom - y0))
    canvas.showPage()


def _write(canvas: Canvas, texts: Sequence[Text], shift: tuple[float, float]) -> None:
    """Lay lettering that is not seen upon its strokes: it can be searched, copied and read."""
    for text in texts:
        said = text.text.encode("cp1252", "replace").decode("cp1252")
        size = text.height / _CAPITAL
        wide = stringWidth(said, _FONT, size)
        if not wide:
            continue
        x0, y0, x1, _ = text.box
        x, y = (x1 if text.upward else x0) + shift[0], y0 + shift[1]
        written = canvas.beginText()
        written.setFont(_FONT, size)
        written.setTextRenderMode(3)  # neither filled nor stroked
        written.setHorizScale(round(100.0 * text.width / wide, DECIMALS))
        turned = (0.0, 1.0, -1.0, 0.0) if text.upward else (1.0, 0.0, 0.0, 1.0)
        written.setTextTransform(*turned, round(x, DECIMALS), round(y, DECIMALS))
        written.textOut(said)
        canvas.drawText(written)


def _stroke(canvas: Canvas, lines: Sequence[Line], shift: tuple[float, float]) -> None:
    """Draw ``lines``, each layer as one path."""
    for layer, group in groupby(lines, key=lambda line: line.layer):
        canvas.setStrokeColor(COLOURS[layer][1])
        canvas.setLineWidth(CUT_MM if layer.startswith("CUT") else PEN_MM)
        path = canvas.beginPath()
        for line in group:
            first, *others = np.round(line.points + shift, DECIMALS).tolist()
            path.moveTo(*first)
            for point in others:
                path.lineTo(*point)
            if line.closed:
                path.close()
        canvas.drawPath(path)
