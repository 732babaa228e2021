"""The mesh: layers of bricks between rings, all alike but for their height.

Every layer has the same nodes (its ring, the nodes half-way, the next ring) and the same bricks,
each a turned copy of one brick that is stretched along z. So one set of shape gradients serves
the whole tube, and one pattern of couplings every layer.

Node arrays have one row a section: (layers + 1, ring + mid, 3); the mid nodes of the last row
do not exist and stay zero.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise
from typing import TypedDict

import numpy as np
from numpy.typing import NDArray

from fem.actuator import Actuator
from fem.element import Reference, face_nodes, natural_nodes, reference
from fem.gauze import Threads
from fem.meshsize import DEFAULT_MESH, MeshSize, one_brick, start_angle
from fem.weave import axial_threads, hoop_threads

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

_GIVE = 0.1  # how much sizes may be stretched to fill a length
_SHRINK = 0.7  # of a layer's height: the most that a changed length takes off
_HALF = np.pi


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
    places = _places(size, columns, half)
    bricks = _bricks(places, size, around)
    m = face_nodes(size.kind)
    ring_at, mid_at = _xy(actuator, places.ring), _xy(actuator, places.mid)
    z, segment = _stations(actuator, size) if like is None else _stretched(like, actuator)
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
        fixed_ring=_symmetry(ring_at, half),
        fixed_mid=_symmetry(mid_at, half),
        half=half,
        outer_ring=np.flatnonzero([p[0] == 1.0 for p in places.ring]),
        z=z,
        segment=segment,
        X=_positions(z, ring_at, mid_at),
        **_woven(actuator, size, z, segment, columns),
    )


def remesh(mesh: Mesh, actuator: Actuator, *, gauze: bool = True) -> Mesh:
    """Mesh a changed actuator with the same layers, stretched, and the same columns.

    The tube's section, the number of windows and the plane of symmetry must be the same. Without
    the ``gauze`` the threads stay as they were, for readings of lines and angles alone.
    """
    z, _ = _stretched(mesh, actuator)
    X = _positions(z, mesh.X[0, : mesh.ring, :2], mesh.X[0, mesh.ring :, :2])
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


def _stretched(mesh: Mesh, actuator: Actuator) -> tuple[FloatArray, IntArray]:
    """Stations of a mesh, stretched for a changed actuator.

    High layers give way and low ones keep their heights, as long as that leaves something of
    them: next to a cut's edge the tube is deformed as it was, however long its sectors are.
    """
    edges = [edge for sector in actuator.wrapped for edge in sector]
    z = np.zeros_like(mesh.z)
    for k, (start, end) in enumerate(pairwise(edges)):
        own = np.flatnonzero(mesh.segment == k)
        if own.size:
            h = mesh.heights[own]
            share = h * ((end - start) - h.sum()) / float(h @ h)
            if share.min() < -_SHRINK:
                share = np.full(len(h), (end - start) / h.sum() - 1.0)
            z[own[0] + 1 : own[-1] + 2] = start + np.cumsum(h * (1.0 + share))
    return z, mesh.segment


def _positions(z: FloatArray, ring_at: FloatArray, mid_at: FloatArray) -> FloatArray:
    """Nodes at rest, of rings at z and of the mid sections between them."""
    X = np.zeros((len(z), len(ring_at) + len(mid_at), 3))
    X[:, : len(ring_at), :2] = ring_at
    X[:, : len(ring_at), 2] = z[:, None]
    X[:-1, len(ring_at) :, :2] = mid_at
    X[:-1, len(ring_at) :, 2] = 0.5 * (z[1:] + z[:-1])[:, None]
    return X


class _Woven(TypedDict):
    """Both families of threads, under their names in a `Mesh`."""

    axial: Threads
    hoop: Threads


def _woven(
    actuator: Actuator, size: MeshSize, z: FloatArray, segment: IntArray, columns: FloatArray
) -> _Woven:
    sectors = [actuator.windows[k // 2] if k % 2 else None for k in segment.tolist()]
    return {
        "axial": axial_threads(actuator, size, np.diff(z), sectors, columns),
        "hoop": hoop_threads(actuator, size, z, columns),
    }


@dataclass(frozen=True)
class _Places:
    """Nodes of a ring and of a mid section as (share through the wall, phi), in order."""

    ring: list[tuple[float, float]]
    mid: list[tuple[float, float]]
    ring_index: dict[tuple[int, int], int]
    mid_index: dict[tuple[int, int], int]


def _places(size: MeshSize, columns: FloatArray, half: bool) -> _Places:
    """Put the nodes of a section in order, known by their place on a grid of half bricks."""
    step = 1 if size.kind == "hex20" else 2
    deep = 2 * size.through
    phi = np.interp(np.arange(0.0, len(columns) - 0.75, 0.5), np.arange(len(columns)), columns)
    places = _Places([], [], {}, {})
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


def make_columns(actuator: Actuator, size: MeshSize, half: bool) -> FloatArray:
    """Cut the circumference into bricks that end where the uncut sectors do.

    Across such an edge the strain has a kink, and at the corners of the cut it is singular:
    bricks that end there and are narrow beside it are worth twice their number elsewhere. Edges
    nearer to each other than such a brick, or to the plane of symmetry, share a cut.

    Returns
    -------
    (around + 1,) rad, from the side that faces the object
    """
    whole = _HALF if half else 2.0 * _HALF
    widest = _HALF / size.around
    if size.beside == 0.0:
        return start_angle() + np.linspace(0.0, whole, round(whole / widest) + 1)
    edges = []
    for window in actuator.windows:
        reach = 0.5 * (window.alpha + actuator.gauze.allowance)
        for edge in (window.center - reach, window.center + reach):
            turn = (edge - start_angle()) % (2.0 * _HALF)
            edges.append(min(turn, 2.0 * _HALF - turn) if half else turn)
    cuts = _merged(sorted(edges), size.beside, whole)
    ends = [0.0, *cuts, whole]
    heights = [
        _graded(
            b - a,
            size.beside if k > 0 else widest,
            size.beside if k < len(cuts) else widest,
            widest,
            growth=2.0,
        )
        for k, (a, b) in enumerate(pairwise(ends))
    ]
    columns = np.concatenate([[0.0], np.cumsum(np.concatenate(heights))])
    columns[-1] = whole
    return start_angle() + columns


def _merged(edges: list[float], apart: float, whole: float) -> list[float]:
    """Give one place for all edges that lie within ``apart``, none that near to the ends."""
    groups: list[list[float]] = []
    for edge in edges:
        if groups and edge - groups[-1][0] <= apart:
            groups[-1].append(edge)
        else:
            groups.append([edge])
    middles = [sum(group) / len(group) for group in groups]
    return [m for m in middles if 0.5 * apart < m < whole - 0.5 * apart]


def _bricks(places: _Places, size: MeshSize, around: int) -> IntArray:
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


def _xy(actuator: Actuator, places: list[tuple[float, float]]) -> FloatArray:
    share, phi = np.array(places).reshape(-1, 2).T
    r = actuator.radius - actuator.wall * (1.0 - share)
    xy: FloatArray = np.column_stack([r * np.cos(phi), r * np.sin(phi)])
    return xy


def _symmetry(xy: FloatArray, half: bool) -> NDArray[np.bool_]:
    fixed = np.zeros((len(xy), 3), dtype=bool)
    if half:
        fixed[:, 0] = np.abs(xy[:, 0]) < 1e-9 * np.abs(xy).max(initial=1.0)
    return fixed


def _stations(actuator: Actuator, size: MeshSize) -> tuple[FloatArray, IntArray]:
    """Places of the rings, and the segment of each layer."""
    k = actuator.diameter / 20.0
    z, segment = [0.0], list[int]()
    edges = [edge for sector in actuator.wrapped for edge in sector]
    for number, (start, end) in enumerate(pairwise(edges)):
        length = end - start
        if length < 1e-9 * actuator.length:
            continue  # a window right at the clamped end or at the plug
        first = size.end if number == 0 else size.edge
        last = size.end if number == len(edges) - 2 else size.edge
        most = size.window if number % 2 else size.wrapped
        heights = _graded(length, first * k, last * k, most * k, size.growth)
        places = start + np.cumsum(heights)
        places[-1] = end
        z.extend(places.tolist())
        segment.extend([number] * len(heights))
    return np.array(z), np.array(segment)


def _graded(length: float, first: float, last: float, most: float, growth: float) -> FloatArray:
    """Sizes that grow from both ends, shrunk or a little stretched to fill the length."""
    left, right = list[float](), list[float]()
    a, b, total = min(first, most), min(last, most), 0.0
    while total * (1.0 + _GIVE) < length * (1.0 - 1e-9):
        if a <= b:
            left.append(a)
            total += a
            a = min(growth * a, most)
        else:
            right.append(b)
            total += b
            b = min(growth * b, most)
    return np.array(left + right[::-1]) * (length / total)
