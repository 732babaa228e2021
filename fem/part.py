"""One half of the elimination: the layers from an end of the tube to its middle."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from fem.arrays import DOUBLE, DType, FloatArray, IntArray
from fem.items import Batch, MakeItem, Sums
from fem.mesh import Mesh
from fem.pattern import Pattern, Unknowns, make_pattern
from fem.pivot import Pivot
from fem.plug import Plug

_CHUNK = 512  # bricks at a time, so that the arrays of one step stay in the cache


class Part:
    """The layers from one end of the tube to the middle, eliminated from the end inward.

    Attributes
    ----------
    pivots : dict of layer to Pivot
    couplings : dict of layer to (block, far) arrays
        Reduced couplings to the ring ahead.
    next : (far, far)
        What has been added to the next pivot, its upper triangle.
    dtype : dtype
        Of the tangent; all else is in double precision.
    items : tuple of Item
        What contributes to the energy.
    stiffness : (through, 6, around, column)
        Of the bricks, for the pairs (i, k), layers one after another.
    sums : Sums
        Energy, volume and nodal forces of this part.
    """

    def __init__(
        self,
        mesh: Mesh,
        unknowns: Unknowns,
        layers: range,
        items: Sequence[MakeItem],
        *,
        from_root: bool,
        dtype: DType = DOUBLE,
    ) -> None:
        self.dtype = dtype
        self.mesh, self.unknowns, self.from_root = mesh, unknowns, from_root
        self.order = layers if from_root else layers[::-1]
        n = mesh.bricks.shape[1]
        self.chunks = _chunks(self.order, max(1, _CHUNK // len(mesh.bricks)))
        self.column = max((len(c) for c in self.chunks), default=0) * n * n
        self.items = tuple(make(mesh) for make in items)
        self.sums = Sums(mesh)

        def pattern(*, clamped: bool) -> Pattern:
            return make_pattern(
                mesh, unknowns, from_root=from_root, clamped=clamped,
                column=self.column,
            )  # fmt: skip

        plain = pattern(clamped=False)
        self.patterns = dict.fromkeys(self.order, plain)
        if from_root and layers:
            self.patterns[0] = pattern(clamped=True)
        self.scratch = {p: np.empty(len(p.first), dtype) for p in set(self.patterns.values())}
        # As many zeros behind the stiffness as the last layer's view reaches beyond it.
        shape = (mesh.size.through, 6, mesh.around, self.column)
        self.entries = np.zeros(math.prod(shape) + self.column + 1, dtype)
        self.stiffness = self.entries[: math.prod(shape)].reshape(shape)
        sizes = {
            layer: p.block + (unknowns.plug - p.behind if self._is_plug(layer) else 0)
            for layer, p in self.patterns.items()
        }
        self.pivots = {layer: Pivot(size, dtype) for layer, size in sizes.items()}
        self.couplings = {
            layer: np.empty((size, plain.far), dtype) for layer, size in sizes.items()
        }
        self.next = np.zeros((plain.far, plain.far), dtype)

    def _is_plug(self, layer: int) -> bool:
        return layer == self.mesh.layers - 1

    def evaluate(self, x: FloatArray, pressure: float, plug: Plug | None) -> None:
        """Sum this part's forces; with ``plug`` factor its layers too."""
        mesh, n = self.mesh, self.mesh.bricks.shape[1]
        self.sums.clear()
        self.next[...] = 0.0
        for chunk in self.chunks:
            L = len(chunk)
            entries = self.stiffness[..., : L * n * n]
            stiffness = entries.reshape(mesh.size.through, 6, mesh.around, L, n, n)
            wanted = None if plug is None else stiffness
            self._add_items(Batch(mesh, chunk, x.reshape(-1, 3), pressure, wanted, self.sums))
            if not self.sums.least_J > 0.0:
                return
            if plug is not None:
                for layer in chunk if self.from_root else chunk[::-1]:
                    self._eliminate(layer, layer - chunk.start, x, pressure, plug)

    def _add_items(self, batch: Batch) -> None:
        for item in self.items:
            item.add(batch)
            if not self.sums.least_J > 0.0:
                return

    def _eliminate(
        self, layer: int, place: int, x: FloatArray, pressure: float, plug: Plug
    ) -> None:
        pattern, pivot, coupling = self.patterns[layer], self.pivots[layer], self.couplings[layer]
        b, r = pattern.block, pattern.far
        source = self.entries[place * self.mesh.bricks.shape[1] ** 2 :]
        step = self.scratch[pattern]
        np.take(source, pattern.first, out=step, mode="clip")  # clip: no check of every index
        for at, to in zip(pattern.source, pattern.target, strict=True):
            step[to] += source[at]
        own = step[: b * b].reshape(b, b)
        own_coupling = step[b * b : b * (b + r)].reshape(b, r)
        added = self.next[: pattern.behind, : pattern.behind]
        if self._is_plug(layer):
            load = (self.sums.internal[-1] - pressure * self.sums.gradient[-1])[: self.mesh.ring]
            own, own_coupling = plug.condense(x, load, pressure, own, own_coupling)
            added = added[:0, :0]  # there is no layer before it
        np.copyto(coupling, own_coupling)
        pivot.factorise(own, added)
        np.copyto(self.next, step[b * (b + r) :].reshape(r, r))
        pivot.reduce(coupling)
        pivot.update(self.next, coupling)

    def forward(self, rings: FloatArray, mids: FloatArray, plug: FloatArray) -> FloatArray:
        """Reduce right sides in place; return what to take from the middle ring's (k, far)."""
        carry = np.zeros((len(rings), self.next.shape[0]), self.dtype)
        for layer in self.order:
            rows = self._rows(layer, rings, mids, plug)
            if self.patterns[layer].behind and not self._is_plug(layer):
                rows[:, mids.shape[2] :] -= carry
            self.pivots[layer].forward(rows)
            carry = rows @ self.couplings[layer]
            self._put(layer, rows, rings, mids, plug)
        return carry

    def backward(
        self,
        rings: FloatArray,
        mids: FloatArray,
        plug: FloatArray,
        ahead: FloatArray,
        *,
        positive: bool,
    ) -> None:
        """Solve in place from the middle ring's values ``ahead`` (k, far) to the end.

        ``positive``: with all eigenvalues of the pivots turned positive.
        """
        for layer in self.order[::-1]:
            pivot = self.pivots[layer]
            rows = self._rows(layer, rings, mids, plug)
            if positive and pivot.signs is not None:
                rows *= pivot.signs
            coupled = ahead @ self.couplings[layer].T
            rows -= coupled if pivot.signs is None else coupled * pivot.signs
            pivot.backward(rows)
            ahead = rows[:, mids.shape[2] :]
            self._put(layer, rows, rings, mids, plug)

    def compliance(
        self, layers: IntArray, loads: FloatArray, T: FloatArray, result: FloatArray
    ) -> tuple[IntArray, FloatArray]:
        """Add this part's share of L^-1 A squared; return the patterns and what is left of them.

        ``loads`` (s, 3 nodes of a layer), ``T`` the motions of the last ring by the plug's.
        """
        # In the order of elimination, so that those under way are always the first ones.
        groups = [np.flatnonzero(layers == layer) for layer in self.order]
        which = np.concatenate([np.zeros(0, dtype=np.int64), *groups])
        shares = np.zeros((len(which), len(which)))
        ahead = np.zeros((0, self.next.shape[0]), self.dtype)
        own_mids = len(self.unknowns.mid)
        for layer, fresh in zip(self.order, groups, strict=True):
            pattern, before = self.patterns[layer], len(ahead)
            count = before + len(fresh)
            if count == 0:
                continue
            pivot = self.pivots[layer]
            rows = np.zeros((count, len(pivot.factor)), self.dtype)
            if before:
                rows[:before, own_mids:] = ahead
            own = loads[fresh][:, pattern.block_nodes]
            if self._is_plug(layer):
                rows[before:, :own_mids] = own[:, :own_mids]
                rows[before:, own_mids:] = loads[fresh][:, -T.shape[0] :] @ T
            else:
                rows[before:] = own
            pivot.forward(rows)
            shares[:count, :count] += rows @ rows.T
            ahead = -(rows @ self.couplings[layer])
            ahead[before:] += loads[fresh][:, pattern.far_nodes]
        result[np.ix_(which, which)] += shares
        return which, ahead

    def _behind(self, layer: int, rings: FloatArray, plug: FloatArray) -> FloatArray | None:
        if self._is_plug(layer):
            return plug
        if self.patterns[layer].behind == 0:
            return None
        return rings[:, layer - 1 if self.from_root else layer]

    def _rows(
        self, layer: int, rings: FloatArray, mids: FloatArray, plug: FloatArray
    ) -> FloatArray:
        behind = self._behind(layer, rings, plug)
        parts = [mids[:, layer]] if behind is None else [mids[:, layer], behind]
        return np.concatenate(parts, axis=1)

    def _put(
        self, layer: int, rows: FloatArray, rings: FloatArray, mids: FloatArray, plug: FloatArray
    ) -> None:
        own = mids.shape[2]
        mids[:, layer] = rows[:, :own]
        behind = self._behind(layer, rings, plug)
        if behind is not None:
            behind[...] = rows[:, own:]


def _chunks(order: range, most: int) -> list[range]:
    """Cut layers into ascending ranges of nearly equal length, in the order of elimination."""
    count = -(-len(order) // most) if len(order) else 0
    cuts = [round(len(order) * k / count) for k in range(count + 1)] if count else []
    chunks = [order[a:b] for a, b in pairwise(cuts)]
    return [chunk if chunk.step > 0 else chunk[::-1] for chunk in chunks]
