"""Profiles drawn in SVG."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator
from dataclasses import replace
from io import BytesIO
from typing import Any
from xml.etree import ElementTree

import numpy as np

from profiletool.errors import NoObject, UnreadableInput
from profiletool.profile.drawing import svg_tree
from profiletool.profile.drawing.chain import (
    FLAT_MM,
    MAX_COORDINATE_MM,
    MAX_POINTS,
    clean,
    join,
)
from profiletool.profile.drawing.drawn import FAR_TIMES, Drawn, placed
from profiletool.profile.drawing.svg_page import CSS_PX_PER_INCH, MM_PER_PX, size_page
from profiletool.profile.drawing.svg_seen import Piece, seen
from profiletool.profile.drawing.svg_style import name_of
from profiletool.profile.drawing.svg_text import parsed, safe_text
from profiletool.records.units import FloatArray

_LOST = ("mask", "clip path", "hidden layer")  # what is told of what is not drawn
# What svgelements throws on values that it does not understand.
_DAMAGE = (ValueError, TypeError, IndexError, KeyError, AttributeError, ArithmeticError)


def read_svg(data: bytes, layer: str | None = None) -> Drawn:
    """Read the chains of a drawing.

    Parameters
    ----------
    data : bytes
        SVG, packed or not. Lengths without a unit are CSS pixels of 25.4/96 mm; width, height and
        viewBox scale as SVG says. No reference out of the file is followed.
    layer : str or None
        Label or id of a group to read alone.

    Returns
    -------
    Drawn
        Joined end to end; what is not painted, masks and the page itself are left out, clips
        cut.

    Raises
    ------
    UnreadableInput
        Not well-formed, declarations, values that are no numbers, references in a circle, or too
        much of anything.
    NoObject
        The page has no size, or there is nothing but text and pictures.
    UsageError
        No such layer.
    """
    from svgelements import SVG

    text = safe_text(data)
    root = _root(text)
    unit, factor = size_page(root, text)
    try:
        plain = svg_tree.plain_tree(root, layer)
        drawing = SVG.parse(
            BytesIO(ElementTree.tostring(plain.root)),
            reify=False, ppi=CSS_PX_PER_INCH, on_error="raise",
        )  # fmt: skip
        if not drawing.width or not drawing.height:
            raise NoObject("the page has no width or no height; set both in mm")
        with np.errstate(all="ignore"):  # absurd numbers: the outcome is checked
            pieces, regions = _pieces(drawing, MM_PER_PX * factor)
    except _DAMAGE as error:
        reason = f" ({error})" if str(error) else ""
        raise UnreadableInput(f"values that SVG does not know{reason}; export again") from None
    if not pieces and any(plain.left.values()):
        raise NoObject(_only(plain.left))
    page = _page(drawing.width, drawing.height, MM_PER_PX * factor)
    near, moved = placed([piece.points for piece in pieces])
    whole = [replace(piece, points=p) for piece, p in zip(pieces, near, strict=True)]
    drawn, notes = seen(whole, None if moved else page, {} if moved else regions)
    chains = [clean(piece.points, piece.shut) for piece in drawn]
    lost = [
        f"left out of the drawing: {plain.left[what]} {what}" for what in _LOST if plain.left[what]
    ]
    return Drawn(join(chains), unit, (*notes, *moved, *lost))


def _root(text: str) -> ElementTree.Element:
    if text.count("<") > 2 * svg_tree.MAX_ELEMENTS:
        raise UnreadableInput(f"more than {svg_tree.MAX_ELEMENTS} elements; simplify the drawing")
    root = parsed(text)
    name = root.tag.rpartition("}")[2]
    if name != "svg":
        raise UnreadableInput(f"holds <{name[:20]}> instead of <svg>; export it again as SVG")
    if not name_of(root):
        raise UnreadableInput("holds no <svg> element; export it again as plain SVG")
    return root


def _only(left: Counter[str]) -> str:
    """Say what a drawing holds that has no lines."""
    if left["image"]:
        return "nothing drawable, only a picture: trace it, or give the picture itself"
    if left["text"]:
        return "nothing drawable, only text: turn it into paths"
    return "nothing drawable that is not hidden: show it, or choose a `layer`"


def _page(width: Any, height: Any, mm_per_px: float) -> FloatArray | None:
    if not (isinstance(width, float) and isinstance(height, float)):  # a share of who knows what
        return None
    return np.array([[0.0, -height], [width, 0.0]]) * mm_per_px


def _pieces(drawing: Any, mm_per_px: float) -> tuple[list[Piece], dict[str, list[Piece]]]:
    """Give the runs of all shapes, and by its number the regions of every clip."""
    from svgelements import Shape

    pieces: list[Piece] = []
    regions: defaultdict[str, list[Piece]] = defaultdict(list)
    left = MAX_POINTS
    for shape in drawing.elements():
        if not isinstance(shape, Shape):
            continue
        m, values = shape.transform, shape.values
        matrix = mm_per_px * np.array([[m.a, m.c], [m.b, m.d]]) * [[1], [-1]]
        offset = mm_per_px * np.array([m.e, -m.f])
        scale = float(np.linalg.norm(matrix, 2)) if np.all(np.isfinite(matrix)) else np.inf
        for points, closed in _subpaths(shape.segments(transformed=False), scale):
            left -= len(points)
            if left <= 0:
                raise UnreadableInput(f"more than {MAX_POINTS} points; simplify the drawing")
            if len(points) < 2:
                continue
            placed_mm = points @ matrix.T + offset
            if not (np.abs(placed_mm) <= FAR_TIMES * MAX_COORDINATE_MM).all():
                raise UnreadableInput(
                    f"coordinates beyond {MAX_COORDINATE_MM:g} mm or not finite; check its size"
                )
            piece = Piece(
                placed_mm, closed, str(values.get("inside")),
                str(values.get("line")), values.get("filled") == "stated",
                tuple(str(values.get("clips", "")).split()),
            )  # fmt: skip
            clipping = values.get("clipping")
            (regions[str(clipping)] if clipping else pieces).append(piece)
    return pieces, regions


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
