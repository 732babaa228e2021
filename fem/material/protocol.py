"""The protocol of a material law, and what compressible laws share.

A law is a frozen record of constants in MPa. Its stored energy is split, W = W_iso + U(J): W_iso
depends on the stretches at constant volume alone, J^(-1/3) times the principal stretches, and U
on J alone. U enters stress and tangent by its derivatives, so that an element may take them at
each point or from its mean dilatation.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Protocol

import numpy as np

from fem.arrays import FloatArray
from fem.material.kinematics import NEXT, PAIRS, Kinematics, kinematics

Constant = float | tuple[float, ...]


class Law(Protocol):
    """A hyperelastic, isotropic rubber: all that the elements ask of it.

    Any record with these attributes and methods will do; see `fem.material.InvariantLaw` for the
    laws whose W_iso is a function of the invariants.
    """

    @property
    def name(self) -> str:
        """Name of the law, as files hold it."""

    @property
    def constants(self) -> Mapping[str, Constant]:
        """Constants of the law by name, MPa but for exponents; `fem.material.law` takes them."""

    @property
    def shear_modulus(self) -> float:
        """Shear modulus at small strain, MPa."""

    @property
    def bulk_modulus(self) -> float:
        """Bulk modulus at small strain, MPa."""

    def volumetric(self, J: FloatArray) -> tuple[FloatArray, FloatArray, float]:
        """U, U' and U'' at J (...): MPa."""

    def isochoric_energy(self, k: Kinematics) -> FloatArray:
        """W_iso at a batch of points (...): MPa."""

    def stress(self, k: Kinematics, p: FloatArray, out: FloatArray | None = None) -> FloatArray:
        """First Piola-Kirchhoff stress P = dW/dF: (3, 3, ...), MPa.

        Parameters
        ----------
        k : Kinematics
        p : (...)
            U', MPa.
        out : (3, 3, ...), optional
            Takes the stress.
        """

    def tangent(
        self, k: Kinematics, p: FloatArray, stiffness: float, out: FloatArray | None = None
    ) -> FloatArray:
        """A_ijkl = d2W/dF_ij dF_kl for the `PAIRS` (i, k): (6, 3, 3, ...) by [ik, j, l], MPa.

        Parameters
        ----------
        k : Kinematics
        p : (...)
            U', MPa.
        stiffness : float
            U'', MPa.
        out : (6, 3, 3, ...), optional
            Takes the tangent.
        """


class Quadratic:
    """The volumetric part U = K/2 (J - 1)^2."""

    K: float

    @property
    def bulk_modulus(self) -> float:
        """Bulk modulus at small strain, MPa."""
        return self.K

    def volumetric(self, J: FloatArray) -> tuple[FloatArray, FloatArray, float]:
        """U, U' and U'' at J (...): MPa."""
        return 0.5 * self.K * (J - 1.0) ** 2, self.K * (J - 1.0), self.K


def bulk_modulus(shear_modulus: float, nu: float) -> float:
    """Bulk modulus of a shear modulus and Poisson's ratio, both at small strain, MPa.

    Raises
    ------
    ValueError
        When nu is not between 0 and 0.5.
    """
    if not 0.0 <= nu < 0.5:
        raise ValueError(f"Poisson's ratio must lie in 0 .. 0.5, not {nu:g}")
    return 2.0 * shear_modulus * (1.0 + nu) / (3.0 * (1.0 - 2.0 * nu))


def energy(law: Law, F: FloatArray) -> FloatArray:
    """W of a law at F (3, 3, ...): (...), MPa."""
    k = kinematics(F)
    return law.isochoric_energy(k) + law.volumetric(k.J)[0]


def add_volumetric(A: FloatArray, k: Kinematics, p: FloatArray, stiffness: float) -> None:
    """Add the second derivatives of U by F to a tangent A (6, 3, 3, ...).

    Parameters
    ----------
    A : (6, 3, 3, ...)
    k : Kinematics
    p : (...)
        U', MPa.
    stiffness : float
        U'', MPa.
    """
    H, S = k.H, stiffness * k.H
    F = k.F * p
    product = np.empty_like(k.J)
    for number, (i, m) in enumerate(PAIRS):
        for j in range(3):
            for n in range(3):
                entry = A[number, j, n]
                np.multiply(H[i, j], S[m, n], out=product)
                entry += product
                add_cofactor_slope(entry, F, (i, j), (m, n))


def add_cofactor_slope(
    entry: FloatArray, F: FloatArray, row: tuple[int, int], column: tuple[int, int]
) -> None:
    """Add d2J/dF_row dF_column, epsilon_imr epsilon_jns F_rs, with F times any factor."""
    (i, j), (m, n) = row, column
    if i != m and j != n:
        r, s = 3 - i - m, 3 - j - n  # the indices left over
        if (m == NEXT[i]) == (n == NEXT[j]):
            entry += F[r, s]
        else:
            entry -= F[r, s]
