"""Profiles drawn in SVG."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from io import BytesIO
from typing import Any
from xml.etree import ElementTree

import numpy as np

from profiletool.errors import NoObject, UnreadableInput
from profiletool.profile.vector_chain import (
    FLAT_MM,
    MAX_COORDINATE_MM,
    MAX_POINTS,
    Chain,
    clean,
    join,
)
from profiletool.records import MM_PER_INCH, FloatArray

CSS_PX_PER_INCH = 96.0
_MM_PER_PX = MM_PER_INCH / CSS_PX_PER_INCH
_PX_PER = {"": 1.0, "px": 1.0, "in": 96.0, "pt": 96 / 72, "pc": 16.0}
_PX_PER |= {"mm": 1 / _MM_PER_PX, "cm": 10 / _MM_PER_PX, "Q": 0.25 / _MM_PER_PX}
MAX_ELEMENTS = 10_000
MAX_NUMBERS = 60_000  # in all paths together
MAX_DEPTH = 100
MAX_ATTRIBUTE = 1_000  # characters; longer ones make svgelements crawl
MAX_STYLE = 20_000

_SHAPES = ("path", "line", "polyline", "polygon", "rect", "circle", "ellipse")
# Their shapes are not drawn where they stand, or not at all.
_NOT_DRAWN = ("marker", "mask", "symbol", "filter", "metadata", "foreignObject", "image", "text")
_DECLARATION = re.compile(rb"<!(?:DOCTYPE|ENTITY)", re.IGNORECASE)
_NUMBER = r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?"
_NUMBERS = re.compile(_NUMBER)
_LENGTH = re.compile(rf"\s*({_NUMBER})\s*(px|mm|cm|in|pt|pc|Q|%|)\s*")
_LENGTHS = ("x", "y", "x1", "y1", "x2", "y2", "cx", "cy", "r", "rx", "ry", "width", "height")
_LONG = ("d", "points", "href")
# Nothing but numbers and what stands between them; possessive, so that it never looks back.
_ALLOWED = {"d": re.compile(rf"(?:[MmZzLlHhVvCcSsQqTtAa,\s]|{_NUMBER})*+")}
_ALLOWED["points"] = re.compile(rf"(?:[,\s]|{_NUMBER})*+")

# What svgelements throws on values that it does not understand.
_DAMAGE = (ValueError, TypeError, IndexError, KeyError, AttributeError, ArithmeticError)


def read_svg(data: bytes) -> list[Chain]:
    """Read the chains of a drawing.

    Parameters
    ----------
    data : bytes
        SVG in UTF-8. Lengths without a unit are CSS pixels of 25.4/96 mm; width, height and
        viewBox scale as SVG says. No reference out of the file is followed.

    Returns
    -------
    list of Chain
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

    root = _safe_tree(data)
    _prepare(root)
    try:
        drawing = SVG.parse(
            BytesIO(ElementTree.tostring(root)), reify=False, ppi=CSS_PX_PER_INCH, on_error="raise"
        )
        if not isinstance(drawing, SVG):
            raise UnreadableInput("holds no <svg> element; export it again as plain SVG")
        if not drawing.width or not drawing.height:
            raise NoObject("the page has no width or no height; set both in mm")
        pieces = list(_pieces(drawing))
    except _DAMAGE as error:
        raise UnreadableInput(f"values that SVG does not know ({error}); export again") from None
    return join(_without_page(pieces, drawing.width, drawing.height))


def _safe_tree(data: bytes) -> ElementTree.Element:
    """Parse the XML: no declarations, one encoding, bounded size."""
    if _DECLARATION.search(data):
        raise UnreadableInput("holds a DOCTYPE or ENTITY declaration; delete it and save again")
    if data.count(b"<") > 2 * MAX_ELEMENTS:
        raise UnreadableInput(f"more than {MAX_ELEMENTS} elements; simplify the drawing")
    try:
        # In UTF-16 and the like a declaration could hide from the search above.
        text = data.decode("utf-8-sig")
        if "\0" in text:
            raise ValueError("holds null characters")
        return ElementTree.fromstring(text)
    except (ElementTree.ParseError, ValueError) as error:
        raise UnreadableInput(f"not well-formed XML in UTF-8 ({error}); export again") from None


def _name(element: ElementTree.Element) -> str:
    return element.tag.rpartition("}")[2]


def _prepare(root: ElementTree.Element) -> None:
    """Check the tree, prune what is not drawn and complete the page's size."""
    if _name(root) != "svg":
        raise UnreadableInput(
            f"holds <{_name(root)[:20]}> instead of <svg>; export it again as SVG"
        )
    by_id = {e.get("id", ""): e for e in root.iter()}
    _check_expansion(root, by_id)
    numbers = 0
    for element in list(root.iter()):
        for child in list(element):
            if _name(child) in _NOT_DRAWN:
                element.remove(child)
        _check_text(element)
        if _name(element) in _SHAPES:
            numbers += _check_values(element)
    if numbers > MAX_NUMBERS:
        raise UnreadableInput(f"more than {MAX_NUMBERS} numbers in its paths; simplify the drawing")
    _complete_size(root)


