"""The smeared gauze as springs between neighbouring nodes of the outer surface.

Lines of springs run along every edge of the outer faces and, on 20-node bricks, through the middles
of the faces too. Each stands for the strip of the surface that is nearer to it than to the next
line, as far as the strip is covered: so the springs of a sector are together as stiff as the gauze
there, and its edge need not lie on the mesh.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from fem.arrays import FloatArray, IntArray
from fem.gauze import Threads
from fem.mesh import Mesh
from fem.weave import covered

# Nodes of a spring on an outer face, and its strip across it, from -1 to 1.
_Line = tuple[int, int, float, float]
_AXIAL: dict[str, tuple[_Line, ...]] = {
    "hex20": (
        (0, 7, -1.0, -0.5), (7, 3, -1.0, -0.5), (4, 6, -0.5, 0.5), (1, 5, 0.5, 1.0),
        (5, 2, 0.5, 1.0),
    ),
    "hex8": ((0, 3, -1.0, 0.0), (1, 2, 0.0, 1.0)),
}  # fmt: skip
_HOOP: dict[str, tuple[_Line, ...]] = {
    "hex20": (
        (0, 4, -1.0, -0.5), (4, 1, -1.0, -0.5), (7, 5, -0.5, 0.5), (3, 6, 0.5, 1.0),
        (6, 2, 0.5, 1.0),
    ),
    "hex8": ((0, 1, -1.0, 0.0), (3, 2, 0.0, 1.0)),
}  # fmt: skip


@dataclass(frozen=True)
class Springs:
    """Springs of one family of threads; they pull and never push.

    Attributes
    ----------
    nodes : (n, 2) int
    stiffness : (n,) N/mm
        Force over elongation: EA over the length at rest.
    length : (n,) mm
        At rest.
    """

    nodes: IntArray
    stiffness: FloatArray
    length: FloatArray


@dataclass(frozen=True)
class _Family:
    """Springs face by face: F faces, q springs each.

    Attributes
    ----------
    ends : (q, 2) int
        Among the nodes of a face.
    nodes : (F, q, 2) int
        Among the nodes of the mesh.
    length : (F, q) mm
    EA : (F, q) N
    """

    ends: IntArray
    nodes: IntArray
    length: FloatArray
    EA: FloatArray


def axial_springs(mesh: Mesh) -> Springs:
    """Give the springs for the axial threads, less those that are cut."""
    return _joined(mesh, _axial(mesh))


def hoop_springs(mesh: Mesh) -> Springs:
    """Give the springs for the hoop threads, none of which is cut."""
    return _joined(mesh, _hoop(mesh))


def with_springs(mesh: Mesh) -> Mesh:
    """Give our own mesh the same springs in place of its smeared gauze, to compare like with like.

    A spring is a thread point whose gradient takes the difference of two nodes.
    """
    return replace(mesh, axial=_threads(mesh, _axial(mesh)), hoop=_threads(mesh, _hoop(mesh)))


def _axial(mesh: Mesh) -> _Family:
    lines, a = _AXIAL[mesh.size.kind], mesh.actuator
    strips = [(low, high) for *_, low, high in lines]
    windows = [None if k % 2 == 0 else a.windows[k // 2] for k in mesh.segment.tolist()]
    share = {
        window: [
            [_overlap(strip, covered(a.gauze, start, end, window)) for strip in strips]
            for start, end in pairwise(mesh.columns)
        ]
        for window in dict.fromkeys(windows)
    }
    across = 0.5 * a.radius * np.diff(mesh.columns)[:, None]
    width = np.array([share[window] for window in windows]) * across
    return _family(mesh, lines, width.reshape(-1, len(lines)))


def _hoop(mesh: Mesh) -> _Family:
    lines = _HOOP[mesh.size.kind]
    share = np.array([high - low for *_, low, high in lines])
    width = np.repeat(0.5 * mesh.heights, mesh.around)[:, None] * share
    return _family(mesh, lines, width)


def _family(mesh: Mesh, lines: tuple[_Line, ...], width: FloatArray) -> _Family:
    ends = np.array([line[:2] for line in lines])
    first = np.arange(mesh.layers)[:, None, None, None] * (mesh.ring + mesh.mid)
    nodes = (first + mesh.outer[:, ends]).reshape(-1, len(lines), 2)
    X = mesh.X.reshape(-1, 3)[nodes]
    length = np.linalg.norm(X[..., 1, :] - X[..., 0, :], axis=-1)
    return _Family(ends, nodes, length, mesh.actuator.gauze.stiffness * width)


def _joined(mesh: Mesh, family: _Family) -> Springs:
    """Add up the springs of two faces on their border; leave out those that are cut."""
    kept = family.EA > 0.0
    low, high = family.nodes[kept].min(axis=1), family.nodes[kept].max(axis=1)
    pairs, first, which = np.unique(low * mesh.nodes + high, return_index=True, return_inverse=True)
    stiffness: FloatArray = np.bincount(
        which, (family.EA / family.length)[kept], minlength=len(pairs)
    ).astype(float)
    return Springs(np.column_stack([low, high])[first], stiffness, family.length[kept][first])


def _threads(mesh: Mesh, family: _Family) -> Threads:
    faces, count = family.EA.shape
    gradient = np.zeros((faces, count, mesh.outer.shape[1]))
    springs = np.arange(count)
    gradient[:, springs, family.ends[:, 0]] = -1.0 / family.length
    gradient[:, springs, family.ends[:, 1]] = 1.0 / family.length
    return Threads(gradient, family.EA * family.length)


def _overlap(strip: tuple[float, float], parts: list[tuple[float, float]]) -> float:
    """Length that a strip shares with the covered parts of a face, of the face's 2."""
    return sum(max(0.0, min(strip[1], b) - max(strip[0], a)) for a, b in parts)
