"""The profile among the lines of a drawing: frames left out, gaps closed, parts joined."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from profiletool.errors import NoObject
from profiletool.profile.drawing.chain import JOIN_MM, Polyline, clean, join
from profiletool.profile.drawing.frames import box_text, inner_shapes, without_frames

_ALIKE = 5.0  # a chain this many times as long as all others is the profile, the others are crumbs
_WIDE = 0.003  # of a drawing's diagonal: a gap that is closed with a note
_NEAR_SHARE, _NEAR_STEPS, _NEAR_MOST = 0.005, 2.0, 0.05  # how near ends lie that were meant to meet
_DENSE = 12  # points from which on their spacing says anything
_WHOLE = 0.8  # of an open line's length: an outline of all lines that is meant instead
MAX_CLOSE_PAIRS = 2e7  # of pieces of a line that might cross
MAX_CROSSINGS = 1e5  # of such pairs among lines whose common outline is looked for


@dataclass(frozen=True)
class Choice:
    """The profile of a drawing, and what was done to find it."""

    chain: Polyline
    notes: tuple[str, ...] = ()


def choose(chains: Sequence[Polyline]) -> Choice:
    """Pick the profile: the longest closed chain around all others, or the one that stands out.

    Frames are left out; of lines that meet, cross or overlap the outline of all is taken; ends
    that all but meet are joined. Each is told in a note.

    Raises
    ------
    NoObject
        There is none, there are several alike, or a frame cannot be told from an object.
    UnreadableInput
        Lines without end in one place.
    """
    if not chains:
        raise NoObject("nothing drawable; draw the profile as lines, arcs, polylines or splines")
    chains, notes = without_frames(list(chains))
    found = _plain(chains) or _whole(chains, wide=False) or _whole(chains, wide=True)
    if found is None:
        raise NoObject(
            f"several separate lines ({len(chains)}), {_places(chains)}; keep one profile, close "
            "gaps and delete construction lines that touch it, or choose a `layer`"
        )
    closed = near_closed(found.chain)
    whole = any(found.chain is chain for chain in chains)
    inner = inner_shapes(closed.chain, chains) if whole else ()
    return Choice(closed.chain, (*notes, *found.notes, *closed.notes, *inner))


def near_closed(chain: Polyline) -> Choice:
    """Close an open chain whose ends lie as near to each other as its points, or nearly meet."""
    points = chain.points
    if chain.closed or len(points) < 4:
        return Choice(chain)
    steps = np.hypot(*np.diff(points, axis=0).T)
    gap, length = float(np.hypot(*(points[-1] - points[0]))), float(steps.sum())
    dense = (
        len(steps) >= _DENSE
        and gap <= _NEAR_STEPS * float(np.median(steps))
        and gap <= _NEAR_MOST * length
    )
    if not (dense or gap <= _NEAR_SHARE * length):
        return Choice(chain)
    x, y = points[0]
    note = f"the outline's ends are {gap:.2g} mm apart at ({x:.1f}, {y:.1f}): it was closed"
    if dense:
        return Choice(Polyline(points, True), (note,))
    return Choice(clean(points, False, gap * 1.001), (note,))


def _plain(chains: Sequence[Polyline]) -> Choice | None:
    """Take the chain that is round all others or far longer; None where no closed one is."""
    closed = max((c for c in chains if c.closed), key=lambda c: c.length, default=None)
    if closed is not None and all(lies_in(c, closed) for c in chains):
        return Choice(closed)
    longest = _outstanding(chains)
    if longest is None or longest.closed or len(chains) == 1:
        return None if longest is None else Choice(longest)
    whole = _whole(chains, wide=False)  # an outline that a line on it has broken up
    meant = whole is not None and whole.chain.length > _WHOLE * longest.length
    return whole if meant else Choice(longest)


def _outstanding(chains: Sequence[Polyline]) -> Polyline | None:
    ranked = sorted(chains, key=lambda c: c.length, reverse=True)
    first = ranked[0]
    outside = [c for c in ranked[1:] if not (first.closed and lies_in(c, first))]
    return None if outside and outside[0].length * _ALIKE > first.length else first


def _whole(chains: Sequence[Polyline], wide: bool) -> Choice | None:
    """Outline of all lines together, their small gaps closed if ``wide``; None without one."""
    note = f"the outline round all {len(chains)} lines was taken"
    if wide:
        box = np.array([c.box for c in chains])
        gap = _WIDE * float(np.hypot(*(box[:, 1].max(axis=0) - box[:, 0].min(axis=0))))
        joined = join(chains, (gap,)) if gap > JOIN_MM else list(chains)
        if len(joined) == len(chains):
            return None
        one = _outstanding(joined)
        note = f"gaps of up to {gap:.2g} mm between lines were closed"
        if one is not None and (one.closed or len(joined) == 1):
            return Choice(one, (note,))
        chains = joined
    ring = _outer(chains)
    return None if ring is None else Choice(ring, (note,))


def _outer(chains: Sequence[Polyline]) -> Polyline | None:
    """Outline of what lines enclose together; None where that is nothing, or much is outside."""
    import shapely

    if tangled(chains, MAX_CROSSINGS):
        return None
    lines = shapely.set_precision(
        [shapely.LinearRing(c.points) if c.closed else shapely.LineString(c.points)
         for c in chains if len(c.points) > (2 if c.closed else 1)], 1e-4,
    )  # fmt: skip
    noded = shapely.unary_union(lines)
    body = shapely.unary_union(shapely.get_parts(shapely.polygonize([noded])))
    parts = sorted(shapely.get_parts(body), key=lambda part: float(part.exterior.length))
    if not parts:
        return None
    ring = parts[-1].exterior
    left = [float(part.exterior.length) for part in parts[:-1]]
    left += [float(p.length) for p in shapely.get_parts(noded.difference(body.buffer(JOIN_MM)))]
    if max(left, default=0.0) * _ALIKE > float(ring.length):
        return None
    return clean(shapely.get_coordinates(ring), True)


def tangled(chains: Sequence[Polyline], most: float = MAX_CLOSE_PAIRS) -> bool:
    """Whether pieces lie across each other so much that finding crossings takes for ever."""
    import shapely

    ends = [
        np.stack([p[:-1], p[1:]], axis=1)
        for c in chains
        if len(p := np.vstack([c.points, c.points[:1]]) if c.closed else c.points) > 1
    ]
    pieces = shapely.linestrings(np.concatenate(ends))
    every = max(1, len(pieces) // 200)
    tree = shapely.STRtree(pieces)
    return every * sum(max(len(tree.query(piece)) - 3, 0) for piece in pieces[::every]) > most


def lies_in(inner: Polyline, outer: Polyline) -> bool:
    """Whether one chain's box lies in that of another."""
    low, high = outer.box
    return bool(np.all(inner.box[0] >= low - JOIN_MM) and np.all(inner.box[1] <= high + JOIN_MM))


def _places(chains: Sequence[Polyline]) -> str:
    """Say where the two longest lines are."""
    longest = sorted(chains, key=lambda c: c.length, reverse=True)[:2]
    return " and ".join(box_text(chain) for chain in longest)
