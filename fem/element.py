"""Bricks with 20 and 8 nodes, their faces, and Gauss points.

A brick has natural coordinates xi (through the wall, outward), eta (around), zeta (along the
tube), each from -1 to 1. Its nodes are ordered so that the inner face (xi = -1) comes first and
the outer face (xi = 1) last.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, cached_property
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fem.arrays import SINGLE, FloatArray

Kind = Literal["hex20", "hex8"]

# Faces in (eta, zeta): corners, then mid-sides.
_FACE4 = ((-1, -1), (1, -1), (1, 1), (-1, 1))
_FACE8 = (*_FACE4, (0, -1), (1, 0), (0, 1), (-1, 0))


def natural_nodes(kind: Kind) -> NDArray[np.int64]:
    """Natural coordinates of the nodes: (n, 3) of -1, 0, 1."""
    face = _FACE8 if kind == "hex20" else _FACE4
    middle = _FACE4 if kind == "hex20" else ()
    rows = [(-1, *f) for f in face] + [(0, *f) for f in middle] + [(1, *f) for f in face]
    return np.array(rows)


def face_nodes(kind: Kind) -> int:
    """How many nodes the inner and the outer face have."""
    return 8 if kind == "hex20" else 4


def shape(nodes: NDArray[np.int64], at: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Serendipity shape functions with nodes at corners and, where there are any, mid-edges.

    Parameters
    ----------
    nodes : (n, d) int
        Natural coordinates; a zero marks the middle of an edge.
    at : (q, d)
        Points.

    Returns
    -------
    N : (q, n)
    dN : (q, n, d)
        Derivatives by the natural coordinates.
    """
    points = np.atleast_2d(np.asarray(at, dtype=float))[:, None, :]
    quadratic = bool((nodes == 0).any())
    middle = nodes == 0
    # One factor a coordinate: 1 + node*x at a corner, 1 - x^2 along the edge of a mid-side node.
    factor = np.where(middle, 1.0 - points**2, 0.5 * (1.0 + nodes * points))
    slope = np.where(middle, -2.0 * points, 0.5 * nodes * np.ones_like(points))
    d = nodes.shape[1]
    N = factor.prod(axis=2)
    dN = np.stack(
        [slope[..., k] * np.delete(factor, k, axis=2).prod(axis=2) for k in range(d)], axis=2
    )
    if quadratic:
        corner = ~middle.any(axis=1)
        extra = (nodes * points).sum(axis=2) - (d - 1.0)
        dN = np.where(corner[:, None], dN * extra[..., None] + N[..., None] * nodes, dN)
        N = np.where(corner, N * extra, N)
    return N, dN


def gauss(orders: tuple[int, ...]) -> tuple[FloatArray, FloatArray]:
    """Tensor Gauss points (q, d) and weights (q,) on [-1, 1]^d, the last coordinate fastest."""
    rules = [np.polynomial.legendre.leggauss(n) for n in orders]
    points = np.stack(np.meshgrid(*[r[0] for r in rules], indexing="ij"), axis=-1)
    weights = np.ones(1)
    for _, w in rules:
        weights = np.outer(weights, w).ravel()
    return points.reshape(-1, len(orders)), weights


@dataclass(frozen=True)
class Reference:
    """Shape gradients and weights at the Gauss points of bricks at rest; c bricks.

    Attributes
    ----------
    dN : (c, 3 q, n)
        By the reference coordinates, coordinate-major: row ``j * q + point``, 1/mm.
    weights : (c, q)
        Reference volume of each point, mm^3.
    """

    dN: FloatArray
    weights: FloatArray

    @cached_property
    def weighted(self) -> FloatArray:
        """The gradients times the weights: (c, 3 q, n), mm^2."""
        return self.dN * np.tile(self.weights, 3)[..., None]

    @cached_property
    def pairs(self) -> FloatArray:
        """Products w dN_a,j dN_b,l: (c, 9 q, n * n) with rows (j, l, point), mm."""
        c, q, n = *self.weights.shape, self.dN.shape[2]
        dN = self.dN.reshape(c, 3, q, n)
        products = np.einsum("cq,cjqa,clqb->cjlqab", self.weights, dN, dN, optimize=True)
        return np.ascontiguousarray(products.reshape(c, 9 * q, n * n))

    @cached_property
    def single_pairs(self) -> FloatArray:
        """The products in single precision."""
        return self.pairs.astype(SINGLE)


def reference(kind: Kind, X: ArrayLike, orders: tuple[int, int, int]) -> Reference:
    """Gradients of bricks with nodes X (c, n, 3), mm.

    Raises
    ------
    ValueError
        When a brick is turned inside out.
    """
    points, w = gauss(orders)
    _, dN = shape(natural_nodes(kind), points)
    jacobian = np.einsum("qna,cni->cqia", dN, np.asarray(X, dtype=float))  # dX_i / dxi_a
    volume = np.linalg.det(jacobian)
    if not (volume > 0.0).all():
        raise ValueError("a brick is turned inside out")
    gradient = np.einsum("qna,cqaj->cjqn", dN, np.linalg.inv(jacobian))
    c, n = len(volume), dN.shape[1]
    return Reference(np.ascontiguousarray(gradient.reshape(c, -1, n)), w * volume)


@cache
def volume_form(face: int) -> FloatArray:
    """S (n, n, n) of the volume between a face and the origin: V = 1/6 S_abc x_a . (x_b x x_c).

    The exact integral of 1/3 x . (x_eta x x_zeta) over a face of ``face`` nodes. Only the totally
    antisymmetric part of the coefficients counts, so S has no other.
    """
    nodes = np.array(_FACE8 if face == 8 else _FACE4)
    points, w = gauss((4, 4))
    N, dN = shape(nodes, points)
    raw = np.einsum("q,qa,qb,qc->abc", w, N, dN[:, :, 0], dN[:, :, 1])
    raw = raw - raw.transpose(0, 2, 1)
    form: FloatArray = (raw + raw.transpose(1, 2, 0) + raw.transpose(2, 0, 1)) / 3.0
    return form
