"""Shapes of an SVG that are seen: painted, not clipped away, and not the page itself."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from profiletool.errors import UnreadableInput
from profiletool.profile.drawing.chain import Polyline
from profiletool.profile.drawing.frames import is_rectangle
from profiletool.records.units import FloatArray

_ON_PAGE_MM = 0.1
_MAX_CLIPPED = 5_000  # points of a shape and its clip


@dataclass(frozen=True)
class Piece:
    """A run of a shape, mm, y up.

    Attributes
    ----------
    points : (N, 2)
    closed : bool
        By the path itself.
    fill, stroke : {"none", "white", "ink"}
    stated : bool
        Whether somebody said that it is filled: else SVG's habit, black.
    clips : tuple of str
        Numbers of the regions that it is seen in.
    """

    points: FloatArray
    closed: bool
    fill: str = "ink"
    stroke: str = "none"
    stated: bool = False
    clips: tuple[str, ...] = ()

    @property
    def shut(self) -> bool:
        """Whether it is an outline: SVG closes what it fills."""
        return self.closed or (self.stated and self.fill != "none")

    @property
    def chain(self) -> Polyline:
        """As a line."""
        return Polyline(self.points, self.shut)


def seen(
    pieces: Sequence[Piece], page: FloatArray | None, regions: Mapping[str, Sequence[Piece]]
) -> tuple[list[Piece], tuple[str, ...]]:
    """Leave out what is not painted, what is white on white, what is clipped, and the page.

    Parameters
    ----------
    pieces : sequence of Piece
        The lowest first.
    page : (2, 2) or None
        Lowest and highest x, y of the page.
    regions : mapping
        Number of a clip to its shapes.
    """
    notes = []
    painted = [p for p in pieces if "ink" in (p.fill, p.stroke) or "white" in (p.fill, p.stroke)]
    if pieces and not painted:
        notes.append("nothing of the drawing is painted: its lines were taken as they are")
        painted = list(pieces)
    clipped = [part for piece in painted for part in _clipped(piece, regions)]
    inked = _on_white(clipped)
    drawn = [p for p in inked if not _is_page(p, page)]
    if drawn and len(drawn) < len(inked):
        notes.append("a rectangle that covers the page was taken for the page and left out")
    return drawn or inked, tuple(notes)


def _on_white(pieces: list[Piece]) -> list[Piece]:
    """Leave out what is white and does not lie on anything darker, unless all is white."""
    kept: list[Piece] = []
    boxes: list[FloatArray] = []
    for piece in pieces:
        box = _box(piece)
        if "ink" in (piece.fill, piece.stroke):
            boxes.append(box)
        elif not any((box[0] >= b[0]).all() and (box[1] <= b[1]).all() for b in boxes):
            continue
        kept.append(piece)
    return kept if boxes else pieces


def _is_page(piece: Piece, page: FloatArray | None) -> bool:
    if page is None or not piece.shut or (piece.fill == "none" and piece.stroke == "none"):
        return False
    low, high = _box(piece) - page
    covers = bool((low <= _ON_PAGE_MM).all() and (high >= -_ON_PAGE_MM).all())
    return covers and len(piece.points) > 3 and is_rectangle(piece.chain)


def _box(piece: Piece) -> FloatArray:
    return np.array([piece.points.min(axis=0), piece.points.max(axis=0)])


def _clipped(piece: Piece, regions: Mapping[str, Sequence[Piece]]) -> Iterator[Piece]:
    """Yield what is seen of a piece through its clips."""
    import shapely

    shapes = [(piece.clips, piece)]
    for number in piece.clips:
        region = regions.get(number, ())
        count = sum(len(p.points) for p in region)
        bodies = [shapely.Polygon(p.points).buffer(0.0) for p in region if len(p.points) > 2]
        left = []
        for _, part in shapes:
            if count * len(part.points) > _MAX_CLIPPED**2:
                raise UnreadableInput("a clip path of far too many points; release it")
            left += _within(part, shapely.unary_union(bodies))
        shapes = [(piece.clips, part) for part in left]
    for _, part in shapes:
        yield part


def _within(piece: Piece, window: FloatArray) -> list[Piece]:
    import shapely

    if len(piece.points) < 2:
        return [piece]
    filled = piece.fill != "none" or piece.closed
    body = shapely.LineString(piece.points)
    if filled and len(piece.points) > 2:
        body = shapely.Polygon(piece.points).buffer(0.0)
    if shapely.covers(window, body):
        return [piece]
    parts = shapely.get_parts(shapely.intersection(window, body))
    made = []
    for part in parts:
        if isinstance(part, shapely.Polygon):
            ring = shapely.get_coordinates(part.exterior)[:-1]
            made.append(replace(piece, points=ring, closed=True))
        elif isinstance(part, shapely.LineString) and not filled:
            made.append(replace(piece, points=shapely.get_coordinates(part), closed=False))
    return made
