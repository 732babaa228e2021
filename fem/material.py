"""Compressible Mooney-Rivlin rubber: energy, stress and tangent as pure functions of F.

W = C10 (J^(-2/3) I1 - 3) + C01 (J^(-4/3) I2 - 3) + U(J), U = K/2 (J - 1)^2; neo-Hooke is C01 = 0.

All arrays carry the tensor indices first and any batch of points behind: F (3, 3, ...). U enters
by its derivatives, so that an element may take them at each point or from its mean dilatation.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]

# The pairs (i, k) of spatial indices that a tangent A_ijkl is stored for; A_ijkl = A_klij.
PAIRS = ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))
_NEXT = (1, 2, 0)
_LAST = (2, 0, 1)


@dataclass(frozen=True)
class MooneyRivlin:
    """A rubber: C10, C01 and the bulk modulus K, MPa."""

    C10: float
    C01: float
    K: float

    def __post_init__(self) -> None:
        if not (self.C10 + self.C01 > 0.0 and self.C01 >= 0.0 and self.C10 >= 0.0 and self.K > 0.0):
            raise ValueError("a rubber needs C10, C01 >= 0, C10 + C01 > 0 and K > 0")

    @classmethod
    def from_poisson(cls, C10: float, C01: float, nu: float) -> MooneyRivlin:
        """Take the bulk modulus from Poisson's ratio at small strain.

        Raises
        ------
        ValueError
            When nu is not between 0 and 0.5.
        """
        if not 0.0 <= nu < 0.5:
            raise ValueError(f"Poisson's ratio must lie in 0 .. 0.5, not {nu:g}")
        mu = 2.0 * (C10 + C01)
        return cls(C10, C01, 2.0 * mu * (1.0 + nu) / (3.0 * (1.0 - 2.0 * nu)))

    @property
    def shear_modulus(self) -> float:
        """Shear modulus at small strain, MPa."""
        return 2.0 * (self.C10 + self.C01)


# The paper's silicone, XIAMETER RTV-4250-S (section 2.2).
PAPER_RUBBER = MooneyRivlin.from_poisson(0.0694, 0.0628, 0.46)


def cofactor(F: FloatArray) -> FloatArray:
    """Cofactor H = dJ/dF of F (3, 3, ...)."""
    H = np.empty_like(F)
    product = np.empty_like(F[0, 0])
    for i in range(3):
        for j in range(3):
            i1, i2, j1, j2 = _NEXT[i], _LAST[i], _NEXT[j], _LAST[j]
            np.multiply(F[i1, j1], F[i2, j2], out=H[i, j])
            np.multiply(F[i1, j2], F[i2, j1], out=product)
            H[i, j] -= product
    return H


def determinant(F: FloatArray, H: FloatArray) -> FloatArray:
    """J of F (3, 3, ...), given its cofactor."""
    J: FloatArray = F[0, 0] * H[0, 0] + F[0, 1] * H[0, 1] + F[0, 2] * H[0, 2]
    return J


@dataclass(frozen=True)
class Kinematics:
    """What energy, stress and tangent share at a batch of points.

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
                np.multiply(F[i, m], C[_pair(m, j)], out=product)
                out -= product
    return Kinematics(F, H, J, G, C, B, I1, I2)


def volumetric(rubber: MooneyRivlin, J: FloatArray) -> tuple[FloatArray, FloatArray, float]:
    """U, U' and U'' at J (...): MPa."""
    return 0.5 * rubber.K * (J - 1.0) ** 2, rubber.K * (J - 1.0), rubber.K


def isochoric_energy(rubber: MooneyRivlin, k: Kinematics) -> FloatArray:
    """W without U at a batch of points: MPa."""
    c = k.J ** (-2.0 / 3.0)
    W: FloatArray = rubber.C10 * (c * k.I1 - 3.0) + rubber.C01 * (c * c * k.I2 - 3.0)
    return W


def energy(rubber: MooneyRivlin, F: FloatArray) -> FloatArray:
    """W at F (3, 3, ...): (...), MPa."""
    k = kinematics(F)
    return isochoric_energy(rubber, k) + volumetric(rubber, k.J)[0]


