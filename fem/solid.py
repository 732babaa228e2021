"""Forces and stiffness of a batch of alike bricks that differ only in height and place."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fem.element import Reference
from fem.material import (
    PAIRS,
    MooneyRivlin,
    isochoric_energy,
    kinematics,
    stress,
    tangent,
    volumetric,
)

FloatArray = NDArray[np.float64]


class Workspace:
    """Arrays that are used again in every iteration: fresh memory costs more than the sums."""

    def __init__(self) -> None:
        self._arrays: dict[str, FloatArray] = {}

    def get(self, name: str, shape: tuple[int, ...]) -> FloatArray:
        """Return an array of this shape; its content is whatever was left in it."""
        size = int(np.prod(shape))
        held = self._arrays.get(name)
        if held is None or held.size < size:
            held = self._arrays[name] = np.empty(size)
        return held[:size].reshape(shape)


@dataclass(frozen=True)
class SolidState:
    """Bricks at a deformed state.

    Attributes
    ----------
    energy : (E,) N mm
    force : (3, n, E) N
        Gradient of the energy by the nodal positions.
    least_J : float
        Smallest determinant of F at any point.
    """

    energy: FloatArray
    force: FloatArray
    least_J: float


def respond(
    rubber: MooneyRivlin,
    reference: Reference,
    heights: FloatArray,
    x: FloatArray,
    work: Workspace,
    stiffness: FloatArray | None = None,
    *,
    mean_dilatation: bool = False,
) -> SolidState:
    """Energy, nodal forces and stiffness of bricks.

    Parameters
    ----------
    rubber : MooneyRivlin
    reference : Reference
        Of the brick 2 mm high that all bricks are stretched copies of.
    heights : (E,) mm
    x : (3, n, E)
        Current nodal positions, mm.
    work : Workspace
    stiffness : (6, E, n * n) N/mm, optional
        Takes the stiffness for the pairs (i, k) of `fem.material.PAIRS`, where it is wanted.
    mean_dilatation : bool
        Take the volume change from the brick's mean (Simo, Taylor and Pister 1985).

    Returns
    -------
    SolidState
        With NaN energy where a brick is turned inside out.
    """
    E, n = x.shape[2], x.shape[1]
    dN, weights = reference.dN, reference.weights
    q = len(weights)
    stretch_z = 2.0 / heights
    gradient = work.get("gradient", (3, 3 * q, E))
    np.matmul(dN, x, out=gradient)
    F = gradient.reshape(3, 3, q, E)
    F[:, 2] *= stretch_z
    k = kinematics(F)
    least = float(k.J.min())
    if not least > 0.0:
        return SolidState(np.full(E, np.nan), np.zeros_like(x), least)
    volume = weights[:, None] * (0.5 * heights)
    if mean_dilatation:
        total = volume.sum(axis=0)
        mean = (volume * k.J).sum(axis=0) / total
        U, p, bulk = volumetric(rubber, mean)
        energy = (volume * isochoric_energy(rubber, k)).sum(axis=0) + total * U
        p, local_bulk = np.broadcast_to(p, k.J.shape), 0.0
    else:
        U, p, bulk = volumetric(rubber, k.J)
        energy = (volume * (isochoric_energy(rubber, k) + U)).sum(axis=0)
        local_bulk = bulk
    P = stress(rubber, k, p, out=work.get("stress", (3, 3, q, E)))
    P[:, :2] *= 0.5 * heights  # the third column's 2 / h and the volume's h / 2 cancel
    force = np.matmul(reference.weighted.T, P.reshape(3, 3 * q, E))
    if stiffness is None:
        return SolidState(energy, force, least)
    A = tangent(rubber, k, p, local_bulk, out=work.get("tangent", (6, 3, 3, q, E)))
    A[:, :2, :2] *= 0.5 * heights
    A[:, 2, 2] *= stretch_z
    np.matmul(A.reshape(6, 9 * q, E).transpose(0, 2, 1), reference.pairs, out=stiffness)
    if mean_dilatation:
        H = k.H
        H[:, :2] *= 0.5 * heights
        h = np.matmul(reference.weighted.T, H.reshape(3, 3 * q, E))  # d(volume)/dx
        for m, (i, j) in enumerate(PAIRS):
            product = h[i][:, None, :] * h[j][None, :, :] * (bulk / total)
            stiffness[m] += product.reshape(n * n, E).T
    return SolidState(energy, force, least)
