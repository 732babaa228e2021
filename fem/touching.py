"""Overlap of a tube with itself: its outer surface as rings, where they cross, and how deep.

The surface, closed at both ends, is cut into slabs between rings. Two slabs that a plane separates
cannot cross, and nearly all pairs are separated by the plane of some section; the triangles of the
others are intersected. So nothing is taken for a neighbour by its place along the tube: only
slabs that share a ring are never compared.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fem.arrays import FloatArray, IntArray
from fem.element import face_nodes, natural_nodes, shape
from fem.mesh import Mesh

_SPACING = 1.0 / 16.0  # of the diameter, from ring to ring
_SPAN = np.radians(9.0)  # from point to point of a ring: a chord is 0.3 % of the radius off
_CAP = (0.02, 0.17, 0.34, 0.5, 0.67, 0.84)  # radii of the rings in a closed end
_LEAST = 0.01  # mm: said of surfaces that cross by less than can be measured
_BATCH = 32  # pairs of slabs at a time
_GROWN = 3  # slabs beside those that may cross, among which the way out is looked for


def outer_rings(mesh: Mesh, x: FloatArray) -> FloatArray:
    """Points of the outer surface at even places along the tube, plug included.

    Parameters
    ----------
    mesh : Mesh
    x : (layers + 1, ring + mid, 3) mm
        Nodal positions.

    Returns
    -------
    (S, n, 3) mm, rings of the whole tube, also where half of it is modelled
    """
    actuator = mesh.actuator
    count = int(np.ceil(actuator.free_length / (_SPACING * actuator.diameter)))
    along = np.linspace(0.0, mesh.z[-1], count + 1)
    layer = np.clip(np.searchsorted(mesh.z, along, side="right") - 1, 0, mesh.layers - 1)
    zeta = 2.0 * (along - mesh.z[layer]) / mesh.heights[layer] - 1.0
    kind = mesh.size.kind
    face = natural_nodes(kind)[-face_nodes(kind) :, 1:]
    first = layer[:, None] * (mesh.ring + mesh.mid)
    parts = []
    for nodes, span in zip(mesh.outer, np.diff(mesh.columns), strict=True):
        cuts = int(np.ceil(span / _SPAN))
        eta = np.linspace(-1.0, 1.0, cuts + 1)[: -1 if nodes is not mesh.outer[-1] else None]
        N, _ = shape(
            face, np.stack(np.broadcast_arrays(eta, zeta[:, None]), axis=-1).reshape(-1, 2)
        )
        weights = N.reshape(len(zeta), -1, len(nodes))
        parts.append(weights @ x.reshape(-1, 3)[first + nodes])
    rings = np.concatenate(parts, axis=1)
    if mesh.half:
        rings = np.concatenate([rings, rings[:, -2:0:-1] * [-1.0, 1.0, 1.0]], axis=1)
    else:
        rings = rings[:, :-1]
    plug = actuator.plug * _plane(rings[-1:])
    return np.concatenate([rings, rings[-1:] + plug[:, None]]) if actuator.plug else rings


def overlap(rings: FloatArray) -> float:
    """Depth to which a tube runs into itself, mm; 0 where it does not.

    Parameters
    ----------
    rings : (S, n, 3) mm
        Points of its surface from end to end, in the same order around in each ring.

    Returns
    -------
    float
        Depth of the deepest point of the surface below another stretch of it; `_LEAST` at least
        where they cross. As a point deep within a tube is nearer to the other side, it does not
        exceed the radius.
    """
    tube = np.concatenate([_cap(rings[0]), rings, _cap(rings[-1])[::-1]])
    close = np.triu(~_apart(tube, rings), 2)
    if not close.any():
        return 0.0
    from scipy.ndimage import label  # slow to load, and seldom needed

    places, count = label(close, np.ones((3, 3)))
    found = (np.argwhere(places == place) for place in range(1, count + 1))
    # Only slabs beside others that cross: elsewhere they are close, and no more.
    crossing = [pairs for pairs in found if _cross(tube, pairs)]
    return max(_depth(tube, np.concatenate(crossing)), _LEAST) if crossing else 0.0


def _cap(ring: FloatArray) -> FloatArray:
    """Rings of a closed end, from its middle outward: (caps, n, 3)."""
    middle = ring.mean(axis=0)
    closed: FloatArray = middle + np.array(_CAP)[:, None, None] * (ring - middle)
    return closed


def _plane(rings: FloatArray) -> FloatArray:
    """Give the unit normals of rings' planes: (S, 3)."""
    arm = rings - rings.mean(axis=1, keepdims=True)
    area = np.cross(arm, np.roll(arm, -1, axis=1)).sum(axis=1)
    normal: FloatArray = area / np.linalg.norm(area, axis=1, keepdims=True)
    return normal


