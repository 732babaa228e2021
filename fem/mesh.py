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
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fem.actuator import Actuator, Window
from fem.element import Kind, Reference, face_nodes, natural_nodes, reference, shape
from fem.gauze import Gauze, Threads

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

_GROWTH = 2.0
_HALF = np.pi


@dataclass(frozen=True)
class MeshSize:
    """How fine the mesh is; lengths in mm for a tube of 20 mm, others in proportion.

    Attributes
    ----------
    around : int
        Bricks in half of the circumference.
    edge, window, wrapped, end : float
        Height of a layer at a window's edge, at most in windows and in wrapped sectors, and at
        the clamped end and the plug. Heights double from one layer to the next.
    kind : {"hex20", "hex8"}
    through : int
        Bricks through the wall.
    orders : (int, int, int)
        Gauss points through the wall, around, along.
    mean_dilatation : bool
        Take the volume change from the brick's mean: the cure that 8-node bricks need.
    """

    around: int = 8
    edge: float = 0.5
    window: float = 2.5
    wrapped: float = 8.0
    end: float = 2.0
    kind: Kind = "hex20"
    through: int = 1
    orders: tuple[int, int, int] = (2, 3, 2)
    mean_dilatation: bool = False


DEFAULT_MESH = MeshSize()
# The paper's: 8-node bricks of 1 mm, two through the wall.
PAPER_MESH = MeshSize(31, 1.0, 1.0, 1.0, 1.0, "hex8", 2, (2, 2, 2), mean_dilatation=True)


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
    brick : tuple of Reference
        Of a brick of height 2 mm, one for each brick through the wall, inside first.
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


def make_mesh(actuator: Actuator, size: MeshSize = DEFAULT_MESH, whole: bool = False) -> Mesh:
    """Mesh an actuator: half of it where all sectors lie in one plane, unless ``whole``."""
    half = actuator.in_plane and not whole
    around = size.around if half else 2 * size.around
    places = _places(size, around, half)
    bricks = _bricks(places, size, around)
    m = face_nodes(size.kind)
    ring_at, mid_at = _xy(actuator, places.ring), _xy(actuator, places.mid)
    span = (_HALF if half else 2.0 * _HALF) / around
    z, segment = _stations(actuator, size)
    return Mesh(
        actuator=actuator,
        size=size,
        ring=len(ring_at),
        mid=len(mid_at),
        bricks=bricks,
        brick=tuple(
            reference(size.kind, _one_brick(actuator, size, span, n), size.orders)
            for n in range(size.through)
        ),
        outer=bricks[-around:, -m:],
        inner=bricks[:around, :m],
        fixed_ring=_symmetry(ring_at, half),
        fixed_mid=_symmetry(mid_at, half),
        half=half,
        outer_ring=np.flatnonzero([p[0] == 1.0 for p in places.ring]),
        **_along(actuator, size, z, segment, ring_at, mid_at, around, span),
    )


def remesh(mesh: Mesh, actuator: Actuator) -> Mesh:
    """Mesh a changed actuator with the same layers, stretched in proportion.

    The tube's section, the number of windows and the plane of symmetry must be the same.
    """
    edges = [edge for sector in actuator.wrapped for edge in sector]
    z = np.zeros_like(mesh.z)
    for k, (start, end) in enumerate(pairwise(edges)):
        own = np.flatnonzero(mesh.segment == k)
        if own.size:
            old = mesh.z[own[0] : own[-1] + 2]
            share = (old - old[0]) / (old[-1] - old[0])
            z[own[0] : own[-1] + 2] = start + share * (end - start)
    ring_at, mid_at = mesh.X[0, : mesh.ring, :2], mesh.X[0, mesh.ring :, :2]
    span = (_HALF if mesh.half else 2.0 * _HALF) / mesh.around
    changed = _along(actuator, mesh.size, z, mesh.segment, ring_at, mid_at, mesh.around, span)
    return replace(mesh, actuator=actuator, **changed)


