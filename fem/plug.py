"""The rigid closed end: the last ring moves as one body."""

from __future__ import annotations

import numpy as np

from fem.arrays import FloatArray
from fem.mesh import Mesh
from fem.pressure import Cap, face_volumes, skew
from fem.sections import best_rotation


class Plug:
    """Offset and spin of the last ring, and the air's push on its disc.

    The unknowns are (offset, spin * radius), all in mm: six, or in a half model offset in y and z
    and spin about x.
    """

    def __init__(self, mesh: Mesh) -> None:
        self._ring = mesh.ring
        self._centre = np.array([0.0, 0.0, mesh.z[-1]])
        self._rest = mesh.X[-1, : mesh.ring] - self._centre
        self._radius = mesh.actuator.radius
        self._keep = np.array([1, 2, 3]) if mesh.half else np.arange(6)
        self._free = np.flatnonzero(~mesh.fixed_ring.ravel())
        self._cap = Cap(inner_area(mesh))

    def pose(self, x: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Centre (3,) and rotation (3, 3) of the plug at nodal positions x."""
        ring = x[-1, : self._ring]
        rest_middle, middle = self._rest.mean(axis=0), ring.mean(axis=0)
        R = best_rotation(self._rest - rest_middle, ring - middle)
        return middle - R @ rest_middle, R

    def motions(self, x: FloatArray) -> FloatArray:
        """Displacement of the last ring by each unknown: (3 ring, unknowns)."""
        centre, _ = self.pose(x)
        arm = x[-1, : self._ring] - centre
        T = np.zeros((self._ring, 3, 6))
        T[:, :, :3] = np.eye(3)
        T[:, :, 3:] = -skew(arm) / self._radius
        whole: FloatArray = T.reshape(-1, 6)[:, self._keep]
        return whole

    def _scaled(self, values: FloatArray) -> FloatArray:
        """Take a gradient (6,) or Hessian (6, 6) by offset and spin to the unknowns."""
        scale = np.array([1.0, 1.0, 1.0, *[1.0 / self._radius] * 3])[self._keep]
        if values.ndim == 1:
            return np.asarray(values[self._keep] * scale)
        return np.asarray(values[np.ix_(self._keep, self._keep)] * np.outer(scale, scale))

    def cap_volume(self, x: FloatArray) -> tuple[float, FloatArray]:
        """Volume between the disc and the origin, and its gradient by the unknowns."""
        centre, R = self.pose(x)
        volume, by_centre, by_spin, _ = self._cap.volume(centre, R[:, 2])
        return volume, self._scaled(np.concatenate([by_centre, by_spin]))

    def condense(
        self,
        x: FloatArray,
        load: FloatArray,
        pressure: float,
        own: FloatArray,
        coupling: FloatArray,
    ) -> tuple[FloatArray, FloatArray]:
        """Replace the last ring's unknowns in a layer's step by the plug's.

        Parameters
        ----------
        x : nodal positions
        load : (ring, 3) N
            Gradient of the potential by the last ring's nodes, which the spin turns.
        pressure : float, MPa
        own, coupling : (block, block) upper triangle, (block, far)
            With the last ring's unknowns behind all others.
        """
        T = self.motions(x)[self._free]
        mid = len(own) - len(T)
        n = mid + T.shape[1]
        whole = np.triu(own)
        whole += np.triu(own, 1).T
        reduced = np.empty((n, n))
        reduced[:mid, :mid] = whole[:mid, :mid]
        reduced[:mid, mid:] = whole[:mid, mid:] @ T
        reduced[mid:, :mid] = reduced[:mid, mid:].T
        centre, R = self.pose(x)
        # x(spin) = centre + arm + w x arm + w x (w x arm) / 2
        outer = np.einsum("ai,aj->ij", load, x[-1, : self._ring] - centre)
        hessian = np.zeros((6, 6))
        hessian[3:, 3:] = 0.5 * (outer + outer.T) - np.trace(outer) * np.eye(3)
        hessian -= pressure * self._cap.volume(centre, R[:, 2])[3]
        reduced[mid:, mid:] = T.T @ whole[mid:, mid:] @ T + self._scaled(hessian)
        return reduced, np.concatenate([coupling[:mid], T.T @ coupling[mid:]])


def inner_area(mesh: Mesh) -> float:
    """Area inside a ring, as the faces enclose it: they see 2/3 of a cylinder from its axis."""
    wall = face_volumes(np.ascontiguousarray(mesh.X.reshape(-1, 3)[mesh.inner].T), False)
    return 1.5 * float(wall[0].sum()) / float(mesh.z[1])
