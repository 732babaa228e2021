"""The target profile that a tube follows."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from profiletool.records.side import Side, side_sign
from profiletool.records.units import FloatArray


@dataclass(frozen=True)
class Profile:
    """The target of the object-facing line: the stretch that the tube can follow.

    Attributes
    ----------
    points : (N, 2) mm, object frame, from the top down, 0.1 mm apart but for smoothing
    s : (N,) mm
        Arc length from the first point.
    heading : (N,) rad
        Direction of travel, counter-clockwise from +x, unwrapped.
    curvature : (N,) 1/mm
        Positive where the object is convex.
    bridged : (N,) bool
        Where the tube spans a groove of the object instead of touching it.
    side : "left" or "right"
    outline : (M, 2) mm, or None
        The closed outline of the object; None for an open drawn profile.
    """

    points: FloatArray
    s: FloatArray
    heading: FloatArray
    curvature: FloatArray
    bridged: NDArray[np.bool_]
    side: Side
    outline: FloatArray | None

    @property
    def length_mm(self) -> float:
        """Arc length of the whole profile."""
        return float(self.s[-1])

    @property
    def sign(self) -> float:
        """+1 where a convex turn is counter-clockwise (left side), else -1."""
        return side_sign(self.side)


@dataclass(frozen=True)
class DrawnUnit:
    """The unit of a drawing's numbers.

    Attributes
    ----------
    mm : float
        Length of one.
    source : str
        Clause that says where it is from; "" for mm that nobody doubts.
    sized : bool
        Whether the drawing has a size at all; else ``mm`` is but a number to draw with.
    assumed : bool
        Whether it is taken by habit, and to be told.
    """

    mm: float = 1.0
    source: str = ""
    sized: bool = True
    assumed: bool = False


@dataclass(frozen=True)
class DrawnLine:
    """A drawn profile.

    Attributes
    ----------
    points : (N, 2) mm by its unit, x to the right, y up
        In the drawing's own place and order of travel, no two successive ones alike, 3 at least.
    closed : bool
        The last point joins the first, which is not repeated.
    unit : DrawnUnit
    notes : tuple of str
        What the user should know of how the drawing was read.
    """

    points: FloatArray
    closed: bool
    unit: DrawnUnit = DrawnUnit()
    notes: tuple[str, ...] = ()
