"""Costs of one joint between two lines: the edges of the choice of joints.

Glossary
--------
E, K, Z : number of edges, of cuts, of points near a vertex
vertex : where the two lines of an edge meet
cost : integral over the profile of the squared distance, and of what lies too deep, mm³
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from profiletool.joints.expected import BUILT_WEIGHT
from profiletool.joints.misfit import LENGTH_COST_MM2, Deviation, Objective
from profiletool.joints.optimal.bends import STEP_MM, Bends
from profiletool.joints.optimal.lines import CandidateLines
from profiletool.records.units import Float32, FloatArray, IntArray

_BACK_MM = 30.0  # a first vertex may lie so far behind the profile's start


@dataclass(frozen=True)
class Edges:
    """Pairs of lines with one joint between them, all of one sense.

    Attributes
    ----------
    start, end : (E,)
        Indices of the lines.
    turn : (E,) rad
        Magnitude.
    before, after : (E,) mm
        From the first line's place to the vertex, and from there to the second line's place.
    lever2 : (E,) mm³ per rad²
        See `CandidateLines`.
    straight : (E,)
        Cost of the points that are not near the vertex.
    near : (E, Z) mm
        Off the line on their side of the vertex, away from the object, the points near it.
    at : (E, Z) mm
        Where they lie along it, from the vertex, positive beyond it.
    weight : (E, Z) mm
        0 for points that another edge counts.
    """

    sense: float
    start: IntArray
    end: IntArray
    turn: FloatArray
    before: FloatArray
    after: FloatArray
    lever2: FloatArray
    straight: FloatArray
    near: Float32
    at: Float32
    weight: Float32


@dataclass(frozen=True)
class Priced:
    """The cheapest joint of each edge at one pressure.

    Attributes
    ----------
    cost : (E,) mm³
        Infinite where no joint fits.
    errors : (E,) mm³
        The part of the cost that errors of a build make.
    cut : (E,)
        Index of its openF.
    """

    cost: FloatArray
    errors: FloatArray
    cut: NDArray[np.intp]


@dataclass(frozen=True)
class _Pairs:
    """Pairs of lines, and the points of the profile about the vertex between them; (E,) each.

    ``start``, ``end``, ``before`` and ``after`` are those of `Edges`. The vertex lies before the
    point ``split``; points from ``low`` to before ``high`` are near it and count.
    """

    start: IntArray
    end: IntArray
    before: FloatArray
    after: FloatArray
    split: IntArray
    low: IntArray
    high: IntArray


def summed_cost(lines: CandidateLines, objective: Objective) -> FloatArray:
    """Cost of every line at all points before each: (N, M + 1) mm³, the first column 0.

    In single precision, as the edges' costs are; the sums in double.
    """
    cost = objective.density(Deviation(-lines.out.astype(np.float32))) * lines.weight
    total = np.zeros((cost.shape[0], cost.shape[1] + 1))
    np.cumsum(cost, axis=1, out=total[:, 1:])
    return total


def edges_of(
    lines: CandidateLines,
    sense: float,
    bends: Sequence[Bends],
    wrap_mm: float,
    objective: Objective,
    most_cost: float,
) -> Edges:
    """Find all pairs of lines that a joint may join at some pressure.

    Parameters
    ----------
    lines : CandidateLines
    sense : float
        +1 for joints that bend toward the object.
    bends : sequence of Bends
        Of this sense, at all pressures.
    wrap_mm : float
        Least wrapped length between two windows: half of it on either side of a place.
    objective : Objective
    most_cost : float, mm³
        Edges that alone cost more are left out.
    """
    summed = summed_cost(lines, objective)
    start, end, turn = _turning(lines, sense, bends)
    before, after = _vertex(lines, start, end, sense * turn)
    least = np.where(start < lines.base, -_BACK_MM, 0.5 * wrap_mm)
    kept = np.flatnonzero((before > least) & (after > 0.5 * wrap_mm))
    start, end = start[kept], end[kept]
    turn, before, after = turn[kept], before[kept], after[kept]
    # The vertex in points of the profile: where it divides the way between both places.
    first, last = lines.place[start] + 1, lines.place[end]
    share = np.clip(before / (before + after), 0.0, 1.0)
    split = first + np.rint(share * (last - first)).astype(int)
    step = float(lines.weight[1])
    wide = int(np.ceil(max((b.before for b in bends), default=0.0) / step))
    low, high = np.maximum(split - wide, first), np.minimum(split + wide, last + 1)
    straight = summed[start, low] - summed[start, first] + summed[end, last + 1] - summed[end, high]
    kept = np.flatnonzero(straight <= most_cost)
    kept = kept[np.argsort(end[kept], kind="stable")]
    start, end, before, after = start[kept], end[kept], before[kept], after[kept]
    pairs = _Pairs(start, end, before, after, split[kept], low[kept], high[kept])
    near, at, weight = _near(lines, pairs, wide)
    lever2 = lines.lever2[np.minimum(pairs.split, len(lines.lever2) - 1)]
    turn, straight = turn[kept], straight[kept]
    return Edges(sense, start, end, turn, before, after, lever2, straight, near, at, weight)


def _turning(
    lines: CandidateLines, sense: float, bends: Sequence[Bends]
) -> tuple[IntArray, IntArray, FloatArray]:
    """Pairs of lines, one behind the other, whose headings differ by what a joint gives."""
    least = min((float(b.least.min()) for b in bends), default=np.inf)
    most = max((float(b.most.max()) for b in bends), default=-np.inf)
    turn = sense * (lines.turn[None, :] - lines.turn[:, None])
    ahead = lines.place[None, :] > lines.place[:, None]
    start, end = np.nonzero(ahead & (turn >= least) & (turn <= most))
    return start, end, turn[start, end]


def _vertex(
    lines: CandidateLines, start: IntArray, end: IntArray, turn: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Distance to the vertex from the place of the first line, and from it to the second's."""
    # The foot, on the second line, of the profile's point there, as the first line sees it.
    place = lines.place[end]
    off = lines.out[end, place]
    x = lines.along[start, place] - off * np.sin(turn)
    y = lines.out[start, place] - off * np.cos(turn)
    back = -y / np.sin(turn)
    return x - back * np.cos(turn), back - lines.along[end, place]


