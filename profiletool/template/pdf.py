"""Drawings as PDF at true scale, for office printers: on one page, on pages by part, in tiles."""

from __future__ import annotations

import hashlib
import math
import string
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from typing import Literal

import numpy as np
from reportlab.pdfgen.canvas import Canvas

from profiletool.template.drawing import (
    COLOURS,
    RULER_MM,
    Box,
    Drawing,
    Line,
    Text,
    extent,
    polyline,
    ruler,
)

Paper = Literal["a4", "letter"]
Size = tuple[float, float]

PAPERS_MM: dict[Paper, Size] = {"a4": (210.0, 297.0), "letter": (215.9, 279.4)}
PT_PER_MM = 72 / 25.4
MARGIN_MM = 5.0  # printers do not reach the edge of the paper
OVERLAP_MM = 10.0  # of neighbouring tiles
CUT_MM, PEN_MM = 0.15, 0.18  # widths of cuts, and of all that is to be read
INK_MM = PEN_MM / 2  # what a line covers beside it
DECIMALS = 4  # of the coordinates, mm
FOOTER_MM, BAR_ROW_MM = 6.0, 5.0  # heights of the rows below the drawing
LETTER_MM = 2.2
CROSS_MM = 4.0  # arm; shorter than half the overlap, so that neighbours show all of it


@dataclass(frozen=True)
class _Page:
    """What a page shows: all that lies in the box ``shown`` of the drawing, mm.

    ``tile`` is its name where it is one of ``rows`` x ``columns``.
    """

    size: Size
    shown: Box
    lines: tuple[Line, ...]
    bar: bool
    tile: str = ""
    rows: int = 0
    columns: int = 0


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
    pages = _pages(drawing, PAPERS_MM[paper], parts)
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


def _pages(drawing: Drawing, paper: Size, parts: Sequence[Drawing]) -> list[_Page]:
    whole = _lines(drawing)
    pages = _laid_out(whole, paper)
    if len(pages) == 1:
        return pages
    apart = [_lines(part) for part in parts or (drawing,)]
    pages = []
    rows = 0
    for lines in filter(None, apart):
        pages += _laid_out(lines, paper, rows)
        rows += pages[-1].rows
    return pages


def _lines(drawing: Drawing) -> tuple[Line, ...]:
    return tuple(line for layer in drawing.layers for line in layer.lines)


def _laid_out(lines: Sequence[Line], paper: Size, before: int = 0) -> list[_Page]:
    """Return one page wherever possible, else as few tiles as possible.

    Their names go on from ``before`` rows of other tiles: no two of a file are the same.
    """
    sizes = paper, paper[::-1]
    plain = [_tiles(lines, size, False, before) for size in sizes]
    barred = [_tiles(lines, size, True, before) for size in sizes]
    for pages in plain if _measurable(lines) else barred + plain:
        if len(pages) == 1:
            return pages
    return min(barred, key=len)


def _measurable(lines: Sequence[Line]) -> bool:
    """Tell whether there is a bar of 100 mm among ``lines``."""
    return any(
        line.layer == "REF"
        and len(line.points) == 2
        and math.isclose(math.dist(*line.points), RULER_MM)
        for line in lines
    )


def _tiles(lines: Sequence[Line], size: Size, bar: bool, before: int) -> list[_Page]:
    """Return the pages of ``size`` that show ``lines``, row by row; a single one is no tile."""
    x0, y0, x1, y1 = _extent(lines)
    step_x = size[0] - 2 * MARGIN_MM - OVERLAP_MM
    step_y = size[1] - 2 * MARGIN_MM - OVERLAP_MM - _strip(bar)
    columns, rows = _count(x1 - x0, step_x), _count(y1 - y0, step_y)
    if columns == rows == 1:
        return [_Page(size, _box((x0 + x1) / 2, (y0 + y1) / 2, step_x, step_y), tuple(lines), bar)]
    left = (x0 + x1 - (columns - 1) * step_x) / 2
    top = (y0 + y1 + (rows - 1) * step_y) / 2
    pages = []
    for row in range(rows):
        for column in range(columns):
            x, y = left + column * step_x, top - row * step_y
            shown = _box(x, y, step_x, step_y)
            if seen := _seen(lines, shown):
                drawn = _crosses(x, y, step_x, step_y) + seen
                name = f"{_letter(before + row)}{column + 1}"
                pages.append(_Page(size, shown, drawn, bar, name, rows, columns))
    return pages


