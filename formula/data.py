"""The angles that a campaign of one-joint runs has found."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class Data:
    """Angles on a grid, NaN where a run did not get so far.

    Attributes
    ----------
    alpha_deg : (A,)
    openF_mm : (O,)
    pressure_bar : (N,)
        All ascending.
    theta_deg : (A, O, N)
    """

    alpha_deg: FloatArray
    openF_mm: FloatArray
    pressure_bar: FloatArray
    theta_deg: FloatArray

    @property
    def points(self) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """Return alpha, openF, P and theta of all that is known, (M,) each."""
        alpha, openF, P = np.meshgrid(
            self.alpha_deg, self.openF_mm, self.pressure_bar, indexing="ij"
        )
        mask = np.isfinite(self.theta_deg)
        return alpha[mask], openF[mask], P[mask], self.theta_deg[mask]

    @property
    def run(self) -> NDArray[np.int64]:
        """Number of the run that every point of ``points`` comes from, (M,)."""
        A, O, N = self.theta_deg.shape  # noqa: E741
        number = np.broadcast_to(np.arange(A * O).reshape(A, O, 1), (A, O, N))
        numbers: NDArray[np.int64] = number[np.isfinite(self.theta_deg)]
        return numbers
