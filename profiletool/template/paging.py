"""The pages that a drawing takes at true scale: one, one for each part, or tiles."""

from __future__ import annotations

import math
import string
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from profiletool.template.drawing import RULER_MM, Box, Drawing, Line, Text, extent, polyline

Size = tuple[float, float]

MARGIN_MM = 5.0  # printers do not reach the edge of the paper
OVERLAP_MM = 10.0  # of neighbouring tiles
CUT_MM, PEN_MM = 0.15, 0.18  # widths of cuts, and of all that is to be read
INK_MM = PEN_MM / 2  # what a line covers beside it
FOOTER_MM, BAR_ROW_MM = 6.0, 5.0  # heights of the rows below the drawing
CROSS_MM = 4.0  # arm; shorter than half the overlap, so that neighbours show all of it


@dataclass(frozen=True)
class Page:
    """What a page shows: all that lies in the box ``shown`` of the drawing, mm.

    ``lines`` hold the strokes of its ``texts``, which are there to be searched and read aloud.

    ``tile`` is its name where it is one of ``rows`` x ``columns``.
    """

    size: Size
    shown: Box
    lines: tuple[Line, ...]
    bar: bool
    tile: str = ""
    rows: int = 0
    columns: int = 0
    texts: tuple[Text, ...] = ()


def pages_of(drawing: Drawing, paper: Size, parts: Sequence[Drawing]) -> list[Page]:
    """Lay a drawing out on one page, or on pages for each of its parts."""
    pages = _laid_out(_lines(drawing), paper)
    if len(pages) == 1:
        return [_with_texts(page, drawing) for page in pages]
    pages, rows = [], 0
    for part in parts or (drawing,):
        if lines := _lines(part):
            pages += [_with_texts(page, part) for page in _laid_out(lines, paper, rows)]
            rows += pages[-1].rows
    return pages


def _with_texts(page: Page, drawing: Drawing) -> Page:
    """Add the texts that a page shows, by their middles."""
    x0, y0, x1, y1 = page.shown
    boxes = ((text, text.box) for text in drawing.texts)
    shown = (
        text for text, (a, b, c, d) in boxes if x0 <= (a + c) / 2 <= x1 and y0 <= (b + d) / 2 <= y1
    )
    return replace(page, texts=tuple(shown))


def _lines(drawing: Drawing) -> tuple[Line, ...]:
    return tuple(line for layer in drawing.layers for line in layer.lines)


def _laid_out(lines: Sequence[Line], paper: Size, before: int = 0) -> list[Page]:
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


def _tiles(lines: Sequence[Line], size: Size, bar: bool, before: int) -> list[Page]:
    """Return the pages of ``size`` that show ``lines``, row by row; a single one is no tile."""
    x0, y0, x1, y1 = _extent(lines)
    step_x = size[0] - 2 * MARGIN_MM - OVERLAP_MM
    step_y = size[1] - 2 * MARGIN_MM - OVERLAP_MM - strip_mm(bar)
    columns, rows = _count(x1 - x0, step_x), _count(y1 - y0, step_y)
    if columns == rows == 1:
        return [Page(size, _box((x0 + x1) / 2, (y0 + y1) / 2, step_x, step_y), tuple(lines), bar)]
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
                pages.append(Page(size, shown, drawn, bar, name, rows, columns))
    return pages


def strip_mm(bar: bool) -> float:
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
