"""Scatter of digitised outlines: measured, and smoothed out before it is taken for grooves."""

from __future__ import annotations

import numpy as np

from profiletool.profile.curve import arc_length, local_fits, points_at, smoothing_width
from profiletool.profile.drawing.chain import Polyline
from profiletool.records.units import FloatArray

_LEAST_POINTS = 60
_REACH = 8  # points in half a window
_ALTERNATING = 0.45  # of neighbours that turn to and fro; a smooth line has none, scatter 0.7
_LEAST_WIDTH, _MOST_WIDTH = 0.01, 0.05  # of the outline's diagonal: windows that matter
_SECOND_NORM = np.sqrt(1.5)  # of independent scatter in a point's distance to its chord
_PER_MEDIAN = 1.4826  # standard deviation of a normal distribution by its median


def without_scatter(chain: Polyline) -> tuple[Polyline, tuple[str, ...]]:
    """Smooth a chain whose points scatter to and fro, as digitised pixels and probes do.

    Cubics are fitted over the window in which scatter leaves the direction right to half a
    degree. Corners and grooves of clean drawings do not alternate and stay as they are.
    """
    noise = scatter_of(chain)
    points = chain.points
    length, diagonal = chain.length, float(np.hypot(*np.ptp(points, axis=0)))
    half = min(smoothing_width(noise, length / len(points)), _MOST_WIDTH * diagonal)
    if not half > _LEAST_WIDTH * diagonal:
        return chain, ()
    note = f"the points scatter by {noise:.2g} mm: they were smoothed over {2.0 * half:.1f} mm"
    return Polyline(_smoothed(points, chain.closed, half), chain.closed), (note,)


def scatter_of(chain: Polyline) -> float:
    """Give the points' standard deviation across the line, mm; 0 where it is clean."""
    points = chain.points
    if len(points) < _LEAST_POINTS:
        return 0.0
    before, after = points[:-2], points[2:]
    if chain.closed:
        before, after = np.roll(points, 1, axis=0), np.roll(points, -1, axis=0)
    middle = points if chain.closed else points[1:-1]
    along = after - before
    reach = np.hypot(*along.T)
    across = along[:, 0] * (middle - before)[:, 1] - along[:, 1] * (middle - before)[:, 0]
    off = np.divide(across, reach, out=np.zeros(len(reach)), where=reach > 0.0)
    turning = np.sign(off[np.abs(off) > 1e-3 * float(np.median(reach))])
    if len(turning) < 0.3 * len(off):
        return 0.0
    if float(np.mean(turning[1:] != turning[:-1])) < _ALTERNATING:
        return 0.0
    return _PER_MEDIAN * float(np.median(np.abs(off[off != 0.0]))) / float(_SECOND_NORM)


def _smoothed(points: FloatArray, closed: bool, half: float) -> FloatArray:
    """Fit cubics over +-``half`` around points spaced evenly along the line."""
    line = np.vstack([points, points[:1]]) if closed else points
    s = arc_length(line)
    count = max(round(float(s[-1]) / (half / _REACH)), 32)
    at = np.linspace(0.0, s[-1], count, endpoint=not closed)
    even = points_at(at, s, line)
    if closed:
        even = np.concatenate([even[-_REACH:], even, even[:_REACH]])
    smooth, _ = local_fits(even, float(s[-1]) / count, _REACH)
    return smooth[_REACH:-_REACH] if closed else np.vstack([even[:1], smooth[1:-1], even[-1:]])