def stress(
    rubber: MooneyRivlin, k: Kinematics, p: FloatArray, out: FloatArray | None = None
) -> FloatArray:
    """First Piola-Kirchhoff stress P (3, 3, ...), MPa; ``p`` is U'."""
    P = np.empty_like(k.F) if out is None else out
    a, b, slope, _ = _coefficients(rubber, k)
    slope = slope + p
    a, b = 2.0 * a, 2.0 * b
    product = np.empty_like(k.J)
    for i in range(3):
        for j in range(3):
            np.multiply(a, k.F[i, j], out=P[i, j])
            np.multiply(b, k.G[i, j], out=product)
            P[i, j] += product
            np.multiply(slope, k.H[i, j], out=product)
            P[i, j] += product
    return P


def tangent(
    rubber: MooneyRivlin,
    k: Kinematics,
    p: FloatArray,
    stiffness: float,
    out: FloatArray | None = None,
) -> FloatArray:
    """A_ijkl = d2W/dF_ij dF_kl for the PAIRS (i, k): (6, 3, 3, ...) indexed [ik, j, l], MPa.

    ``p`` is U' and ``stiffness`` U''.
    """
    A = np.empty((6, *k.F.shape)) if out is None else out
    a, b, slope, curvature = _coefficients(rubber, k)
    slope = slope + p
    b2 = 2.0 * b
    iso = 2.0 * a + b2 * k.I1  # of delta_ik delta_jl
    root = np.sqrt(b2)
    S = k.F * root  # S_ij S_kl = 2 b F_ij F_kl
    Q = np.empty_like(k.F)
    third_a, third_b = (-4.0 / 3.0) * a / k.J, (-8.0 / 3.0) * b / k.J
    half = 0.5 * (curvature + stiffness)
    product = np.empty_like(k.J)
    for i in range(3):
        for j in range(3):
            np.multiply(third_a, k.F[i, j], out=Q[i, j])
            np.multiply(third_b, k.G[i, j], out=product)
            Q[i, j] += product
            np.multiply(half, k.H[i, j], out=product)
            Q[i, j] += product
    F = k.F * slope  # for J'' = epsilon epsilon F
    C, B = k.C * b2, k.B * b2
    T = S + S
    H = k.H
    for pair, (i, m) in enumerate(PAIRS):
        for j in range(3):
            for n in range(3):
                entry = A[pair, j, n]
                np.multiply(Q[i, j], H[m, n], out=entry)
                np.multiply(H[i, j], Q[m, n], out=product)
                entry += product
                np.multiply(T[i, j], S[m, n], out=product)
                entry += product
                np.multiply(S[i, n], S[m, j], out=product)
                entry -= product
                if i == m:
                    entry -= C[_pair(j, n)]
                if j == n:
                    entry -= B[pair]
                    if i == m:
                        entry += iso
                if i != m and j != n:
                    # epsilon_imr epsilon_jns F_rs: r and s are the indices left over
                    r, s = 3 - i - m, 3 - j - n
                    if (m == _NEXT[i]) == (n == _NEXT[j]):
                        entry += F[r, s]
                    else:
                        entry -= F[r, s]
    return A


def full_tangent(A: FloatArray) -> FloatArray:
    """Unfold what `tangent` gives to A_ijkl (3, 3, 3, 3, ...)."""
    full = np.empty((3, 3, 3, 3, *A.shape[3:]))
    for n, (i, m) in enumerate(PAIRS):
        full[i, :, m] = A[n]
        full[m, :, i] = np.swapaxes(A[n], 0, 1)
    return full


def _coefficients(
    rubber: MooneyRivlin, k: Kinematics
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """dW/dI1, dW/dI2 and the isochoric dW/dJ, d2W/dJ2."""
    c = k.J ** (-2.0 / 3.0)
    a, b = rubber.C10 * c, rubber.C01 * c * c
    aI1, bI2 = a * k.I1, b * k.I2
    slope = -(2.0 / 3.0 * aI1 + 4.0 / 3.0 * bI2) / k.J
    curvature = (10.0 / 9.0 * aI1 + 28.0 / 9.0 * bI2) / k.J**2
    return a, b, slope, curvature


def _pair(i: int, j: int) -> int:
    return PAIRS.index((min(i, j), max(i, j)))
