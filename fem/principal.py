"""Stresses of a rubber that is stretched along three axes."""

from __future__ import annotations

import numpy as np

from fem.arrays import FloatArray
from fem.material import Law, kinematics


def principal_stresses(rubber: Law, stretches: FloatArray) -> FloatArray:
    """Give the Cauchy stresses along the axes, (n, 3) MPa, for stretches (n, 3)."""
    lam = np.asarray(stretches, dtype=float).T
    k = kinematics(np.einsum("ij,in->ijn", np.eye(3), lam))
    nominal = rubber.stress(k, rubber.volumetric(k.J)[1])
    cauchy: FloatArray = (np.einsum("iin->in", nominal) * lam / k.J).T
    return cauchy
