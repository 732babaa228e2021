"""The mesh: layers of bricks between rings, all alike but for their height.

Every layer has the same nodes (its ring, the nodes half-way, the next ring) and the same bricks,
each a turned copy of one brick that is stretched along z. So one set of shape gradients serves
the whole tube, and one pattern of couplings every layer.

Node arrays have one row a section: (layers + 1, ring + mid, 3); the mid nodes of the last row
do not exist and stay zero.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TypedDict

import numpy as np
from numpy.typing import NDArray

from fem.actuator import Actuator
from fem.arrays import FloatArray, IntArray
from fem.element import Reference, face_nodes, reference
from fem.gauze import Threads
from fem.layer import across, layer_bricks, number_nodes, positions, symmetry
from fem.meshlines import make_columns, stations, stretched
from fem.meshsize import DEFAULT_MESH, MeshSize, one_brick
from fem.weave import axial_threads, hoop_threads


@dataclass(frozen=True)
class Mesh:
    """The mesh of an actuator.

    Attributes
    ----------
    actuator : Actuator
    size : MeshSize
    z : (layers + 1,)
        Places of the rings along the tube, mm.
    segment : (layers,) int
        Which stretch of the tube a layer lies in: 2 k for wrapped sector k, 2 k + 1 for window k.
    X : (layers + 1, ring + mid, 3)
        Node positions at rest.
    ring, mid : int
        Nodes of a ring, and half-way in a layer.
    bricks : (through * around, n)
        Nodes of a layer's bricks among [ring, mid, next ring]; the outermost brick last.
    columns : (around + 1,) rad
        Where the bricks around begin and end, from the side that faces the object.
    brick : tuple of Reference
        Of the bricks around, 2 mm high, one for each brick through the wall, inside first.
    outer, inner : (around, m)
        Nodes of a layer's outer and inner faces.
    fixed_ring, fixed_mid : (ring, 3), (mid, 3) bool
        What the plane of symmetry holds.
    half : bool
        Whether only x >= 0 is modelled.
    axial, hoop : Threads
        Of all outer faces: E = layers * around.
    outer_ring : (k,)
        Nodes of a ring on the outer surface.
    """

    actuator: Actuator
    size: MeshSize
    z: FloatArray
    segment: IntArray
    X: FloatArray
    ring: int
    mid: int
    bricks: IntArray
    columns: FloatArray
    brick: tuple[Reference, ...]
    outer: IntArray
    inner: IntArray
    fixed_ring: NDArray[np.bool_]
    fixed_mid: NDArray[np.bool_]
    half: bool
    axial: Threads
    hoop: Threads
    outer_ring: IntArray

    @property
    def layers(self) -> int:
        """How many layers there are."""
        return len(self.z) - 1

    @property
    def around(self) -> int:
        """How many bricks a layer has around."""
        return len(self.outer)

    @property
    def heights(self) -> FloatArray:
        """Height of each layer, mm."""
        return np.diff(self.z)

    @property
    def nodes(self) -> int:
        """How many nodes there are."""
        return (self.layers + 1) * self.ring + self.layers * self.mid

    @property
    def elements(self) -> int:
        """How many bricks there are."""
        return self.layers * len(self.bricks)


def make_mesh(
    actuator: Actuator,
    size: MeshSize = DEFAULT_MESH,
    whole: bool = False,
    like: Mesh | None = None,
) -> Mesh:
    """Mesh an actuator: half of it where all sectors lie in one plane, unless ``whole``.

    With the layers of another mesh (``like``), stretched, where one is given; its
    actuator must have as many windows.
    """
    half = actuator.in_plane and not whole
    columns = make_columns(actuator, size, half)
    around = len(columns) - 1
    places = number_nodes(size, columns, half)
    bricks = layer_bricks(places, size, around)
    m = face_nodes(size.kind)
    ring_at, mid_at = across(actuator, places.ring), across(actuator, places.mid)
    if like is None:
        z, segment = stations(actuator, size)
    else:
        z, segment = stretched(like.z, like.segment, actuator), like.segment
    return Mesh(
        actuator=actuator,
        size=size,
        ring=len(ring_at),
        mid=len(mid_at),
        bricks=bricks,
        columns=columns,
        brick=tuple(
            reference(
                size.kind,
                [one_brick(actuator, size, span, n) for span in np.diff(columns)],
                size.orders,
            )
            for n in range(size.through)
        ),
        outer=bricks[-around:, -m:],
        inner=bricks[:around, :m],
        fixed_ring=symmetry(ring_at, half),
        fixed_mid=symmetry(mid_at, half),
        half=half,
        outer_ring=np.flatnonzero([p[0] == 1.0 for p in places.ring]),
        z=z,
        segment=segment,
        X=positions(z, ring_at, mid_at),
        **_woven(actuator, size, z, segment, columns),
    )


def remesh(mesh: Mesh, actuator: Actuator, *, gauze: bool = True) -> Mesh:
    """Mesh a changed actuator with the same layers, stretched, and the same columns.

    The tube's section, the number of windows and the plane of symmetry must be the same. Without
    the ``gauze`` the threads stay as they were, for readings of lines and angles alone.
    """
    z = stretched(mesh.z, mesh.segment, actuator)
    X = positions(z, mesh.X[0, : mesh.ring, :2], mesh.X[0, mesh.ring :, :2])
    changed = replace(mesh, actuator=actuator, z=z, X=X)
    if not gauze:
        return changed
    return replace(changed, **_woven(actuator, mesh.size, z, mesh.segment, mesh.columns))


def alike(a: Mesh, b: Mesh) -> bool:
    """Whether every node of one mesh stands for the same place as in the other, or nearly."""
    if a.X.shape != b.X.shape or a.columns.shape != b.columns.shape:
        return False
    narrowest = np.diff(a.columns).min()
    return bool(np.abs(a.columns - b.columns).max() < 0.5 * narrowest)


class _Woven(TypedDict):
    """Both families of threads, under their names in a `Mesh`."""

    axial: Threads
    hoop: Threads


def _woven(
    actuator: Actuator, size: MeshSize, z: FloatArray, segment: IntArray, columns: FloatArray
) -> _Woven:
    return {
        "axial": axial_threads(actuator, size, np.diff(z), segment, columns),
        "hoop": hoop_threads(actuator, size, z, columns),
    }