def _check_expansion(root: ElementTree.Element, by_id: dict[str, ElementTree.Element]) -> None:
    """Refuse <use> that multiplies without bound or refers to itself, and endless nesting."""
    sizes: dict[ElementTree.Element, int] = {}

    def size(element: ElementTree.Element, depth: int) -> int:
        if depth > MAX_DEPTH:
            raise UnreadableInput("nested too deeply, or <use> in a circle; flatten the drawing")
        if element not in sizes:
            total = 1 + sum(size(child, depth + 1) for child in element)
            if _name(element) == "use":
                target = by_id.get(_href(element)[1:])
                total += 0 if target is None else size(target, depth + 1)
            sizes[element] = total
        return sizes[element]

    if size(root, 0) > MAX_ELEMENTS:
        raise UnreadableInput(
            f"more than {MAX_ELEMENTS} elements, with what <use> makes; simplify the drawing"
        )


def _href(element: ElementTree.Element) -> str:
    link = element.get("{http://www.w3.org/1999/xlink}href", "")
    return element.get("href", link)


def _check_text(element: ElementTree.Element) -> None:
    for key, text in element.attrib.items():
        if len(text) > MAX_ATTRIBUTE and key not in _LONG and "}" not in key:
            raise UnreadableInput(f"an endless {key[:20]!r}; export it again as plain SVG")
    if _name(element) == "style" and len(element.text or "") > MAX_STYLE:
        raise UnreadableInput("an endless <style>; export it again as plain SVG")


def _check_values(element: ElementTree.Element) -> int:
    """Return how many numbers a shape's path holds."""
    count = 0
    for key, allowed in _ALLOWED.items():
        text = element.get(key, "")
        if not allowed.fullmatch(text):
            raise UnreadableInput(f"<{_name(element)}> has a bad {key!r}; export the drawing again")
        count += len(_NUMBERS.findall(text))
    for key in _LENGTHS:
        text = element.get(key, "0")
        if not _LENGTH.fullmatch(text) and text != "auto":
            raise UnreadableInput(
                f"<{_name(element)}> has the length {text[:20]!a}; use numbers, mm or px"
            )
    return count


def _complete_size(root: ElementTree.Element) -> None:
    """Bring width and height to px; where one is missing, the viewBox's proportions give it."""
    box = [float(n) for n in _NUMBERS.findall(root.get("viewBox", ""))]
    for key in ("width", "height"):
        given = _LENGTH.fullmatch(root.get(key, ""))
        if given is None:
            root.attrib.pop(key, None)  # "auto" and the like
        elif given[2] != "%":
            root.set(key, repr(float(given[1]) * _PX_PER[given[2]]))
    if len(box) != 4 or min(box[2:]) <= 0:
        return
    for have, lack, ratio in (
        ("width", "height", box[3] / box[2]),
        ("height", "width", box[2] / box[3]),
    ):
        given = _LENGTH.fullmatch(root.get(have, ""))
        if given and given[2] != "%" and root.get(lack) is None:
            root.set(lack, repr(float(given[1]) * ratio))


def _pieces(drawing: Any) -> Iterator[tuple[Chain, bool]]:
    """Yield the chains and whether each was drawn as a rectangle."""
    from svgelements import Rect, Shape

    left = MAX_POINTS
    for shape in drawing.elements():
        if not isinstance(shape, Shape) or shape.values.get("visibility") in ("hidden", "collapse"):
            continue
        m = shape.transform
        matrix = _MM_PER_PX * np.array([[m.a, m.c], [m.b, m.d]]) * [[1], [-1]]
        offset = _MM_PER_PX * np.array([m.e, -m.f])
        scale = float(np.linalg.norm(matrix, 2)) if np.all(np.isfinite(matrix)) else np.inf
        for points, closed in _subpaths(shape.segments(transformed=False), scale):
            left -= len(points)
            if left <= 0:
                raise UnreadableInput(f"more than {MAX_POINTS} points; simplify the drawing")
            if len(points) > 1:
                with np.errstate(invalid="ignore", over="ignore"):  # clean refuses the outcome
                    placed = points @ matrix.T + offset
                yield clean(placed, closed), isinstance(shape, Rect)


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


def _without_page(pieces: list[tuple[Chain, bool]], width: float, height: float) -> list[Chain]:
    """Leave out rectangles that cover the page (px), unless there is nothing else."""
    page = np.array([[0.0, -height], [width, 0.0]]) * _MM_PER_PX
    drawn = [
        chain
        for chain, is_rect in pieces
        if not (is_rect and np.allclose(chain.box, page, rtol=0, atol=0.1))
    ]
    return drawn or [chain for chain, _ in pieces]
