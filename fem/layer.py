"""One layer of the mesh, which all others are like: its nodes and the bricks among them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fem.actuator import Actuator
from fem.arrays import FloatArray, IntArray
from fem.element import natural_nodes
from fem.meshsize import MeshSize


@dataclass(frozen=True)
class Places:
    """Nodes of a ring and of a mid section as (share through the wall, phi), in order."""

    ring: list[tuple[float, float]]
    mid: list[tuple[float, float]]
    ring_index: dict[tuple[int, int], int]
    mid_index: dict[tuple[int, int], int]


def number_nodes(size: MeshSize, columns: FloatArray, half: bool) -> Places:
    """Put the nodes of a section in order, known by their place on a grid of half bricks."""
    step = 1 if size.kind == "hex20" else 2
    deep = 2 * size.through
    phi = np.interp(np.arange(0.0, len(columns) - 0.75, 0.5), np.arange(len(columns)), columns)
    places = Places([], [], {}, {})
    for j in range(0, len(phi) if half else len(phi) - 1, step):
        for i in range(0, deep + 1, step):
            where = (i / deep, float(phi[j]))
            if i % 2 == 0 or j % 2 == 0:
                places.ring_index[i, j] = len(places.ring)
                places.ring.append(where)
            if step == 1 and i % 2 == 0 and j % 2 == 0:
                places.mid_index[i, j] = len(places.mid)
                places.mid.append(where)
    return places


def layer_bricks(places: Places, size: MeshSize, around: int) -> IntArray:
    """Nodes of a layer's bricks among [ring, mid, next ring], (through * around, n)."""
    ring, mid = len(places.ring), len(places.mid)
    wide = max(j for _, j in places.ring_index) + (1 if size.kind == "hex20" else 2)
    rows = []
    for layer in range(size.through):
        for k in range(around):
            row = []
            for xi, eta, zeta in natural_nodes(size.kind):
                at = (2 * layer + 1 + xi, (2 * k + 1 + eta) % wide)
                if zeta == 0:
                    row.append(ring + places.mid_index[at])
                else:
                    row.append(places.ring_index[at] + (ring + mid if zeta > 0 else 0))
            rows.append(row)
    return np.array(rows)


def across(actuator: Actuator, places: list[tuple[float, float]]) -> FloatArray:
    """Places in a section as (x, y), (n, 2) mm."""
    share, phi = np.array(places).reshape(-1, 2).T
    r = actuator.radius - actuator.wall * (1.0 - share)
    xy: FloatArray = np.column_stack([r * np.cos(phi), r * np.sin(phi)])
    return xy


def symmetry(xy: FloatArray, half: bool) -> NDArray[np.bool_]:
    """Coordinates (n, 3) of a section's nodes that the plane of symmetry holds."""
    fixed = np.zeros((len(xy), 3), dtype=bool)
    if half:
        fixed[:, 0] = np.abs(xy[:, 0]) < 1e-9 * np.abs(xy).max(initial=1.0)
    return fixed


def positions(z: FloatArray, ring_at: FloatArray, mid_at: FloatArray) -> FloatArray:
    """Nodes at rest of rings at z and of mid sections between them: (layers + 1, ring + mid, 3)."""
    X = np.zeros((len(z), len(ring_at) + len(mid_at), 3))
    X[:, : len(ring_at), :2] = ring_at
    X[:, : len(ring_at), 2] = z[:, None]
    X[:-1, len(ring_at) :, :2] = mid_at
    X[:-1, len(ring_at) :, 2] = 0.5 * (z[1:] + z[:-1])[:, None]
    return X
