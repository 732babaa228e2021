"""Frames of drawings: sheets, borders and grounds that stand round an object and are not it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from profiletool.errors import NoObject
from profiletool.profile.drawing.chain import JOIN_MM, Polyline

_RECTANGULAR = 0.97  # of its bounding box that a rectangle fills, rounded corners and all
_FRAMED = 0.2  # of a rectangle's area: what is in it is the object
_DOUBTFUL = 0.08  # below, it is a hole in a plate
_SHEETS_MM = ((841, 1189), (594, 841), (420, 594), (297, 420), (210, 297), (148, 210), (105, 148),
              (216, 279), (216, 356), (279, 432), (432, 559), (559, 864))  # fmt: skip
_MARGIN_MM = 45.0  # of a sheet, both sides together
_ON_SHEET = 0.005  # of a sheet's area
_TOLD, _TOLD_IN_RECTANGLE = 0.25, 0.01  # of an outline's area: a shape in it that is told
_MOST = 5  # frames in frames


def without_frames(chains: list[Polyline]) -> tuple[list[Polyline], tuple[str, ...]]:
    """Leave out rectangles that stand round all else, and the lines that end on them.

    Raises
    ------
    NoObject
        A rectangle that may be the object as well.
    """
    notes: list[str] = []
    for _ in range(_MOST):
        frame = _frame(chains)
        if frame is None:
            break
        closed, text = frame
        chains = [c for c in chains if c is not closed and not _touches(c, closed)]
        notes.append(f"a rectangle round the profile, {text}, was taken for a frame and left out")
    return _without_open_frame(chains, notes)


def inner_shapes(outer: Polyline, chains: Sequence[Polyline]) -> Iterator[str]:
    """Say what large shapes lie in an outline; in a rectangle, which may be a frame, small ones."""
    if not outer.closed:
        return
    least = _TOLD_IN_RECTANGLE if is_rectangle(outer) else _TOLD
    inner = [c for c in chains if c.closed and least * area(outer) < area(c) < 0.999 * area(outer)]
    if inner:
        one = max(inner, key=area)
        yield (
            f"the outer outline, {box_text(outer)}, was taken; a shape of {_size(one)} lies in it"
        )


def area(chain: Polyline) -> float:
    """Area that a closed chain encloses, mm²."""
    x, y = (chain.points - chain.points[0]).T
    return 0.5 * abs(float(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1))))


def box_text(chain: Polyline) -> str:
    """Say how large a chain is and where."""
    low, high = chain.box
    x, y = 0.5 * (low + high)
    return f"{_size(chain)} at ({x:.1f}, {y:.1f})"


def _size(chain: Polyline) -> str:
    width, height = np.ptp(chain.box, axis=0)
    return f"{width:.1f} x {height:.1f} mm"


def _frame(chains: Sequence[Polyline]) -> tuple[Polyline, str] | None:
    """Give a frame round all else and its size; None where there is none."""
    outer = max((c for c in chains if c.closed), key=area, default=None)
    if outer is None or not is_rectangle(outer):
        return None
    low, high = outer.box + np.array([[-JOIN_MM], [JOIN_MM]])
    others = [c for c in chains if c is not outer]
    within = [c for c in others if c.closed and not _touches(c, outer)]
    if not within or not all((c.box[0] >= low).all() and (c.box[1] <= high).all() for c in others):
        return None
    inner = max(within, key=area)
    share = area(inner) / area(outer)
    if share >= _FRAMED or (share >= _ON_SHEET and _is_sheet(outer)):
        return outer, box_text(outer)
    if share >= _DOUBTFUL:
        raise NoObject(
            f"a rectangle of {_size(outer)} round a shape of {_size(inner)}: a frame or the "
            "object? Delete the other one, or choose a `layer`"
        )
    return None


def is_rectangle(chain: Polyline) -> bool:
    """Whether a closed chain all but fills its box, in whatever direction."""
    import shapely

    if len(chain.points) < 4 or area(chain) == 0.0:
        return False
    return area(chain) >= _RECTANGULAR * float(
        shapely.area(shapely.minimum_rotated_rectangle(shapely.MultiPoint(chain.points)))
    )


def _is_sheet(chain: Polyline) -> bool:
    short, long = sorted(np.ptp(chain.box, axis=0))
    return any(
        a - _MARGIN_MM <= short <= a + 1.0 and b - _MARGIN_MM <= long <= b + 1.0
        for a, b in _SHEETS_MM
    )


def _touches(chain: Polyline, frame: Polyline) -> bool:
    import shapely

    ring = shapely.LinearRing(frame.points)
    return bool(shapely.distance(shapely.MultiPoint(chain.points), ring) <= JOIN_MM)


def _without_open_frame(
    chains: list[Polyline], notes: list[str]
) -> tuple[list[Polyline], tuple[str, ...]]:
    """Leave out open lines, level and upright alone, that stand round the largest shape."""
    inner = max((c for c in chains if c.closed), key=area, default=None)
    if inner is None:
        return chains, tuple(notes)
    frames = [c for c in chains if not c.closed and _is_border(c, inner)]
    if frames:
        notes.append(f"lines round the profile, {box_text(frames[0])}, were left out as a frame")
    return [c for c in chains if all(c is not frame for frame in frames)], tuple(notes)


def _is_border(chain: Polyline, inner: Polyline) -> bool:
    steps = np.abs(np.diff(chain.points, axis=0))
    straight = bool((steps.min(axis=1) <= JOIN_MM).all())
    low, high = chain.box
    around = bool((inner.box[0] >= low).all() and (inner.box[1] <= high).all())
    return len(chain.points) > 2 and straight and around
