"""Pieces of a drawing to the one line that is the profile.

A chain is a run of points without branches; drawings in DXF and SVG hold many of them, often one
per line or arc.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from profiletool.errors import NoObject, UnreadableInput
from profiletool.records import FloatArray

FLAT_MM = 0.01  # curves become polylines that stay this near
JOIN_MM = 0.05  # ends this near to each other meet
SAME_MM = 1e-6  # points this near are one
MAX_COORDINATE_MM = 1e5
MAX_POINTS = 1_000_000
_EXACT_MM = 1e-4
_ALIKE = 5.0  # a chain this many times as long as all others is the profile, the others are crumbs


@dataclass(frozen=True)
class Chain:
    """A polyline, ``points`` (N, 2) in mm, y up; if ``closed``, the first point is not repeated."""

    points: FloatArray
    closed: bool

    @property
    def length(self) -> float:
        """Arc length in mm, the closing piece included."""
        points = np.vstack([self.points, self.points[:1]]) if self.closed else self.points
        return float(np.hypot(*np.diff(points, axis=0).T).sum())

    @property
    def box(self) -> FloatArray:
        """Bounding box (2, 2): lowest and highest x, y."""
        return np.array([self.points.min(axis=0), self.points.max(axis=0)])


def clean(points: FloatArray, closed: bool, gap: float = JOIN_MM) -> Chain:
    """Drop repeated points (N, 2) and see whether the ends meet within ``gap`` mm.

    Raises
    ------
    UnreadableInput
        A coordinate is not finite or absurdly large.
    """
    if not np.all(np.abs(points) <= MAX_COORDINATE_MM):
        raise UnreadableInput(
            f"coordinates beyond {MAX_COORDINATE_MM:g} mm or not finite; check units and scale"
        )
    step = np.hypot(*np.diff(points, axis=0).T)
    points = points[np.concatenate([[True], step > SAME_MM])]
    if len(points) < 3:
        return Chain(points, False)
    ends = float(np.hypot(*(points[-1] - points[0])))
    # Three points out and back, or a piece hardly longer than the gap, have no inside.
    if ends <= gap and step.sum() > 4 * gap and len(points) > 3:
        closed = True
        if ends > SAME_MM:
            points = np.vstack([0.5 * (points[:1] + points[-1:]), points[1:-1]])
        else:
            points = points[:-1]
    return Chain(points, closed)


def join(chains: Iterable[Chain]) -> list[Chain]:
    """Join open chains end to end; a point where three or more meet ends them.

    Doubled chains count once. First the ends that coincide, then those within JOIN_MM, so that
    curves drawn in pieces shorter than that do not fall apart.
    """
    pieces = _without_doubles(chains)
    for gap in (_EXACT_MM, JOIN_MM):
        whole = [piece for piece in pieces if piece.closed]
        loose = [piece for piece in pieces if not piece.closed and piece.length > gap]
        pieces = _without_doubles(whole + _linked(loose, gap))
    return pieces


def choose(chains: Sequence[Chain]) -> Chain:
    """Pick the profile: the longest closed chain around all others, or the one that stands out.

    Raises
    ------
    NoObject
        There is none, or there are several alike.
    """
    if not chains:
        raise NoObject("nothing drawable; draw the profile as lines, arcs, polylines or splines")
    closed = max((c for c in chains if c.closed), key=lambda c: c.length, default=None)
    if closed is not None and all(_inside(c, closed) for c in chains):
        return closed
    ranked = sorted(chains, key=lambda c: c.length, reverse=True)
    outside = [c for c in ranked[1:] if not (ranked[0].closed and _inside(c, ranked[0]))]
    if outside and outside[0].length * _ALIKE > ranked[0].length:
        raise NoObject(
            f"several separate lines ({len(chains)}); keep one profile, close gaps wider than "
            f"{JOIN_MM:g} mm and delete construction lines that touch it"
        )
    return ranked[0]


def _inside(inner: Chain, outer: Chain) -> bool:
    low, high = outer.box
    return bool(np.all(inner.box[0] >= low - JOIN_MM) and np.all(inner.box[1] <= high + JOIN_MM))


def _without_doubles(chains: Iterable[Chain]) -> list[Chain]:
    kept: dict[tuple[bool, bytes], Chain] = {}
    for chain in chains:
        if len(chain.points) > 1:
            rounded = np.rint(chain.points / _EXACT_MM).astype(np.int64)
            key = min(rounded.tobytes(), rounded[::-1].tobytes())
            kept.setdefault((chain.closed, key), chain)
    return list(kept.values())


def _linked(chains: Sequence[Chain], gap: float) -> list[Chain]:
    """Join chains whose ends lie within ``gap`` mm; those that come in closed are not passed."""
    from ezdxf import edgeminer

    if not chains:
        return []
    edges = [
        edgeminer.make_edge(tuple(c.points[0]), tuple(c.points[-1]), payload=c.points)
        for c in chains
    ]
    found = edgeminer.find_all_simple_chains(edgeminer.Deposit(edges, gap_tol=gap))
    return [
        clean(_strung([e.payload[::-1] if e.is_reverse else e.payload for e in run]), False, gap)
        for run in found
    ]


def _strung(runs: Sequence[FloatArray]) -> FloatArray:
    """Put runs (N, 2) one after the other; where two meet, the middle of both ends stands."""
    points = [runs[0]]
    for run in runs[1:]:
        meeting = 0.5 * (points[-1][-1:] + run[:1])
        points[-1] = points[-1][:-1]
        points.append(np.concatenate([meeting, run[1:]]))
    return np.concatenate(points)
