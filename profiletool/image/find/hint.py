"""Hints of the user: a box, a point or a mask of the object."""

from __future__ import annotations

from dataclasses import dataclass

from profiletool.errors import UsageError
from profiletool.image.find.ground import BoolImage
from profiletool.records.request import Box, Point

LEAST_PX = 16


@dataclass(frozen=True)
class Hint:
    """Where the object is; what is given holds for certain.

    Attributes
    ----------
    box : (x, y, w, h), or None
        Pixels; everything outside is ground.
    point : (x, y), or None
        Pixels; the object is the region that holds it.
    mask : (H, W) bool, or None
        The object itself, of the picture's size.
    candidate : int, or None
        Which of the candidates that a doubtful picture shows, from 1.
    """

    box: Box | None = None
    point: Point | None = None
    mask: BoolImage | None = None
    candidate: int | None = None


def check_hint(hint: Hint, shape: tuple[int, int]) -> None:
    """Refuse a hint that lies outside a picture of (H, W) or holds nothing.

    Raises
    ------
    UsageError
    """
    height, width = shape
    if hint.box is not None:
        x, y, w, h = hint.box
        inside = min(x, y) >= 0 and x + w <= width and y + h <= height
        if not inside or min(w, h) < LEAST_PX:
            raise UsageError(
                f"`box` {x:g},{y:g},{w:g},{h:g} does not fit; give X,Y,W,H in pixels, at least "
                f"{LEAST_PX} wide and high and inside the {width} x {height} of the picture"
            )
    if hint.point is not None:
        x, y = hint.point
        if not (0 <= x < width and 0 <= y < height):
            raise UsageError(
                f"`point` {x:g},{y:g} is outside the picture; give X,Y in pixels, below "
                f"{width},{height}"
            )
        if hint.box is not None and not _in_box(hint.point, hint.box):
            raise UsageError("`point` lies outside `box`; give a point inside it, or one of them")
    if hint.mask is not None:
        if hint.mask.shape != shape:
            raise UsageError(
                f"the mask is {hint.mask.shape[1]} x {hint.mask.shape[0]} pixels and the picture "
                f"{width} x {height}; save the mask at the picture's size"
            )
        if not hint.mask.any():
            raise UsageError("the mask is empty; paint the object white on black")


def _in_box(point: Point, box: Box) -> bool:
    (x, y), (left, top, w, h) = point, box
    return left <= x < left + w and top <= y < top + h
