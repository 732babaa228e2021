"""Strips and rings of the engine's own bricks, threads and contact, held and loaded as beams are.

`fem.assembly.System` holds one end of a tube and closes the other. Here the same items fill a
sparse matrix, and any coordinate can be held.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.linalg import splu

from fem.actuator import Actuator
from fem.contact import Contact, Pressed, pressed_of
from fem.element import natural_nodes, reference
from fem.gauze import Gauze
from fem.items import Batch, Bricks, MakeItem, Sums
from fem.material import PAIRS, MooneyRivlin
from fem.mesh import Mesh, make_mesh
from fem.meshsize import MeshSize

FloatArray = NDArray[np.float64]
WIDE = 2.0  # mm, of a strip
STEEL = MooneyRivlin.from_poisson(1e3, 0.0, 0.3)  # stiff, so that contact has little depth
_MOST, _SHORTENINGS = 40, 12


def strip(length: float, thick: float, height: float, rubber: MooneyRivlin, threads: float) -> Mesh:
    """Make a strip along z, one brick wide (x) and thick (y), whose outer face looks along -y.

    ``height`` is about that of a brick along z, ``threads`` their stiffness along the outer face,
    N/mm.
    """
    radius = 10.0
    tube = Actuator(
        length, (), wall=thick, plug=0.0, rubber=rubber, gauze=Gauze(stiffness=threads, slack=1.0)
    )
    size = MeshSize(around=1, beside=0.0, wrapped=height, end=height, edge=height)
    mesh = make_mesh(tube, size)
    X = mesh.X.copy()
    r, phi = np.hypot(X[..., 0], X[..., 1]), np.arctan2(X[..., 1], X[..., 0])
    X[..., 0], X[..., 1] = WIDE * phi / np.pi, radius - r
    X[-1, mesh.ring :] = 0.0
    brick = natural_nodes("hex20")[:, [1, 0, 2]] * [0.5 * WIDE, -0.5 * thick, 1.0]
    axial = replace(mesh.axial, weight=mesh.axial.weight * WIDE / (np.pi * radius))
    flat = reference("hex20", brick[None], size.orders)
    return replace(mesh, X=X, brick=(flat,), axial=axial, half=False)


def stiffness_in_plane(rubber: MooneyRivlin) -> float:
    """E / (1 - nu^2) at small strain, MPa."""
    G, K = rubber.shear_modulus, rubber.K
    nu = (3.0 * K - 2.0 * G) / (6.0 * K + 2.0 * G)
    return 2.0 * G * (1.0 + nu) / (1.0 - nu**2)


class Bench:
    """Equilibria of a mesh's items; coordinates ``held`` (layers + 1, ring + mid, 3) stay."""

    def __init__(self, mesh: Mesh, items: Sequence[MakeItem], held: NDArray[np.bool_]) -> None:
        self.mesh, self._items = mesh, [make(mesh) for make in (Bricks, *items)]
        held = held.copy()
        held[-1, mesh.ring :] = True
        self._free = np.flatnonzero(~held.ravel())
        nodes = mesh.bricks[:, :, None] + (np.arange(mesh.layers) * (mesh.ring + mesh.mid))
        self._nodes = np.moveaxis(nodes, 2, 1)  # (bricks, L, n)
        self.load = np.zeros_like(mesh.X)

    def _sums(self, x: FloatArray, stiffness: FloatArray | None) -> Sums:
        sums = Sums(self.mesh)
        batch = Batch(self.mesh, range(self.mesh.layers), x.reshape(-1, 3), 0.0, stiffness, sums)
        for item in self._items:
            item.add(batch)
            if not sums.least_J > 0.0:
                break
        return sums

    def reactions(self, x: FloatArray) -> FloatArray:
        """Forces of whatever holds the mesh (layers + 1, ring + mid, 3), N."""
        return np.asarray(self._sums(x, None).internal - self.load)

    def _step(self, x: FloatArray) -> tuple[float, FloatArray, FloatArray]:
        mesh, n = self.mesh, self.mesh.bricks.shape[1]
        stiffness = np.zeros((mesh.size.through, 6, mesh.around, mesh.layers, n, n))
        sums = self._sums(x, stiffness)
        rows, columns, values = [], [], []
        for number, (i, k) in enumerate(PAIRS):
            block = stiffness[:, number].reshape(-1, mesh.layers, n, n)
            row = np.broadcast_to(3 * self._nodes[..., :, None] + i, block.shape)
            column = np.broadcast_to(3 * self._nodes[..., None, :] + k, block.shape)
            pairs = [(row, column)] if i == k else [(row, column), (column, row)]
            for a, b in pairs:
                rows.append(a.ravel())
                columns.append(b.ravel())
                values.append(block.ravel())
        at = (np.concatenate(rows), np.concatenate(columns))
        K = coo_array((np.concatenate(values), at), shape=(x.size, x.size)).tocsc()
        right = (self.load - sums.internal).ravel()[self._free]
        du = np.zeros(x.size)
        du[self._free] = splu(K[self._free][:, self._free]).solve(right)
        return self._energy(sums, x), du.reshape(x.shape), right

    def _energy(self, sums: Sums, x: FloatArray) -> float:
        return sums.energy - float((self.load * x).sum()) if sums.least_J > 0.0 else np.inf

    def find(self, x: FloatArray, tolerance: float = 1e-9) -> FloatArray:
        """Go downhill in the energy from nodes x to an equilibrium; ``tolerance`` in N."""
        for _ in range(_MOST):
            energy, du, right = self._step(x)
            if np.abs(right).max() < tolerance:
                return x
            slope, share = float(right @ du.ravel()[self._free]), 1.0
            for _ in range(_SHORTENINGS):
                new = x + share * du
                allowed = energy - 1e-4 * share * slope + 1e-12 * abs(energy)
                if self._energy(self._sums(new, None), new) <= allowed:
                    break
                share *= 0.4
            x = new
        raise AssertionError(f"no equilibrium: {np.abs(right).max():.1e} N are left")

    def settled(self, x: FloatArray, contact: Contact, depth: float = 1e-4) -> Pressed:
        """Find an equilibrium without depth in the obstacle; ``x`` becomes it."""
        for _ in range(8):
            x[...] = self.find(x)
            pressed = pressed_of(contact, self.mesh, x)
            if pressed.own_depth < depth:
                break
            contact.update(pressed)
        return pressed