def _near(lines: CandidateLines, pairs: _Pairs, wide: int) -> tuple[Float32, Float32, Float32]:
    """Points near the vertices, each as the line on its side of the vertex sees it."""
    point = pairs.split[:, None] + np.arange(-wide, wide)
    counted = (point >= pairs.low[:, None]) & (point < pairs.high[:, None])
    point = np.clip(point, 0, len(lines.weight) - 1)
    out, along = lines.out.astype(np.float32), lines.along.astype(np.float32)
    side = [np.s_[:, :wide], np.s_[:, wide:]]
    near, at = np.empty(point.shape, np.float32), np.empty(point.shape, np.float32)
    for line, here in ((pairs.start, side[0]), (pairs.end, side[1])):
        near[here] = out[line[:, None], point[here]]
        at[here] = along[line[:, None], point[here]]
    at[side[0]] -= pairs.before[:, None].astype(np.float32)
    at[side[1]] = -(at[side[1]] + pairs.after[:, None].astype(np.float32))
    weight = np.where(counted, lines.weight[point], 0.0).astype(np.float32)
    return near, at, weight


def price(
    edges: Edges,
    lines: CandidateLines,
    bends: Bends,
    openF: FloatArray,
    wrap_mm: float,
    objective: Objective,
) -> Priced:
    """Find the cheapest joint of every edge at one pressure.

    Parameters
    ----------
    edges : Edges
    lines : CandidateLines
        Those of the edges.
    bends : Bends
        Of the edges' sense, at the pressure.
    openF : (K,) array, mm
        The cuts of ``bends``.
    wrap_mm : float
        Least wrapped length between two windows.
    objective : Objective
    """
    cost, errors = np.full(len(edges.turn), np.inf), np.zeros(len(edges.turn))
    cut = np.zeros(len(edges.turn), dtype=np.intp)
    sense = np.float32(edges.sense)
    room = np.where(edges.start < lines.base, -np.inf, 0.5 * wrap_mm)
    angles, places = bends.reach.shape[1], bends.bulge.shape[2]
    for k, length in enumerate(openF):
        span = bends.most[k] - bends.least[k]
        if span <= 0.0:
            continue
        where = (edges.turn - bends.least[k]) * ((angles - 1) / span)
        fits = np.flatnonzero((where >= 0.0) & (where <= angles - 1.0))
        reach = np.interp(where[fits], np.arange(angles), bends.reach[k])
        free = (edges.before[fits] - reach >= room[fits]) & (
            edges.after[fits] - reach >= 0.5 * wrap_mm
        )
        fits, reach = fits[free], reach[free]
        # Between two tabulated angles the bulge is as the angle.
        angle = np.rint(where[fits]).astype(np.int32)
        share = edges.turn[fits] / (bends.least[k] + angle * (span / (angles - 1)))
        at = np.rint((edges.at[fits] + np.float32(bends.before)) * np.float32(1.0 / STEP_MM))
        index = np.clip(at, 0, places - 1).astype(np.int32) + angle[:, None] * places
        bulge = bends.bulge[k].ravel().take(index) * share[:, None].astype(np.float32)
        # What lies off the line away from the object is at a negative distance of the tube.
        slope = (-bends.slope[k]).ravel().take(index)
        at_points = Deviation((edges.near[fits] + sense * bulge) * slope)
        near = np.einsum("ez,ez->e", objective.density(at_points), edges.weight[fits])
        tube = edges.before[fits] + edges.after[fits] - 2.0 * reach + length
        off = BUILT_WEIGHT * edges.lever2[fits] * bends.variance[k, angle]
        total = edges.straight[fits] + near + LENGTH_COST_MM2 * tube + off
        better = total < cost[fits]
        cost[fits[better]], errors[fits[better]] = total[better], off[better]
        cut[fits[better]] = k
    return Priced(cost, errors, cut)
