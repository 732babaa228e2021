"""The strain measures of a batch of points that every material law is written in.

All arrays carry the tensor indices first and any batch of points behind: F (3, 3, ...).
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from functools import cached_property

import numpy as np

from fem.arrays import SINGLE, FloatArray

# The pairs (i, k) of spatial indices that a tangent A_ijkl is stored for; A_ijkl = A_klij.
PAIRS = ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))
NEXT = (1, 2, 0)
_LAST = (2, 0, 1)


def pair(i: int, j: int) -> int:
    """Place of the indices (i, j) or (j, i) in `PAIRS`."""
    return PAIRS.index((min(i, j), max(i, j)))


def cofactor(F: FloatArray) -> FloatArray:
    """Cofactor H = dJ/dF of F (3, 3, ...)."""
    H = np.empty_like(F)
    product = np.empty_like(F[0, 0])
    for i in range(3):
        for j in range(3):
            i1, i2, j1, j2 = NEXT[i], _LAST[i], NEXT[j], _LAST[j]
            np.multiply(F[i1, j1], F[i2, j2], out=H[i, j])
            np.multiply(F[i1, j2], F[i2, j1], out=product)
            H[i, j] -= product
    return H


def determinant(F: FloatArray, H: FloatArray) -> FloatArray:
    """J of F (3, 3, ...), given its cofactor."""
    J: FloatArray = F[0, 0] * H[0, 0] + F[0, 1] * H[0, 1] + F[0, 2] * H[0, 2]
    return J


@dataclass(frozen=True)
class Principal:
    """Principal stretches and directions.

    Attributes
    ----------
    log : (3, ...)
        Logarithm of each stretch.
    rest, now : (3, 3, ...)
        Unit vectors [i, a] along stretch a, before and after the deformation.
    """

    log: FloatArray
    rest: FloatArray
    now: FloatArray


@dataclass(frozen=True)
class Kinematics:
    """The strain measures that energy, stress and tangent share at a batch of points.

    Attributes
    ----------
    F, H : (3, 3, ...)
        Deformation gradient and cofactor.
    J : (...)
    G : (3, 3, ...)
        I1 F - F C, half of dI2/dF.
    C, B : (6, ...)
        Right and left Cauchy-Green tensor, in the order of PAIRS.
    I1, I2 : (...)
    """

    F: FloatArray
    H: FloatArray
    J: FloatArray
    G: FloatArray
    C: FloatArray
    B: FloatArray
    I1: FloatArray
    I2: FloatArray

    def single(self) -> Kinematics:
        """Give the same in single precision, as a tangent may be kept in."""
        return Kinematics(*(getattr(self, f.name).astype(SINGLE) for f in fields(self)))

    @cached_property
    def principal(self) -> Principal:
        """Principal stretches and directions, for the laws that need them.

        Where stretches are equal, the directions are some orthogonal ones of the many.
        """
        C = np.empty((*self.J.shape, 3, 3))
        for n, (i, j) in enumerate(PAIRS):
            C[..., i, j] = C[..., j, i] = self.C[n]
        squares, vectors = np.linalg.eigh(C)
        rest = np.ascontiguousarray(np.moveaxis(vectors, (-2, -1), (0, 1)))
        log = 0.5 * np.log(np.moveaxis(squares, -1, 0))
        now = np.einsum("ij...,ja...->ia...", self.F, rest) * np.exp(-log)
        return Principal(log, rest, now)


def kinematics(F: FloatArray) -> Kinematics:
    """Derive the strain measures from F (3, 3, ...)."""
    H = cofactor(F)
    J = determinant(F, H)
    batch = F.shape[2:]
    C, B = np.empty((6, *batch)), np.empty((6, *batch))
    product = np.empty(batch)
    for n, (i, j) in enumerate(PAIRS):
        for out, a, b in ((C, F[:, i], F[:, j]), (B, F[i], F[j])):
            np.multiply(a[0], b[0], out=out[n])
            for m in (1, 2):
                np.multiply(a[m], b[m], out=product)
                out[n] += product
    I1 = C[0] + C[3] + C[5]
    I2 = C[0] * C[3] + C[3] * C[5] + C[5] * C[0] - C[1] ** 2 - C[2] ** 2 - C[4] ** 2
    G = np.empty_like(F)
    for i in range(3):
        for j in range(3):
            out = G[i, j]
            np.multiply(I1, F[i, j], out=out)
            for m in range(3):
                np.multiply(F[i, m], C[pair(m, j)], out=product)
                out -= product
    return Kinematics(F, H, J, G, C, B, I1, I2)


def full_tangent(A: FloatArray) -> FloatArray:
    """Unfold a law's tangent (6, 3, 3, ...) to A_ijkl (3, 3, 3, 3, ...)."""
    full = np.empty((3, 3, 3, 3, *A.shape[3:]))
    for n, (i, m) in enumerate(PAIRS):
        full[i, :, m] = A[n]
        full[m, :, i] = np.swapaxes(A[n], 0, 1)
    return full
