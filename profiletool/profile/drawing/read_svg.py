"""Profiles drawn in SVG."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from io import BytesIO
from typing import Any
from xml.etree import ElementTree

import numpy as np

from profiletool.errors import NoObject, UnreadableInput
from profiletool.profile.drawing.chain import (
    FLAT_MM,
    MAX_COORDINATE_MM,
    MAX_POINTS,
    Polyline,
    clean,
    join,
)
from profiletool.profile.drawing.svg_tree import CSS_PX_PER_INCH, MM_PER_PX, prepare, safe_tree
from profiletool.records.units import FloatArray

# What svgelements throws on values that it does not understand.
_DAMAGE = (ValueError, TypeError, IndexError, KeyError, AttributeError, ArithmeticError)


def read_svg(data: bytes, layer=None):
    """Read the chains of a drawing.

    Parameters
    ----------
    data : bytes
        SVG in UTF-8. Lengths without a unit are CSS pixels of 25.4/96 mm; width, height and
        viewBox scale as SVG says. No reference out of the file is followed.

    Returns
    -------
    list of Polyline
        In mm, y up, joined end to end; hidden shapes, markers, masks, symbols and a rectangle
        that is the page itself are left out.

    Raises
    ------
    UnreadableInput
        Not well-formed, a DOCTYPE or ENTITY declaration, values that are no numbers, references
        in a circle, or too much of anything.
    NoObject
        The page has no size.
    """
    from svgelements import SVG

    root = safe_tree(data)
    prepare(root)
    try:
        drawing = SVG.parse(
            BytesIO(ElementTree.tostring(root)), reify=False, ppi=CSS_PX_PER_INCH, on_error="raise"
        )
        if not isinstance(drawing, SVG):
            raise UnreadableInput("holds no <svg> element; export it again as plain SVG")
        if not drawing.width or not drawing.height:
            raise NoObject("the page has no width or no height; set both in mm")
        with np.errstate(all="ignore"):  # absurd numbers: the outcome is checked
            pieces = list(_pieces(drawing))
    except _DAMAGE as error:
        reason = f" ({error})" if str(error) else ""
        raise UnreadableInput(f"values that SVG does not know{reason}; export again") from None
    from profiletool.profile.drawing.drawn import Drawn
    from profiletool.records.profile import DrawnUnit
    return Drawn(join(_without_page(pieces, drawing.width, drawing.height)),DrawnUnit())


def _pieces(drawing: Any) -> Iterator[tuple[Polyline, bool]]:
    """Yield the chains and whether each was drawn as a rectangle."""
    from svgelements import Rect, Shape

    left = MAX_POINTS
    for shape in drawing.elements():
        if not isinstance(shape, Shape) or shape.values.get("visibility") in ("hidden", "collapse"):
            continue
        m = shape.transform
        matrix = MM_PER_PX * np.array([[m.a, m.c], [m.b, m.d]]) * [[1], [-1]]
        offset = MM_PER_PX * np.array([m.e, -m.f])
        scale = float(np.linalg.norm(matrix, 2)) if np.all(np.isfinite(matrix)) else np.inf
        for points, closed in _subpaths(shape.segments(transformed=False), scale):
            left -= len(points)
            if left <= 0:
                raise UnreadableInput(f"more than {MAX_POINTS} points; simplify the drawing")
            if len(points) > 1:
                yield clean(points @ matrix.T + offset, closed), isinstance(shape, Rect)


def _subpaths(segments: Iterable[Any], scale: float) -> Iterator[tuple[FloatArray, bool]]:
    """Yield the points (N, 2) of each subpath in its own units and whether it is closed."""
    from svgelements import Close, Move

    run: list[FloatArray] = []
    for segment in segments:
        if isinstance(segment, Move):
            if run:
                yield np.concatenate(run), False
            run = [_xy(segment.end)]
        elif isinstance(segment, Close):
            if run:
                yield np.concatenate(run), True
            run = [] if segment.end is None else [_xy(segment.end)]
        else:
            run.append(_flattened(segment, scale))
    if run:
        yield np.concatenate(run), False


def _xy(point: Any) -> FloatArray:
    return np.array([[point.x, point.y]], dtype=np.float64)


def _flattened(segment: Any, scale: float) -> FloatArray:
    """Points (N, 2) of a segment after its start, within FLAT_MM of it once scaled."""
    from svgelements import Arc, CubicBezier, QuadraticBezier

    if isinstance(segment, Arc):
        return _arc(segment, scale)
    if isinstance(segment, CubicBezier):
        return _bezier((segment.start, segment.control1, segment.control2, segment.end), scale)
    if isinstance(segment, QuadraticBezier):
        return _bezier((segment.start, segment.control, segment.end), scale)
    return _xy(segment.end)


def _arc(segment: Any, scale: float) -> FloatArray:
    centre, a, b = (_xy(p) for p in (segment.center, segment.prx, segment.pry))
    radius = _bounded(max(segment.rx, segment.ry) * scale)
    count = abs(segment.sweep) / (2 * np.arccos(1 - min(FLAT_MM / radius, 0.5)))
    start = segment.get_start_t()
    t = start + segment.sweep * _steps(count)
    points: FloatArray = centre + np.cos(t) * (a - centre) + np.sin(t) * (b - centre)
    points[-1:] = _xy(segment.end)
    return points


def _bezier(controls: tuple[Any, ...], scale: float) -> FloatArray:
    """Evaluate a quadratic or cubic curve at steps small enough for its second derivative."""
    p = np.concatenate([_xy(control) for control in controls])
    degree = len(p) - 1
    bend = float(np.abs(p[:-2] - 2 * p[1:-1] + p[2:]).max())
    bend_mm = np.sqrt(2) * _bounded(bend * scale)
    t = _steps(float(np.sqrt(degree * (degree - 1) / 8 * bend_mm / FLAT_MM)))
    levels = p[:, None]  # (degree + 1, 1, 2), by de Casteljau down to (1, N, 2)
    for _ in range(degree):
        levels = (1 - t) * levels[:-1] + t * levels[1:]
    return np.asarray(levels[0])


def _steps(count: float) -> FloatArray:
    """Parameters (N, 1) after 0, up to 1."""
    return np.linspace(0, 1, int(np.ceil(max(count, 1))) + 1)[1:, None]


def _bounded(size_mm: float) -> float:
    """Refuse what would take for ever to flatten."""
    if not size_mm <= 4 * MAX_COORDINATE_MM:
        raise UnreadableInput(f"coordinates beyond {MAX_COORDINATE_MM:g} mm; check units and scale")
    return max(float(size_mm), 1e-9)


def _without_page(pieces: list[tuple[Polyline, bool]], width: Any, height: Any) -> list[Polyline]:
    """Leave out rectangles that cover the page (px), unless there is nothing else."""
    if not (isinstance(width, float) and isinstance(height, float)):  # a share of who knows what
        return [chain for chain, _ in pieces]
    page = np.array([[0.0, -height], [width, 0.0]]) * MM_PER_PX
    drawn = [
        chain
        for chain, is_rect in pieces
        if not (is_rect and np.allclose(chain.box, page, rtol=0, atol=0.1))
    ]
    return drawn or [chain for chain, _ in pieces]
