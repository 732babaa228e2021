"""Numbering of the unknowns, and the places of brick matrices in a layer's step."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem.arrays import IntArray
from fem.material import PAIRS
from fem.mesh import Mesh


@dataclass(frozen=True)
class Unknowns:
    """The unknowns of a mesh, as one vector.

    First the rings between the clamped one and the last, then the mid nodes of all layers, then
    the motion of the plug: (layers - 1) * len(ring) + layers * len(mid) + plug.

    Attributes
    ----------
    ring, mid : int arrays
        What is free of a ring's and a mid section's 3 n coordinates.
    plug : int
        3 in a half model (offset in y and z, spin about x), else 6.
    layers : int
    """

    ring: IntArray
    mid: IntArray
    plug: int
    layers: int

    @classmethod
    def of(cls, mesh: Mesh) -> Unknowns:
        """Lay out the unknowns of a mesh."""
        free = [np.flatnonzero(~held.ravel()) for held in (mesh.fixed_ring, mesh.fixed_mid)]
        return cls(free[0], free[1], 3 if mesh.half else 6, mesh.layers)

    @property
    def rings(self) -> int:
        """How many unknowns the rings have together."""
        return (self.layers - 1) * len(self.ring)

    @property
    def count(self) -> int:
        """How many unknowns there are."""
        return self.rings + self.layers * len(self.mid) + self.plug


@dataclass(frozen=True, eq=False)
class Pattern:
    """How a layer's brick matrices fill the matrices of its elimination step.

    The step eliminates the layer's mid nodes and the ring behind it (away from the middle of the
    tube), ``block`` unknowns, which couple to ``far`` unknowns of the ring ahead. One flat array
    holds the step's pivot (block, block), its coupling (block, far) and what it adds to the next
    pivot (far, far), of the squares only the upper triangle.

    Attributes
    ----------
    block, far, behind : int
        Sizes; ``behind`` are the unknowns of the ring behind (0 where it is clamped).
    block_nodes, far_nodes : int arrays
        The unknowns' places among the coordinates of the layer's nodes.
    first : (size,) int
        The first entry of the layer's stiffness that goes to each place; where none does, one
        past the stiffness's end, which holds zero.
    source, target : tuples of int arrays
        Where several bricks share a place, the further entries: ``source[k][n]`` adds to
        ``target[k][n]``; no target stands twice in one array.
    """

    block: int
    far: int
    behind: int
    block_nodes: IntArray
    far_nodes: IntArray
    first: IntArray
    source: tuple[IntArray, ...]
    target: tuple[IntArray, ...]


def make_pattern(
    mesh: Mesh, unknowns: Unknowns, *, from_root: bool, clamped: bool, column: int
) -> Pattern:
    """Lay out a layer's step.

    Parameters
    ----------
    mesh : Mesh
    unknowns : Unknowns
    from_root : bool
        Whether the step goes toward the closed end.
    clamped : bool
        Whether the ring behind is the clamped one.
    column : int
        Step in the stiffness array (through, 6, around, column) between columns of bricks.
    """
    ring, mid = mesh.ring, mesh.mid
    place = np.full((2 * ring + mid, 3), -1)
    order = [(slice(ring, ring + mid), unknowns.mid)]
    ends = [(slice(0, ring), unknowns.ring), (slice(ring + mid, None), unknowns.ring)]
    behind, ahead = ends if from_root else ends[::-1]
    order += [] if clamped else [behind]
    block = 0
    for where, free in order:
        block = _number(place[where], free, block)
    far = _number(place[ahead[0]], ahead[1], block) - block
    at, to = _entries(mesh, place, block, far, column)
    ranks = _ranked(to)
    flat = place.reshape(-1)
    numbered = np.flatnonzero(flat >= 0)
    nodes = numbered[np.argsort(flat[numbered])]
    first = np.full(block**2 + block * far + far**2, mesh.size.through * 6 * mesh.around * column)
    first[to[ranks[0]]] = at[ranks[0]]
    return Pattern(
        block,
        far,
        0 if clamped else len(unknowns.ring),
        nodes[:block],
        nodes[block:],
        first,
        tuple(at[r] for r in ranks[1:]),
        tuple(to[r] for r in ranks[1:]),
    )


def _number(place: IntArray, free: IntArray, start: int) -> int:
    flat = place.reshape(-1)
    numbered = flat.copy()
    numbered[free] = start + np.arange(len(free))
    place[...] = numbered.reshape(place.shape)
    return start + len(free)


def _entries(
    mesh: Mesh, place: IntArray, block: int, far: int, column: int
) -> tuple[IntArray, IntArray]:
    around, n = len(mesh.outer), mesh.bricks.shape[1]
    sources, targets = [], []
    a, b = np.divmod(np.arange(n * n), n)
    for number, nodes in enumerate(mesh.bricks):
        deep, k = divmod(number, around)
        for m, (i, j) in enumerate(PAIRS):
            row, other = place[nodes[a], i], place[nodes[b], j]
            low, high = np.minimum(row, other), np.maximum(row, other)
            keep = low >= 0
            if i == j:
                keep &= row <= other  # the other half stands there too
            at = ((deep * 6 + m) * around + k) * column + np.arange(n * n)
            in_pivot = low * block + high
            in_coupling = block * block + low * far + (high - block)
            in_next = block * (block + far) + (low - block) * far + (high - block)
            to = np.where(high < block, in_pivot, np.where(low < block, in_coupling, in_next))
            sources.append(at[keep])
            targets.append(to[keep])
    return np.concatenate(sources), np.concatenate(targets)


def _ranked(to: IntArray) -> list[IntArray]:
    """Split entries so that no target stands twice in one group."""
    order = np.argsort(to, kind="stable")
    sorted_to = to[order]
    first = np.concatenate([[True], sorted_to[1:] != sorted_to[:-1]])
    start = np.maximum.accumulate(np.where(first, np.arange(len(to)), 0))
    rank = np.arange(len(to)) - start
    return [order[rank == r] for r in range(int(rank.max()) + 1)]
