"""Pieces of a drawing to the one line that is the profile.

A chain is a run of points without branches; drawings in DXF and SVG hold many of them, often one
per line or arc.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from profiletool.errors import UnreadableInput
from profiletool.records.units import FloatArray

FLAT_MM = 0.01  # curves become polylines that stay this near
JOIN_MM = 0.05  # ends this near to each other meet
SAME_MM = 1e-6  # points this near are one
MAX_COORDINATE_MM = 1e5
MAX_POINTS = 200_000
MAX_MEETINGS = 1_000_000  # pairs of ends that lie together
_EXACT_MM = 1e-4


@dataclass(frozen=True)
class Polyline:
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


def clean(points: FloatArray, closed: bool, gap: float = JOIN_MM) -> Polyline:
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
        return Polyline(points, False)
    ends = float(np.hypot(*(points[-1] - points[0])))
    # Three points out and back, or a piece hardly longer than the gap, have no inside.
    if ends <= gap and step.sum() > 4 * gap and len(points) > 3:
        closed = True
        if ends > SAME_MM:
            points = np.vstack([0.5 * (points[:1] + points[-1:]), points[1:-1]])
        else:
            points = points[:-1]
    return Polyline(points, closed)


def join(
    chains: Iterable[Polyline], gaps: Sequence[float] = (_EXACT_MM, JOIN_MM)
) -> list[Polyline]:
    """Join open chains end to end; a point where three or more meet ends them.

    Doubled chains count once. First the ends that coincide, then those within JOIN_MM, so that
    curves drawn in pieces shorter than that do not fall apart; or ends within other ``gaps``, mm.

    Raises
    ------
    UnreadableInput
        So many chains end in one place that it is no drawing of a profile.
    """
    pieces = _without_doubles(chains)
    for gap in gaps:
        whole = [piece for piece in pieces if piece.closed]
        loose = [piece for piece in pieces if not piece.closed and piece.length > gap]
        pieces = _without_doubles(whole + _linked(loose, gap))
    return pieces


def _without_doubles(chains: Iterable[Polyline]) -> list[Polyline]:
    kept: dict[tuple[bool, bytes], Polyline] = {}
    for chain in chains:
        if len(chain.points) > 1:
            rounded = np.rint(chain.points / _EXACT_MM).astype(np.int64)
            key = min(rounded.tobytes(), rounded[::-1].tobytes())
            kept.setdefault((chain.closed, key), chain)
    return list(kept.values())


def _linked(chains: Sequence[Polyline], gap: float) -> list[Polyline]:
    """Join chains whose ends lie within ``gap`` mm; those that come in closed are not passed."""
    if not chains:
        return []
    ends = np.concatenate([chain.points[[0, -1]] for chain in chains])
    return [
        clean(
            _strung([chains[end // 2].points[:: -1 if end % 2 else 1] for end in run]), False, gap
        )
        for run in _runs(_partners(ends, gap))
    ]


def _partners(ends: FloatArray, gap: float) -> list[int]:
    """For each end (2 N, 2) the one other that it meets; -1 where it meets none or several."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import cKDTree

    tree = cKDTree(ends)
    if tree.count_neighbors(tree, gap) - len(ends) > 2 * MAX_MEETINGS:
        raise UnreadableInput(
            "far too many lines end in one place; draw the profile as one plain line"
        )
    a, b = tree.query_pairs(gap, output_type="ndarray").T
    near = coo_array((np.ones(len(a), dtype=np.int8), (a, b)), shape=(len(ends), len(ends)))
    place = connected_components(near, directed=False)[1]
    partner = np.full(len(ends), -1)
    alone = np.bincount(place)[place[a]] == 2
    partner[a[alone]], partner[b[alone]] = b[alone], a[alone]
    return [int(end) for end in partner]


def _runs(partner: Sequence[int]) -> Iterator[list[int]]:
    """Yield the ends at which the chains of each run are entered; they are left at the other."""
    loose = [end for end, met in enumerate(partner) if met < 0]
    used: set[int] = set()
    for first in (*loose, *range(0, len(partner), 2)):  # rings last: they may start anywhere
        run, end = [], first
        while end >= 0 and end // 2 not in used:
            used.add(end // 2)
            run.append(end)
            end = partner[end ^ 1]
        if run:
            yield run


def _strung(runs: Sequence[FloatArray]) -> FloatArray:
    """Put runs (N, 2) one after the other; where two meet, the middle of both ends stands."""
    points = [runs[0]]
    for run in runs[1:]:
        meeting = 0.5 * (points[-1][-1:] + run[:1])
        points[-1] = points[-1][:-1]
        points.append(np.concatenate([meeting, run[1:]]))
    return np.concatenate(points)
