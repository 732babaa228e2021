"""The enclosed volume, its gradient (the pressure's nodal forces) and its second derivative.

A gauge pressure has the potential -pressure * V with V the volume inside the wall's inner
surface, the root's section (z = 0, which does not move) and the rigid plug. The tangent is the
Hessian of a function, so it is symmetric; it is exact, since V is cubic in the nodes.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem.arrays import FloatArray
from fem.element import volume_form


def face_volumes(x: FloatArray, tangent: bool) -> tuple[FloatArray, FloatArray, FloatArray | None]:
    """Volume between faces and the origin.

    Parameters
    ----------
    x : (3, n, E)
        Nodes of the faces, mm.
    tangent : bool

    Returns
    -------
    volume : (E,) mm^3
    gradient : (3, n, E) mm^2
    h : (3, n, n, E) mm, or None
        The Hessian is d2V/dx_ia dx_jb = epsilon_ijk h_k,ab.
    """
    n, E = x.shape[1], x.shape[2]
    h = np.matmul(volume_form(n).reshape(n * n, n), x).reshape(3, n, n, E)
    gradient = np.empty_like(x)
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        # x_b x h_ab, halved for the two ways to see each pair of nodes
        gradient[i] = 0.5 * ((x[j] * h[k]).sum(axis=1) - (x[k] * h[j]).sum(axis=1))
    volume = (x * gradient).sum(axis=(0, 1)) / 3.0
    return volume, gradient, h if tangent else None


@dataclass(frozen=True)
class Cap:
    """The plug's inner face: a rigid disc.

    Attributes
    ----------
    area : float
        Of the disc, or half of it, as the mesh's inner edge encloses it, mm^2.
    """

    area: float

    def volume(
        self, centre: FloatArray, normal: FloatArray
    ) -> tuple[float, FloatArray, FloatArray, FloatArray]:
        """Volume of the cone from the origin, its gradient and Hessian by (centre, spin).

        Parameters
        ----------
        centre, normal : (3,)

        Returns
        -------
        volume : float, mm^3
        by_centre, by_spin : (3,)
        hessian : (6, 6)
        """
        a = self.area / 3.0
        by_centre = a * normal
        by_spin = a * np.cross(normal, centre)
        hessian = np.zeros((6, 6))
        # normal(spin) = n + w x n + w x (w x n) / 2
        hessian[:3, 3:] = -a * skew(normal)
        hessian[3:, :3] = hessian[:3, 3:].T
        outer = np.outer(centre, normal)
        hessian[3:, 3:] = a * (0.5 * (outer + outer.T) - (centre @ normal) * np.eye(3))
        return a * float(centre @ normal), by_centre, by_spin, hessian


def skew(v: FloatArray) -> FloatArray:
    """Matrix of the cross product with v (..., 3): (..., 3, 3)."""
    v = np.asarray(v, dtype=float)
    S = np.zeros((*v.shape[:-1], 3, 3))
    S[..., 0, 1], S[..., 0, 2], S[..., 1, 2] = -v[..., 2], v[..., 1], -v[..., 0]
    S[..., 1, 0], S[..., 2, 0], S[..., 2, 1] = v[..., 2], -v[..., 1], v[..., 0]
    return S
