"""Laws of the invariants, W_iso = W(I1bar, I2bar): one kernel for all of them.

I1bar = J^(-2/3) I1 and I2bar = J^(-4/3) I2 are the invariants of the deformation at constant
volume. A law gives W and its derivatives by them; stress and tangent follow by the chain rule.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np

from fem.arrays import FloatArray
from fem.material.kinematics import PAIRS, Kinematics, pair
from fem.material.protocol import Quadratic, add_cofactor_slope

Value = float | FloatArray


@dataclass(frozen=True)
class Curvatures:
    """Second derivatives of W by I1bar and I2bar, each a number or (...), MPa."""

    by_11: Value
    by_12: Value = 0.0
    by_22: Value = 0.0


class InvariantLaw(Quadratic, ABC):
    """A law of the invariants with U = K/2 (J - 1)^2.

    A new law derives from it, holds ``K`` and gives `density`, `slopes` and, where it is not
    linear in the invariants, `curvatures`; and ``name``, ``constants`` and ``shear_modulus``, as
    the protocol `fem.material.Law` asks.
    """

    @abstractmethod
    def density(self, I1: FloatArray, I2: FloatArray) -> FloatArray:
        """W at I1bar, I2bar (...): MPa."""

    @abstractmethod
    def slopes(self, I1: FloatArray, I2: FloatArray) -> tuple[Value, Value]:
        """dW/dI1bar and dW/dI2bar, each a number or (...), MPa; the second must not be negative."""

    def curvatures(self, I1: FloatArray, I2: FloatArray) -> Curvatures | None:
        """Second derivatives of W; None where W is linear."""
        return None

    def isochoric_energy(self, k: Kinematics) -> FloatArray:
        """W_iso at a batch of points (...): MPa."""
        return self.density(*_reduced(k)[1:])

    def stress(self, k: Kinematics, p: FloatArray, out: FloatArray | None = None) -> FloatArray:
        """First Piola-Kirchhoff stress (3, 3, ...), MPa; see `fem.material.Law`."""
        P = np.empty_like(k.F) if out is None else out
        a, b, slope, _ = _coefficients(self, k)
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
        self, k: Kinematics, p: FloatArray, stiffness: float, out: FloatArray | None = None
    ) -> FloatArray:
        """A_ijkl for the PAIRS (i, k): (6, 3, 3, ...), MPa; see `fem.material.Law`."""
        A = np.empty((6, *k.F.shape)) if out is None else out
        a, b, slope, curvature = _coefficients(self, k)
        slope = slope + p
        b2 = 2.0 * b
        iso = 2.0 * a + b2 * k.I1  # of delta_ik delta_jl
        S = k.F * np.sqrt(b2)  # S_ij S_kl = 2 b F_ij F_kl
        Q = _mixed(k, a, b, 0.5 * (curvature + stiffness))
        F = k.F * slope  # for J'' = epsilon epsilon F
        C, B = k.C * b2, k.B * b2
        T = S + S
        H = k.H
        product = np.empty_like(k.J)
        for number, (i, m) in enumerate(PAIRS):
            for j in range(3):
                for n in range(3):
                    entry = A[number, j, n]
                    np.multiply(Q[i, j], H[m, n], out=entry)
                    np.multiply(H[i, j], Q[m, n], out=product)
                    entry += product
                    np.multiply(T[i, j], S[m, n], out=product)
                    entry += product
                    np.multiply(S[i, n], S[m, j], out=product)
                    entry -= product
                    if i == m:
                        entry -= C[pair(j, n)]
                    if j == n:
                        entry -= B[number]
                        if i == m:
                            entry += iso
                    add_cofactor_slope(entry, F, (i, j), (m, n))
        curved = self.curvatures(*_reduced(k)[1:])
        if curved is not None:
            _add_curved(A, k, curved)
        return A


def _reduced(k: Kinematics) -> tuple[FloatArray, FloatArray, FloatArray]:
    """J^(-2/3), I1bar and I2bar."""
    c = k.J ** (-2.0 / 3.0)
    return c, c * k.I1, c * c * k.I2


def _coefficients(
    law: InvariantLaw, k: Kinematics
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """dW/dI1, dW/dI2 and dW/dJ, d2W/dJ2 at constant dW/dI1bar, dW/dI2bar."""
    c, I1, I2 = _reduced(k)
    first, second = law.slopes(I1, I2)
    a, b = first * c, second * c * c
    aI1, bI2 = a * k.I1, b * k.I2
    slope = -(2.0 / 3.0 * aI1 + 4.0 / 3.0 * bI2) / k.J
    curvature = (10.0 / 9.0 * aI1 + 28.0 / 9.0 * bI2) / k.J**2
    return a, b, slope, curvature


def _mixed(k: Kinematics, a: FloatArray, b: FloatArray, half: FloatArray) -> FloatArray:
    """Q (3, 3, ...) of the terms Q_ij H_kl + H_ij Q_kl of the tangent."""
    Q = np.empty_like(k.F)
    third_a, third_b = (-4.0 / 3.0) * a / k.J, (-8.0 / 3.0) * b / k.J
    product = np.empty_like(k.J)
    for i in range(3):
        for j in range(3):
            np.multiply(third_a, k.F[i, j], out=Q[i, j])
            np.multiply(third_b, k.G[i, j], out=product)
            Q[i, j] += product
            np.multiply(half, k.H[i, j], out=product)
            Q[i, j] += product
    return Q


def _add_curved(A: FloatArray, k: Kinematics, w: Curvatures) -> None:
    """Add the products of the invariants' gradients with the second derivatives of W."""
    c, I1, I2 = _reduced(k)
    first = 2.0 * c * k.F - (2.0 / 3.0) * I1 / k.J * k.H  # dI1bar/dF
    ways = [(first, w.by_11 * first)]
    if np.any(w.by_12) or np.any(w.by_22):
        second = 2.0 * c * c * k.G - (4.0 / 3.0) * I2 / k.J * k.H  # dI2bar/dF
        ways = [
            (first, w.by_11 * first + w.by_12 * second),
            (second, w.by_12 * first + w.by_22 * second),
        ]
    product = np.empty_like(k.J)
    for left, right in ways:
        for number, (i, m) in enumerate(PAIRS):
            for j in range(3):
                for n in range(3):
                    np.multiply(left[i, j], right[m, n], out=product)
                    A[number, j, n] += product
