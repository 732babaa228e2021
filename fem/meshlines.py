"""Mesh lines: where rings cut the tube along its axis, and columns of bricks around it."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from fem.actuator import Actuator
from fem.arrays import FloatArray, IntArray
from fem.meshsize import MeshSize, start_angle

_GIVE = 0.1  # how much sizes may be stretched to fill a length
_SHRINK = 0.7  # of a layer's height: the most that a changed length takes off
_HALF = np.pi


def stations(actuator: Actuator, size: MeshSize) -> tuple[FloatArray, IntArray]:
    """Places of the rings (layers + 1,), mm, and the segment of each layer (layers,)."""
    k = actuator.diameter / 20.0
    z, segment = [0.0], list[int]()
    edges = [edge for sector in actuator.wrapped for edge in sector]
    for number, (start, end) in enumerate(pairwise(edges)):
        length = end - start
        if length < 1e-9 * actuator.length:
            continue  # a window right at the clamped end or at the plug
        first = size.end if number == 0 else size.edge
        last = size.end if number == len(edges) - 2 else size.edge
        most = size.window if number % 2 else size.wrapped
        heights = _graded(length, first * k, last * k, most * k, size.growth)
        places = start + np.cumsum(heights)
        places[-1] = end
        z.extend(places.tolist())
        segment.extend([number] * len(heights))
    return np.array(z), np.array(segment)


def stretched(z: FloatArray, segment: IntArray, actuator: Actuator) -> FloatArray:
    """Places of a mesh's rings (layers + 1,), stretched for a changed actuator, mm.

    High layers give way and low ones keep their heights, as long as that leaves something of
    them: next to a cut's edge the tube is deformed as it was, however long its sectors are.

    Parameters
    ----------
    z, segment : (layers + 1,), (layers,)
        Of the mesh; see `fem.mesh.Mesh`.
    actuator : Actuator
        With as many windows.
    """
    edges = [edge for sector in actuator.wrapped for edge in sector]
    heights, moved = np.diff(z), np.zeros_like(z)
    for k, (start, end) in enumerate(pairwise(edges)):
        own = np.flatnonzero(segment == k)
        if own.size:
            h = heights[own]
            share = h * ((end - start) - h.sum()) / float(h @ h)
            if share.min() < -_SHRINK:
                share = np.full(len(h), (end - start) / h.sum() - 1.0)
            moved[own[0] + 1 : own[-1] + 2] = start + np.cumsum(h * (1.0 + share))
    return moved


def make_columns(actuator: Actuator, size: MeshSize, half: bool) -> FloatArray:
    """Cut the circumference into bricks that end where the uncut sectors do.

    Across such an edge the strain has a kink, and at the corners of the cut it is singular:
    bricks that end there and are narrow beside it are worth twice their number elsewhere. Edges
    nearer to each other than such a brick, or to the plane of symmetry, share a cut.

    Returns
    -------
    (around + 1,) rad, from the side that faces the object
    """
    whole = _HALF if half else 2.0 * _HALF
    widest = _HALF / size.around
    if size.beside == 0.0:
        return start_angle() + np.linspace(0.0, whole, round(whole / widest) + 1)
    edges = []
    for window in actuator.windows:
        reach = 0.5 * (window.alpha + actuator.gauze.allowance)
        for edge in (window.center - reach, window.center + reach):
            turn = (edge - start_angle()) % (2.0 * _HALF)
            edges.append(min(turn, 2.0 * _HALF - turn) if half else turn)
    cuts = _merged(sorted(edges), size.beside, whole)
    ends = [0.0, *cuts, whole]
    heights = [
        _graded(
            b - a,
            size.beside if k > 0 else widest,
            size.beside if k < len(cuts) else widest,
            widest,
            growth=2.0,
        )
        for k, (a, b) in enumerate(pairwise(ends))
    ]
    columns = np.concatenate([[0.0], np.cumsum(np.concatenate(heights))])
    columns[-1] = whole
    return start_angle() + columns


def _merged(edges: list[float], apart: float, whole: float) -> list[float]:
    """Give one place for all edges that lie within ``apart``, none that near to the ends."""
    groups: list[list[float]] = []
    for edge in edges:
        if groups and edge - groups[-1][0] <= apart:
            groups[-1].append(edge)
        else:
            groups.append([edge])
    middles = [sum(group) / len(group) for group in groups]
    return [m for m in middles if 0.5 * apart < m < whole - 0.5 * apart]


def _graded(length: float, first: float, last: float, most: float, growth: float) -> FloatArray:
    """Sizes that grow from both ends, shrunk or a little stretched to fill the length."""
    before, behind = list[float](), list[float]()
    a, b, total = min(first, most), min(last, most), 0.0
    while total * (1.0 + _GIVE) < length * (1.0 - 1e-9):
        if a <= b:
            before.append(a)
            total += a
            a = min(growth * a, most)
        else:
            behind.append(b)
            total += b
            b = min(growth * b, most)
    return np.array(before + behind[::-1]) * (length / total)
