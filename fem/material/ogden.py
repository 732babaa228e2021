"""The Ogden law, a function of the principal stretches."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from fem.arrays import FloatArray
from fem.material.kinematics import PAIRS, Kinematics
from fem.material.protocol import Constant, Quadratic, add_volumetric, bulk_modulus

_CROSSED = ((0, 1), (1, 2), (2, 0))  # pairs of principal directions


@dataclass(frozen=True)
class Ogden(Quadratic):
    """W_iso = sum_p mu_p / alpha_p (l1^alpha_p + l2^alpha_p + l3^alpha_p - 3), U = K/2 (J - 1)^2.

    The l are the principal stretches times J^(-1/3). This is Ogden's own form (Proc. R. Soc.
    Lond. A 326 (1972) 565), where the shear modulus is half of sum_p mu_p alpha_p. Programs that
    write 2 mu_p / alpha_p^2 instead have mu_p = alpha_p / 2 times ours.

    Attributes
    ----------
    mu : tuple of float, MPa
    alpha : tuple of float
        As many exponents, none of them 0.
    K : float
        Bulk modulus, MPa.

    Raises
    ------
    ValueError
        When mu and alpha do not match, an exponent is 0 or the rubber has no stiffness at rest.
    """

    name: ClassVar[str] = "ogden"
    mu: tuple[float, ...]
    alpha: tuple[float, ...]
    K: float

    def __post_init__(self) -> None:
        if len(self.mu) != len(self.alpha) or not all(self.alpha):
            raise ValueError("an Ogden rubber needs as many mu as alpha, and no alpha of 0")
        if not (self.shear_modulus > 0.0 and self.K > 0.0):
            raise ValueError("an Ogden rubber needs a sum of mu alpha above 0, and K > 0")

    @classmethod
    def from_poisson(cls, mu: tuple[float, ...], alpha: tuple[float, ...], nu: float) -> Ogden:
        """Take the bulk modulus from Poisson's ratio at small strain.

        Raises
        ------
        ValueError
            When nu is not between 0 and 0.5.
        """
        return cls(mu, alpha, bulk_modulus(_shear_modulus(mu, alpha), nu))

    @property
    def constants(self) -> dict[str, Constant]:
        """Mu and K, MPa, and alpha."""
        return {"mu": self.mu, "alpha": self.alpha, "K": self.K}

    @property
    def shear_modulus(self) -> float:
        """Shear modulus at small strain, MPa."""
        return _shear_modulus(self.mu, self.alpha)

    def isochoric_energy(self, k: Kinematics) -> FloatArray:
        """W_iso at a batch of points (...): MPa."""
        e = _isochoric(k)
        W = np.zeros_like(k.J)
        for mu, alpha in zip(self.mu, self.alpha, strict=True):
            W += mu / alpha * np.expm1(alpha * e).sum(axis=0)  # precise near rest
        return W

    def stress(self, k: Kinematics, p: FloatArray, out: FloatArray | None = None) -> FloatArray:
        """First Piola-Kirchhoff stress (3, 3, ...), MPa; see `fem.material.Law`."""
        P = np.empty_like(k.F) if out is None else out
        directions = k.principal
        pull = self._deviator(_isochoric(k)) * np.exp(-directions.log)
        np.einsum("ia...,ja...->ij...", directions.now * pull, directions.rest, out=P)
        P += p * k.H
        return P

    def tangent(
        self, k: Kinematics, p: FloatArray, stiffness: float, out: FloatArray | None = None
    ) -> FloatArray:
        """A_ijkl for the PAIRS (i, k): (6, 3, 3, ...), MPa; see `fem.material.Law`.

        In the basis n_a N_b of directions after and before, a change of F has the components
        f_ab. Those with a = b change the stretches, dP_aa = sum_b M_ab f_bb. The others turn the
        directions, and the sums and differences f_ab +- f_ba each meet a stiffness of their own.
        """
        A = np.empty((6, *k.F.shape)) if out is None else out
        n, N = k.principal.now, k.principal.rest
        basis = np.einsum("ia...,jb...->abij...", n, N)
        left, right = np.empty((9, *k.F.shape)), np.empty((9, *k.F.shape))
        same, sums, differences = self._moduli(k)
        for a in range(3):
            left[a] = basis[a, a]
            right[a] = sum(same[a, b] * basis[b, b] for b in range(3))
        for number, (a, b) in enumerate(_CROSSED):
            left[3 + number] = basis[a, b] + basis[b, a]
            left[6 + number] = basis[a, b] - basis[b, a]
            right[3 + number] = sums[number] * left[3 + number]
            right[6 + number] = differences[number] * left[6 + number]
        for number, (i, m) in enumerate(PAIRS):
            A[number] = np.einsum("rj...,rn...->jn...", left[:, i], right[:, m])
        add_volumetric(A, k, p, stiffness)
        return A

    def _deviator(self, e: FloatArray) -> FloatArray:
        """Principal Kirchhoff stresses of W_iso (3, ...), MPa, at isochoric log stretches e."""
        t = sum(mu * np.exp(alpha * e) for mu, alpha in zip(self.mu, self.alpha, strict=True))
        f: FloatArray = t - np.mean(t, axis=0)
        return f

    def _moduli(self, k: Kinematics) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Moduli in the principal directions, MPa.

        Returns
        -------
        same : (3, 3, ...)
            M_ab: change of P_aa with f_bb.
        sums, differences : (3, ...)
            Half of what f_ab + f_ba and f_ab - f_ba meet, for the pairs _CROSSED.
        """
        log, e = k.principal.log, _isochoric(k)
        f, slope = self._deviator(e), np.zeros_like(e)
        for mu, alpha in zip(self.mu, self.alpha, strict=True):
            slope += mu * alpha * np.exp(alpha * e)
        same = slope.sum(axis=0) / 9.0 - (slope[:, None] + slope[None]) / 3.0
        for a in range(3):
            same[a, a] += slope[a] - f[a]
        same *= np.exp(-(log[:, None] + log[None]))
        sums, differences = np.empty_like(e), np.empty_like(e)
        for number, (a, b) in enumerate(_CROSSED):
            apart, middle = log[a] - log[b], 0.5 * (e[a] + e[b])
            straight = np.zeros_like(apart)
            for mu, alpha in zip(self.mu, self.alpha, strict=True):
                straight += mu * np.exp(alpha * middle) * _ratio(alpha, apart)
            crossed = np.cosh(apart) * straight - 0.5 * (f[a] + f[b])
            over = 0.5 * np.exp(-(log[a] + log[b]))
            sums[number] = over * (straight + crossed)
            differences[number] = over * (straight - crossed)
        return same, sums, differences


def _isochoric(k: Kinematics) -> FloatArray:
    """Logarithms of the stretches at constant volume, (3, ...)."""
    return k.principal.log - np.log(k.J) / 3.0


def _ratio(alpha: float, apart: FloatArray) -> FloatArray:
    """sinh(alpha apart / 2) / sinh(apart): the difference of powers over that of the squares.

    Between equal stretches it is alpha / 2, their derivative; near them it loses no digits.
    """
    equal = apart == 0.0
    some = np.where(equal, 1.0, apart)
    ratio: FloatArray = np.where(equal, 0.5 * alpha, np.sinh(0.5 * alpha * some) / np.sinh(some))
    return ratio


def _shear_modulus(mu: tuple[float, ...], alpha: tuple[float, ...]) -> float:
    return 0.5 * sum(m * a for m, a in zip(mu, alpha, strict=True))