def _apart(tube: FloatArray, rings: FloatArray) -> NDArray[np.bool_]:
    """Whether a plane separates two slabs: (slabs, slabs).

    The planes are those of sections, and 13 of fixed directions.
    """
    grid = np.stack(np.meshgrid(*[[-1.0, 0.0, 1.0]] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    directions = np.concatenate([_plane(rings), grid[14:]])
    seen = tube @ directions.T
    low, high = seen.min(axis=1), seen.max(axis=1)
    low, high = np.minimum(low[:-1], low[1:]).T, np.maximum(high[:-1], high[1:]).T
    slack = 1e-9 * np.ptp(seen)
    apart = np.zeros((len(tube) - 1,) * 2, dtype=bool)
    for least, most in zip(low, high, strict=True):
        apart |= most[:, None] <= least + slack
    return apart | apart.T


def _triangles(tube: FloatArray, slabs: IntArray) -> FloatArray:
    """Triangles of slabs: (P, 2 n, 3, 3), mm."""
    a, b = tube[slabs], tube[slabs + 1]
    c, d = np.roll(a, -1, axis=1), np.roll(b, -1, axis=1)
    return np.concatenate([np.stack([a, c, b], axis=2), np.stack([d, b, c], axis=2)], axis=1)


def _cross(tube: FloatArray, pairs: IntArray) -> bool:
    """Whether the triangles of any pair of slabs (P, 2) intersect."""
    for start in range(0, len(pairs), _BATCH):
        one, other = (_triangles(tube, pairs[start : start + _BATCH, k]) for k in (0, 1))
        near = np.ones((len(one), one.shape[1], other.shape[1]), dtype=bool)
        for axis in range(3):
            a, b = one[..., axis], other[..., axis]
            near &= a.min(axis=2)[:, :, None] <= b.max(axis=2)[:, None]
            near &= b.min(axis=2)[:, None] <= a.max(axis=2)[:, :, None]
        p, i, j = np.nonzero(near)
        first, second = one[p, i], other[p, j]
        if (_pierce(first, second) | _pierce(second, first)).any():
            return True
    return False


def _pierce(edges: FloatArray, faces: FloatArray) -> NDArray[np.bool_]:
    """Whether an edge of a triangle passes through another: (Q,) for (Q, 3, 3) and (Q, 3, 3)."""
    start, way = edges, np.roll(edges, -1, axis=1) - edges
    u, v = (faces[:, k] - faces[:, 0] for k in (1, 2))
    normal = np.cross(u, v)[:, None]
    steep = -(way * normal).sum(axis=-1)
    arm = start - faces[:, :1]
    across = np.cross(arm, way)
    scale = np.where(steep == 0.0, np.inf, steep)
    t = (arm * normal).sum(axis=-1) / scale
    s = (v[:, None] * across).sum(axis=-1) / scale
    r = -(u[:, None] * across).sum(axis=-1) / scale
    inside = (t >= 0.0) & (t <= 1.0) & (s >= 0.0) & (r >= 0.0) & (s + r <= 1.0) & (steep != 0.0)
    return np.asarray(inside.any(axis=1))


def _depth(tube: FloatArray, pairs: IntArray) -> float:
    """Depth of the deepest point below the surface of slabs that it may cross, mm."""
    from scipy.spatial import cKDTree  # a third of the package's import time

    normals = _outward(tube)
    slabs, deepest = len(tube) - 1, 0.0
    edge = max(np.linalg.norm(np.diff(tube, axis=0), axis=2).max(),
               np.linalg.norm(np.diff(tube, axis=1), axis=2).max())  # fmt: skip
    both = np.concatenate([pairs, pairs[:, ::-1]])
    for slab in np.unique(both[:, 0]):
        others = both[both[:, 0] == slab, 1]
        near = np.unique(np.clip(others[:, None] + np.arange(-_GROWN, _GROWN + 1), 0, slabs - 1))
        near = near[np.abs(near - slab) > 1]
        rings = np.unique(np.concatenate([near, near + 1]))
        rings = rings[(rings < slab) | (rings > slab + 1)]
        there, points = tube[rings].reshape(-1, 3), tube[slab : slab + 2].reshape(-1, 3)
        _, at = cKDTree(there).query(points)
        gap = there[at] - points
        below = np.min([(gap * n[rings].reshape(-1, 3)[at]).sum(axis=1) for n in normals], axis=0)
        beside = np.sqrt(np.maximum((gap**2).sum(axis=1) - below**2, 0.0))
        deepest = max(deepest, float(below[beside <= edge].max(initial=0.0)))
    return deepest


def _outward(tube: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Outward unit normals at the points of rings, of the slabs before and behind: (S, n, 3) each.

    At the edge of a closed end they differ: a point is below it only where it is below both.
    """
    around = np.roll(tube, -1, axis=1) - np.roll(tube, 1, axis=1)
    along = np.diff(tube, axis=0)
    normals = []
    for step in (along[[0, *range(len(along))]], along[[*range(len(along)), -1]]):
        normal = np.cross(around, step)
        normals.append(normal / np.maximum(np.linalg.norm(normal, axis=2, keepdims=True), 1e-300))
    arm = tube - tube.mean(axis=1, keepdims=True)
    turned = np.sign(sum((normal * arm).sum() for normal in normals))
    return normals[0] * turned, normals[1] * turned
