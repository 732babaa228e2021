"""Splines of DXF drawings as points, over the stretch of their knots that is drawn."""

from __future__ import annotations

from typing import Any

import numpy as np

from profiletool.errors import UnreadableInput
from profiletool.records.units import FloatArray

_FIRST, _MOST = 4, 512  # pieces of the curve between two knots


def spline_points(tool: Any, distance: float, most: int) -> FloatArray:
    """Points (N, 3) of a B-spline within ``distance`` of it.

    A curve of degree p is drawn from knot p to the last knot but p: from end to end of its
    control points only where the knots are clamped, p + 1 alike at either end.

    Parameters
    ----------
    tool : ezdxf.math.BSpline
    distance : float
    most : int
        Points; where it takes more, as many are returned and one on top.

    Raises
    ------
    UnreadableInput
        Knots that fall, or nothing between them.
    """
    from scipy.interpolate import BSpline

    degree = tool.degree
    knots = np.array(tool.knots(), dtype=np.float64)
    controls = np.array([tuple(p) for p in tool.control_points], dtype=np.float64)
    weights = np.array(tool.weights() or np.ones(len(controls)), dtype=np.float64)
    good = np.isfinite(knots).all() and np.isfinite(weights).all() and (weights > 0.0).all()
    if not good or (np.diff(knots) < 0.0).any() or len(knots) != len(controls) + degree + 1:
        raise UnreadableInput("a spline with knots or weights that make no sense; export it again")
    curve = BSpline(knots, np.column_stack([controls * weights[:, None], weights]), degree)
    breaks = np.unique(knots[degree : len(controls) + 1])
    if len(breaks) < 2:
        raise UnreadableInput("a spline without length; export it again")

    def at(t: FloatArray) -> FloatArray:
        values = curve(t)
        return np.asarray(values[:, :3] / values[:, 3:])

    pieces = _FIRST
    while True:
        shares = np.arange(2 * pieces) / (2.0 * pieces)
        t = np.append((breaks[:-1, None] + np.diff(breaks)[:, None] * shares).ravel(), breaks[-1])
        points = at(t)
        chords = 0.5 * (points[:-2:2] + points[2::2])
        off = np.linalg.norm(points[1::2] - chords, axis=1).max()
        if off <= distance:
            return points[::2]
        if len(points) > 2 * most:
            return points[: most + 1]
        if pieces >= _MOST:
            return points
        pieces *= 2
