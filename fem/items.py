"""The contributions to the potential energy: bricks, threads and enclosed air, each an item.

A part of the tube goes through its items batch by batch of layers. An item adds its energy, its
nodal forces and its blocks of the tangent; it knows nothing of the elimination, and the
elimination nothing of it. `ITEMS` are those that every actuator has; further ones, such as a
foundation or a contact, join behind them.

The tangent of an item couples nodes of one brick only, and it must be symmetric. For each pair
(i, k) of `fem.material.PAIRS` its block [a, b] is d2E / dx_ai dx_bk over the brick's nodes; that
of (k, i) is the block of (i, k) transposed.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from fem import gauze, solid
from fem.arrays import FloatArray, IntArray
from fem.gauze import Threads
from fem.mesh import Mesh
from fem.pressure import face_volumes


class Sums:
    """Sums over the layers of a part.

    Attributes
    ----------
    internal : (layers + 1, ring + mid, 3) N
        Gradient of the stored energy by the nodes.
    gradient : (layers + 1, ring + mid, 3) mm^2
        Gradient of the enclosed volume: forces of a unit pressure.
    energy : float, N mm
    volume : float, mm^3
    least_J : float
        Smallest determinant of F so far.
    """

    def __init__(self, mesh: Mesh) -> None:
        self.internal = np.zeros_like(mesh.X)
        self.gradient = np.zeros_like(mesh.X)
        self.clear()

    def clear(self) -> None:
        """Begin anew."""
        self.internal[...] = 0.0
        self.gradient[...] = 0.0
        self.energy = self.volume = 0.0
        self.least_J = np.inf


@dataclass(frozen=True)
class Batch:
    """Some layers of a part in a deformed state; L layers, c bricks around, bricks of n nodes.

    Attributes
    ----------
    mesh : Mesh
    layers : range
        Ascending.
    x : (N, 3) mm
        All nodes of the mesh, section after section.
    pressure : float, MPa
    stiffness : (through, 6, c, L, n, n) N/mm, or None
        For items to add to, where the tangent is wanted; the bricks, who come first, fill it.
    sums : Sums
        For items to add to.
    """

    mesh: Mesh
    layers: range
    x: FloatArray
    pressure: float
    stiffness: FloatArray | None
    sums: Sums

    @property
    def first(self) -> IntArray:
        """Number of the first node of each layer, (L,)."""
        return np.asarray(self.layers) * (self.mesh.ring + self.mesh.mid)

    @property
    def outer(self) -> IntArray:
        """Nodes of the outer faces, (L, c, m)."""
        return self.first[:, None, None] + self.mesh.outer

    @property
    def skin(self) -> FloatArray | None:
        """Stiffness among the nodes of the outer faces, a view (6, c, L, m, m)."""
        m = self.mesh.outer.shape[1]
        return None if self.stiffness is None else self.stiffness[-1][..., -m:, -m:]

    def add_forces(self, nodes: IntArray, forces: FloatArray) -> None:
        """Add gradients of the stored energy (3, ...), N, at nodes (...)."""
        _scatter(self.sums.internal.reshape(-1, 3), nodes, forces)

    def add_volume_gradient(self, nodes: IntArray, gradient: FloatArray) -> None:
        """Add gradients of the enclosed volume (3, ...), mm^2, at nodes (...)."""
        _scatter(self.sums.gradient.reshape(-1, 3), nodes, gradient)


class Item(Protocol):
    """A contribution to the potential energy of one mesh."""

    def add(self, batch: Batch) -> None:
        """Add what the item has in a batch's layers: energy, forces and, if wanted, stiffness."""


# Each half of the elimination has items of its own, since both work at the same time.
MakeItem = Callable[[Mesh], Item]


class Bricks:
    """The rubber."""

    def __init__(self, mesh: Mesh) -> None:
        self._mesh = mesh
        self._work = solid.Workspace()

    def add(self, batch: Batch) -> None:
        """Add the bricks; stop where one is turned inside out."""
        mesh, sums, first = self._mesh, batch.sums, batch.first
        c, n, L = mesh.around, mesh.bricks.shape[1], len(first)
        for deep in range(mesh.size.through):
            nodes = mesh.bricks[deep * c : (deep + 1) * c, :, None] + first  # (c, n, L)
            state = solid.respond(
                mesh.actuator.rubber,
                mesh.brick[deep],
                mesh.heights[batch.layers.start : batch.layers.stop],
                np.ascontiguousarray(np.moveaxis(batch.x[nodes], 3, 0)),
                self._work,
                None if batch.stiffness is None else batch.stiffness[deep].reshape(6, c, L, n * n),
                mean_dilatation=mesh.size.mean_dilatation,
            )
            sums.least_J = min(sums.least_J, state.least_J)
            if not sums.least_J > 0.0:
                return
            sums.energy += state.energy
            batch.add_forces(nodes, state.force)


class ThreadFamily:
    """One family of the gauze's threads, on all outer faces."""

    def __init__(self, mesh: Mesh, threads: Threads) -> None:
        self._mesh, self._threads = mesh, threads

    def add(self, batch: Batch) -> None:
        """Add the threads."""
        c, m = self._mesh.outer.shape
        faces = slice(batch.layers.start * c, batch.layers.stop * c)
        threads = Threads(self._threads.gradient[faces], self._threads.weight[faces])
        outer, skin = batch.outer, batch.skin
        state = gauze.respond(
            self._mesh.actuator.gauze, threads, batch.x[outer.reshape(-1, m)], skin is not None
        )
        batch.sums.energy += float(state.energy.sum())
        batch.add_forces(outer, np.moveaxis(state.force, 2, 0))
        if skin is not None and state.stiffness is not None:
            skin += state.stiffness.reshape(-1, c, 6, m, m).transpose(2, 1, 0, 3, 4)


class Air:
    """The air inside the wall, -pressure * volume; the plug's disc belongs to the plug."""

    def __init__(self, mesh: Mesh) -> None:
        self._mesh = mesh

    def add(self, batch: Batch) -> None:
        """Add volume, its gradient, and the stiffness of the pressure."""
        c, m = self._mesh.inner.shape
        first, stiffness = batch.first, batch.stiffness
        inner = (self._mesh.inner.T[:, :, None] + first).reshape(m, -1)  # (m, c L)
        faces = np.ascontiguousarray(np.moveaxis(batch.x[inner], 2, 0))
        volume, gradient, h = face_volumes(faces, stiffness is not None)
        batch.sums.volume += float(volume.sum())
        batch.add_volume_gradient(inner, gradient)
        if stiffness is not None and h is not None:
            wall = stiffness[0][..., :m, :m]
            h = batch.pressure * np.moveaxis(h.reshape(3, m, m, c, len(first)), (3, 4), (1, 2))
            wall[1] -= h[2]
            wall[2] += h[1]
            wall[4] -= h[0]


def _axial(mesh: Mesh) -> ThreadFamily:
    return ThreadFamily(mesh, mesh.axial)


def _hoop(mesh: Mesh) -> ThreadFamily:
    return ThreadFamily(mesh, mesh.hoop)


ITEMS: Sequence[MakeItem] = (Bricks, _axial, _hoop, Air)


def _scatter(into: FloatArray, nodes: IntArray, values: FloatArray) -> None:
    """Add values (3, ...) to the rows ``nodes`` (...) of ``into`` (N, 3)."""
    low = int(nodes.min())
    size = int(nodes.max()) - low + 1
    at = nodes.ravel() - low
    for i in range(3):
        into[low : low + size, i] += np.bincount(at, values[i].ravel(), size)
