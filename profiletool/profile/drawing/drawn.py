"""Lines of a drawing as its reader hands them on, near to the origin."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from profiletool.profile.drawing.chain import MAX_COORDINATE_MM, Polyline
from profiletool.records.profile import DrawnUnit
from profiletool.records.units import FloatArray

FAR_TIMES = 1e4  # a place so many times as far off as MAX_COORDINATE_MM loses digits


@dataclass(frozen=True)
class Drawn:
    """The lines of a drawing in mm by its unit, y up, and what its user should know."""

    chains: list[Polyline]
    unit: DrawnUnit
    notes: tuple[str, ...] = ()


def placed(pieces: Sequence[FloatArray]) -> tuple[list[FloatArray], tuple[str, ...]]:
    """Bring what lies far from its origin near to it, all pieces (N, 2) together.

    What is absurdly large, or not finite, stays where it is: `clean` refuses it.
    """
    pieces = list(pieces)
    if not pieces:
        return pieces, ()
    points = np.concatenate(pieces)
    far = np.abs(points).max()
    if far <= MAX_COORDINATE_MM or not far <= FAR_TIMES * MAX_COORDINATE_MM:
        return pieces, ()
    low, high = points.min(axis=0), points.max(axis=0)
    if (high - low).max() > MAX_COORDINATE_MM:
        return pieces, ()
    middle = np.rint(0.5 * (low + high))
    note = (
        f"the drawing lies {np.hypot(*middle) / 1000.0:.0f} m from its origin: it was moved by "
        f"({-middle[0]:.0f}, {-middle[1]:.0f}) mm"
    )
    return [piece - middle for piece in pieces], (note,)
