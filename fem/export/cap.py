"""The rigid closed end as elements: what is behind the last ring, filled with bricks and wedges."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem.arrays import FloatArray, IntArray
from fem.mesh import Mesh

_LEAST = 0.05  # thickness over the diameter, where the actuator has no plug


@dataclass(frozen=True)
class Cap:
    """Nodes and elements of the closed end, numbered on from the tube's.

    Attributes
    ----------
    X : (n, 3) mm
        The new nodes alone.
    bricks : (B, 20 or 8) int
        Behind the wall, in our order of nodes.
    wedges : (W, 15 or 6) int
        Behind the air, a fan: triangle that the air pushes on, triangle behind it, mid-sides of
        the first, of the second, and of the edges between.
    """

    X: FloatArray
    bricks: IntArray
    wedges: IntArray


def make_cap(mesh: Mesh) -> Cap:
    """Fill the closed end of a mesh."""
    a, row, first = mesh.actuator, mesh.ring + mesh.mid, mesh.nodes
    thick = a.plug if a.plug > 0.0 else _LEAST * a.diameter
    ring, mid = mesh.X[-1, : mesh.ring].copy(), mesh.X[0, mesh.ring :].copy()
    mid[:, 2] = mesh.z[-1] + 0.5 * thick
    behind = ring + np.array([0.0, 0.0, thick])
    bricks = row * mesh.layers + mesh.bricks
    X = np.concatenate([mid, behind])
    inner = row * mesh.layers + mesh.inner
    numbers = _Fan(np.concatenate([mesh.X.reshape(-1, 3)[:first], X]), mesh.z[-1], thick)
    quadratic = mesh.size.kind == "hex20"
    wedges = np.array([numbers.wedge(face, quadratic) for face in inner])
    return Cap(np.array([*X, *numbers.fresh]), bricks, wedges)


class _Fan:
    """Nodes of the fan, each made once."""

    def __init__(self, X: FloatArray, z: float, thick: float) -> None:
        self._X, self._z, self._thick = X, z, thick
        self._known: dict[tuple[int, float], int] = {}
        self.fresh: list[FloatArray] = []

    def _spoke(self, rim: int, share: float, level: float) -> int:
        """Node on the way from the axis to a node of the rim; ``level`` from 0 to 1."""
        key = (rim if share else -1, level)
        if key not in self._known:
            self._known[key] = len(self._X) + len(self.fresh)
            x, y, _ = share * self._X[rim]
            self.fresh.append(np.array([x, y, self._z + level * self._thick]))
        return self._known[key]

    def wedge(self, face: IntArray, quadratic: bool) -> list[int]:
        """Give the nodes of the wedge between the axis and an inner face."""
        start, end, end_behind, start_behind = (int(n) for n in face[:4])
        nodes = [
            self._spoke(start, 0.0, 0.0), start, end,
            self._spoke(start, 0.0, 1.0), start_behind, end_behind,
        ]  # fmt: skip
        if quadratic:
            arc, end_between, arc_behind, start_between = (int(n) for n in face[4:])
            nodes += [self._spoke(start, 0.5, 0.0), arc, self._spoke(end, 0.5, 0.0)]
            nodes += [
                self._spoke(start_behind, 0.5, 1.0), arc_behind, self._spoke(end_behind, 0.5, 1.0),
                self._spoke(start, 0.0, 0.5), start_between, end_between,
            ]  # fmt: skip
        return nodes
