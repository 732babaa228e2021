"""Forces and stiffness of a batch of alike bricks that differ only in height and place."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from fem.arrays import DOUBLE, SINGLE, DType, FloatArray
from fem.element import Reference
from fem.material import PAIRS, Kinematics, Law, kinematics


class Workspace:
    """Arrays that are used again in every iteration: fresh memory costs more than the sums."""

    def __init__(self) -> None:
        self._arrays: dict[str, FloatArray] = {}

    def get(self, name: str, shape: tuple[int, ...], dtype: DType = DOUBLE) -> FloatArray:
        """Return an array of this shape; its content is whatever was left in it."""
        size = math.prod(shape)
        held = self._arrays.get(name)
        if held is None or held.size < size or held.dtype != dtype:
            held = self._arrays[name] = np.empty(size, dtype)
        return held[:size].reshape(shape)


@dataclass(frozen=True)
class SolidState:
    """Bricks at a deformed state, c columns of L.

    Attributes
    ----------
    energy : float, N mm
        NaN where a brick is turned inside out.
    force : (3, c, n, L) N
        Gradient of the energy by the nodal positions.
    least_J : float
        Smallest determinant of F at any point.
    """

    energy: float
    force: FloatArray
    least_J: float


def respond(
    rubber: Law,
    reference: Reference,
    heights: FloatArray,
    x: FloatArray,
    work: Workspace,
    stiffness: FloatArray | None = None,
    *,
    mean_dilatation: bool = False,
) -> SolidState:
    """Energy, nodal forces and stiffness of columns of bricks.

    Parameters
    ----------
    rubber : Law
    reference : Reference
        Of c bricks 2 mm high; all bricks of a column are stretched copies of its own.
    heights : (L,) mm
        Of the bricks of each column.
    x : (3, c, n, L)
        Current nodal positions, mm.
    work : Workspace
    stiffness : (6, c, L, n * n) N/mm, optional
        Takes the stiffness for the pairs (i, k) of `fem.material.PAIRS`, where it is wanted, in
        its own precision.
    mean_dilatation : bool
        Take the volume change from each brick's mean (Simo, Taylor and Pister 1985).
    """
    c, q, L = *reference.weights.shape, x.shape[3]
    stretch_z = 2.0 / heights
    # Memory runs (i, column, j, point, layer), so that products see whole matrices.
    gradient = work.get("gradient", (3, c, 3 * q, L))
    np.matmul(reference.dN, x, out=gradient)
    F = np.moveaxis(gradient.reshape(3, c, 3, q, L), 1, 2)
    F[:, 2] *= stretch_z
    k = kinematics(F)
    least = float(k.J.min())
    if not least > 0.0:
        return SolidState(np.nan, np.zeros_like(x), least)
    volume = reference.weights[..., None] * (0.5 * heights)
    energy, p, local_bulk, mean_bulk = _dilated(rubber, k, volume, mean_dilatation)
    stresses = work.get("stress", (3, c, 3, q, L))
    P = rubber.stress(k, p, out=np.moveaxis(stresses, 1, 2))
    P[:, :2] *= 0.5 * heights  # the third column's 2 / h and the volume's h / 2 cancel
    across = np.swapaxes(reference.weighted, 1, 2)
    state = SolidState(energy, across @ stresses.reshape(3, c, 3 * q, L), least)
    if stiffness is None:
        return state
    H, pairs = k.H, reference.pairs
    if stiffness.dtype == SINGLE:
        k, p, pairs = k.single(), p.astype(SINGLE), reference.single_pairs
    moduli = work.get("tangent", (6, c, 3, 3, q, L), stiffness.dtype)
    A = rubber.tangent(k, p, local_bulk, out=np.moveaxis(moduli, 1, 3))
    A[:, :2, :2] *= 0.5 * heights
    A[:, 2, 2] *= stretch_z
    np.matmul(np.swapaxes(moduli.reshape(6, c, 9 * q, L), 2, 3), pairs, out=stiffness)
    if mean_bulk is not None:
        _stiffen(stiffness, across, H, heights, mean_bulk)
    return state


def _dilated(
    rubber: Law, k: Kinematics, volume: FloatArray, mean_dilatation: bool
) -> tuple[float, FloatArray, float, FloatArray | None]:
    """Take the volume change at each point, or from the mean of its brick.

    Returns
    -------
    energy : float
        Of all points of volume (c, q, L), N mm.
    p : (c, q, L)
        U', MPa.
    bulk : float
        U'' at each point, MPa; 0 where the brick's mean counts.
    mean_bulk : (c, L), or None
        U'' over the brick's volume, MPa/mm^3, where the mean counts.
    """
    if not mean_dilatation:
        U, p, bulk = rubber.volumetric(k.J)
        return float((volume * (rubber.isochoric_energy(k) + U)).sum()), p, bulk, None
    total = volume.sum(axis=1)
    mean = (volume * k.J).sum(axis=1) / total
    U, p, bulk = rubber.volumetric(mean)
    energy = (volume * rubber.isochoric_energy(k)).sum() + (total * U).sum()
    return float(energy), np.broadcast_to(p[:, None], k.J.shape), 0.0, bulk / total


def _stiffen(
    stiffness: FloatArray, across: FloatArray, H: FloatArray, heights: FloatArray, bulk: FloatArray
) -> None:
    """Add what each brick's mean dilatation resists.

    Parameters
    ----------
    stiffness : (6, c, L, n * n)
    across : (c, n, 3 q)
        Weighted gradients.
    H : (3, 3, c, q, L)
    heights : (L,)
    bulk : (c, L)
        U'' over the brick's volume, MPa/mm^3.
    """
    c, n = across.shape[:2]
    H = np.moveaxis(H, 2, 1).copy()
    H[:, :, :2] *= 0.5 * heights
    h = across @ H.reshape(3, c, -1, len(heights))  # d(volume)/dx
    for m, (i, j) in enumerate(PAIRS):
        product = h[i][:, :, None] * h[j][:, None] * bulk[:, None, None]
        stiffness[m] += np.moveaxis(product.reshape(c, n * n, -1), 1, 2)