def _strip(bar: bool) -> float:
    """Return the height of what stands below the drawing, mm."""
    return FOOTER_MM + BAR_ROW_MM if bar else FOOTER_MM


def _count(length: float, step: float) -> int:
    """Return how many tiles cover ``length``; the outer ones reach half an overlap farther."""
    return max(1, math.ceil(round((length - OVERLAP_MM) / step, 9)))


def _box(x: float, y: float, step_x: float, step_y: float) -> Box:
    """Return what a tile shows around its middle (x, y): its own area and the overlaps."""
    half_x, half_y = (step_x + OVERLAP_MM) / 2, (step_y + OVERLAP_MM) / 2
    return x - half_x, y - half_y, x + half_x, y + half_y


def _letter(row: int) -> str:
    """Return A to Z, then AA to ZZ and so on."""
    return string.ascii_uppercase[row % 26] * (row // 26 + 1)


def _crosses(x: float, y: float, step_x: float, step_y: float) -> tuple[Line, ...]:
    """Return crosses at the corners of a tile's own area, where its neighbours have theirs."""
    corners = [(x + a * step_x / 2, y + b * step_y / 2) for a in (-1, 1) for b in (-1, 1)]
    return tuple(
        polyline("REF", (u - across, v - up), (u + across, v + up))
        for u, v in corners
        for across, up in ((CROSS_MM, 0.0), (0.0, CROSS_MM))
    )


def _extent(lines: Sequence[Line]) -> Box:
    """Return the extent of ``lines`` with the ink beside them."""
    x0, y0, x1, y1 = extent(lines)
    return x0 - INK_MM, y0 - INK_MM, x1 + INK_MM, y1 + INK_MM


def _seen(lines: Sequence[Line], box: Box) -> tuple[Line, ...]:
    """Return the lines of which some part lies in ``box``."""
    rings = [np.vstack([p.points, p.points[:1]]) if p.closed else p.points for p in lines]
    owner = np.repeat(np.arange(len(lines)), [len(ring) - 1 for ring in rings])
    low, high = np.array(box[:2]), np.array(box[2:])
    half = (high - low) / 2
    start = np.concatenate([ring[:-1] for ring in rings]) - (low + high) / 2
    end = np.concatenate([ring[1:] for ring in rings]) - (low + high) / 2
    along, middle = end - start, (start + end) / 2
    # A segment and a box are apart along an axis, or across the segment.
    meet = (np.abs(middle) <= half + np.abs(along) / 2).all(axis=1)
    aside = np.abs(along[:, 0] * middle[:, 1] - along[:, 1] * middle[:, 0])
    meet &= aside <= np.abs(along) @ half[::-1]
    return tuple(lines[k] for k in np.unique(owner[meet]))


def _footer(page: _Page, title: str, number: str) -> list[Line]:
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
    return lines + [Line("REF", stroke) for text in texts for stroke in text.lines()]


def _shortened(text: Text, width: float) -> Text:
    """Return ``text`` no wider than ``width`` mm: its end tells what is wrong, so that is kept."""
    whole = short = text.text
    kept = len(whole)
    while kept and replace(text, text=short).width > width:
        kept -= 1
        head = kept // 3
        short = f"{whole[:head]}...{whole[len(whole) - kept + head :]}"
    return replace(text, text=short)


def _draw(canvas: Canvas, page: _Page, footer: Sequence[Line]) -> None:
    """Add ``page`` to ``canvas``; on the page the drawing stands above the footer."""
    width, height = page.size
    x0, y0, x1, y1 = page.shown
    left, bottom = MARGIN_MM, MARGIN_MM + _strip(page.bar)
    canvas.setPageSize((width * PT_PER_MM, height * PT_PER_MM))
    canvas.scale(PT_PER_MM, PT_PER_MM)
    canvas.setLineCap(1)
    canvas.setLineJoin(1)
    _stroke(canvas, footer, (0.0, 0.0))
    frame = canvas.beginPath()
    frame.rect(left, bottom, x1 - x0, y1 - y0)
    canvas.clipPath(frame, stroke=0)
    _stroke(canvas, page.lines, (left - x0, bottom - y0))
    canvas.showPage()


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