def _along(
    actuator: Actuator,
    size: MeshSize,
    z: FloatArray,
    segment: IntArray,
    ring_at: FloatArray,
    mid_at: FloatArray,
    around: int,
    span: float,
) -> dict[str, Any]:
    """What of a mesh depends on the places along the tube, and on the sectors."""
    X = np.zeros((len(z), len(ring_at) + len(mid_at), 3))
    X[:, : len(ring_at), :2] = ring_at
    X[:, : len(ring_at), 2] = z[:, None]
    X[:-1, len(ring_at) :, :2] = mid_at
    X[:-1, len(ring_at) :, 2] = 0.5 * (z[1:] + z[:-1])[:, None]
    sectors = [actuator.windows[k // 2] if k % 2 else None for k in segment.tolist()]
    return {
        "z": z,
        "segment": segment,
        "X": X,
        "axial": _axial_threads(actuator, size, np.diff(z), sectors, around, span),
        "hoop": _hoop_threads(actuator, size, z, around, span),
    }


def start_angle() -> float:
    """Angular position where the first brick begins: the side that faces the object."""
    return -0.5 * np.pi


@dataclass(frozen=True)
class _Places:
    """Nodes of a ring and of a mid section as (share through the wall, phi), in order."""

    ring: list[tuple[float, float]]
    mid: list[tuple[float, float]]
    ring_index: dict[tuple[int, int], int]
    mid_index: dict[tuple[int, int], int]


def _places(size: MeshSize, around: int, half: bool) -> _Places:
    """Number the nodes of a section by their place on a grid of half bricks."""
    step = 1 if size.kind == "hex20" else 2
    deep, wide = 2 * size.through, 2 * around
    span = (_HALF if half else 2.0 * _HALF) / wide
    columns = wide + 1 if half else wide
    places = _Places([], [], {}, {})
    for j in range(0, columns, step):
        for i in range(0, deep + 1, step):
            where = (i / deep, start_angle() + j * span)
            if i % 2 == 0 or j % 2 == 0:
                places.ring_index[i, j] = len(places.ring)
                places.ring.append(where)
            if step == 1 and i % 2 == 0 and j % 2 == 0:
                places.mid_index[i, j] = len(places.mid)
                places.mid.append(where)
    return places


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


def _one_brick(actuator: Actuator, size: MeshSize, span: float, deep: int) -> FloatArray:
    """Nodes of a brick 2 mm high, ``deep`` bricks from the inside, its middle on +x."""
    natural = natural_nodes(size.kind).astype(float)
    share = (deep + 0.5 * (natural[:, 0] + 1.0)) / size.through
    r = actuator.radius - actuator.wall * (1.0 - share)
    phi = 0.5 * span * natural[:, 1]
    return np.column_stack([r * np.cos(phi), r * np.sin(phi), natural[:, 2]])


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
        heights = _graded(length, first * k, last * k, most * k)
        places = start + np.cumsum(heights)
        places[-1] = end
        z.extend(places.tolist())
        segment.extend([number] * len(heights))
    return np.array(z), np.array(segment)


def _graded(length: float, first: float, last: float, most: float) -> FloatArray:
    """Heights that grow from both ends, shrunk to fill the length."""
    left, right = list[float](), list[float]()
    a, b, total = min(first, most), min(last, most), 0.0
    while total < length * (1.0 - 1e-9):
        if a <= b:
            left.append(a)
            total += a
            a = min(_GROWTH * a, most)
        else:
            right.append(b)
            total += b
            b = min(_GROWTH * b, most)
    return np.array(left + right[::-1]) * (length / total)


def _face_gradient(size: MeshSize, eta: FloatArray, zeta: FloatArray) -> FloatArray:
    """Shape derivatives of an outer face by (eta, zeta): (..., n, 2)."""
    m = face_nodes(size.kind)
    nodes = natural_nodes(size.kind)[-m:, 1:]
    _, dN = shape(nodes, np.column_stack([eta.ravel(), zeta.ravel()]))
    return dN.reshape(*eta.shape, m, 2)


def _axial_threads(
    actuator: Actuator,
    size: MeshSize,
    heights: FloatArray,
    sectors: list[Window | None],
    around: int,
    span: float,
) -> Threads:
    gauze = actuator.gauze
    starts = start_angle() + span * np.arange(around)
    cache = {
        window: _lines(gauze, actuator.radius, starts, span, window, size)
        for window in {None, *sectors}
    }
    most = max(eta.shape[1] for eta, _ in cache.values())
    zeta, along = np.polynomial.legendre.leggauss(size.orders[2])
    gradient, weight = [], []
    for window, h in zip(sectors, heights, strict=True):
        eta, width = (np.pad(v, ((0, 0), (0, most - v.shape[1]))) for v in cache[window])
        shape_at = np.broadcast_to(eta[:, :, None], (*eta.shape, len(zeta)))
        dN = _face_gradient(size, shape_at, np.broadcast_to(zeta, shape_at.shape))
        gradient.append(dN[..., 1].reshape(around, -1, dN.shape[-2]) * (2.0 / h))
        weight.append((gauze.stiffness * width[:, :, None] * along * (0.5 * h)).reshape(around, -1))
    return Threads(np.concatenate(gradient), np.concatenate(weight))


def _lines(
    gauze: Gauze,
    radius: float,
    starts: FloatArray,
    span: float,
    window: Window | None,
    size: MeshSize,
) -> tuple[FloatArray, FloatArray]:
    """Where uncut axial threads cross each face of a layer: (eta, width in mm), each (around, q).

    The smeared gauze takes Gauss points within the covered part of each face, so that the edge
    of a sector need not lie on the mesh.
    """
    if gauze.pitch is not None:
        return _single_lines(gauze, radius, starts, span, window)
    points, w = np.polynomial.legendre.leggauss(size.orders[1])
    parts = np.array([_covered(gauze, start, span, window) for start in starts])
    a, b = parts[..., 0, None], parts[..., 1, None]
    eta = 0.5 * (a + b) + 0.5 * (b - a) * points
    width = 0.5 * (b - a) * w * (0.5 * span * radius)
    keep = (b - a)[..., 0].any(axis=0)
    keep[0] = True
    flat = (len(starts), -1)
    return eta[:, keep].reshape(flat), width[:, keep].reshape(flat)


def _covered(
    gauze: Gauze, start: float, span: float, window: Window | None
) -> list[tuple[float, float]]:
    """The covered parts of a face in eta, at most two."""
    if window is None:
        return [(-1.0, 1.0), (0.0, 0.0)]
    half = 0.5 * (window.alpha + gauze.allowance)
    parts = []
    for turn in (-2.0 * np.pi, 0.0, 2.0 * np.pi):
        middle = window.center - np.floor((window.center - start) / (2.0 * np.pi)) * 2.0 * np.pi
        low = max(middle + turn - half, start)
        high = min(middle + turn + half, start + span)
        if high > low:
            parts.append((2.0 * (low - start) / span - 1.0, 2.0 * (high - start) / span - 1.0))
    return (parts + [(0.0, 0.0)] * 2)[:2]


def _single_lines(
    gauze: Gauze, radius: float, starts: FloatArray, span: float, window: Window | None
) -> tuple[FloatArray, FloatArray]:
    """Single threads at the pitch, the first one facing the object."""
    assert gauze.pitch is not None
    count = max(4, round(2.0 * np.pi * radius / gauze.pitch))
    step = 2.0 * np.pi / count
    rows = []
    for start in starts:
        row = []
        for k in range(count + 1):
            phi = start_angle() + k * step
            eta = 2.0 * (phi - start) / span - 1.0
            if not -1.0 - 1e-9 <= eta <= 1.0 + 1e-9:
                continue
            # A thread on the border of two faces counts half in each.
            share = 0.5 if abs(abs(eta) - 1.0) < 1e-9 else 1.0
            if window is not None:
                off = (phi - window.center + np.pi) % (2.0 * np.pi) - np.pi
                if abs(off) > 0.5 * (window.alpha + gauze.allowance) + 1e-9:
                    continue
            row.append((float(np.clip(eta, -1.0, 1.0)), share * step * radius))
        rows.append(row)
    most = max(1, *(len(row) for row in rows))
    table = np.array([row + [(0.0, 0.0)] * (most - len(row)) for row in rows])
    return table[..., 0], table[..., 1]


def _hoop_threads(
    actuator: Actuator, size: MeshSize, z: FloatArray, around: int, span: float
) -> Threads:
    gauze, heights = actuator.gauze, np.diff(z)
    rule, w = np.polynomial.legendre.leggauss(size.orders[2])
    zeta = np.broadcast_to(rule, (len(heights), len(rule)))
    width = 0.5 * heights[:, None] * w
    if gauze.pitch is not None:
        zeta, width = _single_rings(gauze.pitch, z)
    eta, around_w = np.polynomial.legendre.leggauss(size.orders[1])
    shape_at = (len(heights), zeta.shape[1], len(eta))
    dN = _face_gradient(
        size, np.broadcast_to(eta, shape_at), np.broadcast_to(zeta[:, :, None], shape_at)
    )
    arc = 0.5 * span * actuator.radius
    gradient = dN[..., 0].reshape(len(heights), 1, -1, dN.shape[-2])
    # The face is a parabola, not quite an arc: along the thread by its own speed.
    speed = np.linalg.norm(gradient @ _face_positions(actuator, size, span), axis=-1)
    gradient = gradient / speed[..., None]
    weight = gauze.stiffness * (width[:, :, None] * around_w * arc).reshape(len(heights), 1, -1)
    ones = np.ones((1, around, 1))
    return Threads(
        (gradient * ones[..., None]).reshape(-1, *gradient.shape[2:]),
        (weight * (speed / arc) * ones).reshape(len(heights) * around, -1),
    )


def _face_positions(actuator: Actuator, size: MeshSize, span: float) -> FloatArray:
    brick = _one_brick(actuator, size, span, size.through - 1)[-face_nodes(size.kind) :]
    flat: FloatArray = brick * [1.0, 1.0, 0.0]
    return flat


def _single_rings(pitch: float, z: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Hoop threads at the pitch: (zeta, width), each (layers, q)."""
    places = (np.arange(np.ceil(z[-1] / pitch)) + 0.5) * pitch
    rows = []
    for low, high in pairwise(z.tolist()):
        inside = places[(places >= low) & (places < high)]
        rows.append([(2.0 * (p - low) / (high - low) - 1.0, pitch) for p in inside])
    most = max(1, *(len(row) for row in rows))
    table = np.array([row + [(0.0, 0.0)] * (most - len(row)) for row in rows])
    return table[..., 0], table[..., 1]
