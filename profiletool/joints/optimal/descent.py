"""Least squares within bounds: Gauss-Newton steps, damped where they fail."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.optimize import lsq_linear

from profiletool.records.units import FloatArray

_DAMPING, _MOST_DAMPING = 1e-3, 1e3
_LEAST = 1e-9  # damping that keeps the matrix definite
_GAIN = 3e-3  # of the sum of squares: a step that brings less is the last


def bounded_step(
    jacobian: FloatArray,
    residuals: FloatArray,
    room: tuple[FloatArray, FloatArray],
    scale: FloatArray,
    damping: float,
) -> FloatArray:
    """Give the step that makes linearised residuals least: (Q,).

    Parameters
    ----------
    jacobian : (M, Q) array
    residuals : (M,) array
    room : two (Q,) arrays
        The least and the largest step.
    scale : (Q,) array
        Steps that count alike in the damping.
    damping : float
        Share of the mean square of the scaled Jacobian's columns; keeps what the residuals hardly
        see from running away.
    """
    scaled = jacobian * scale
    # Summed by einsum: threads of a BLAS cost more than they bring at this size.
    square = np.einsum("mi,mj->ij", scaled, scaled)
    slope = np.einsum("mi,m->i", scaled, residuals)
    square[np.diag_indices_from(square)] += (damping + _LEAST) * np.mean(np.diag(square))
    lower = np.linalg.cholesky(square)
    matrix, goal = lower.T, -np.linalg.solve(lower, slope)
    low, high = np.minimum(room[0] / scale, 0.0), np.maximum(room[1] / scale, 0.0)
    step = np.zeros(len(scale))
    moves = high > low
    if moves.any():
        found = lsq_linear(matrix[:, moves], goal, (low[moves], high[moves]), method="bvls")
        step[moves] = found.x
    return step * scale


def descend(
    residuals: Callable[[FloatArray], FloatArray],
    jacobian: Callable[[FloatArray], FloatArray],
    start: FloatArray,
    bounds: tuple[FloatArray, FloatArray],
    scale: FloatArray,
    runs: int,
) -> FloatArray:
    """Find the vector of least squares near ``start``: (Q,).

    ``jacobian`` is asked only for vectors whose residuals have just been asked for, at most
    ``runs`` times.
    """
    low, high = bounds
    vector = np.clip(start, low, high)
    here = residuals(vector)
    damping = _DAMPING
    for _ in range(runs):
        slope, least = jacobian(vector), float(here @ here)
        while damping <= _MOST_DAMPING:
            step = bounded_step(slope, here, (low - vector, high - vector), scale, damping)
            trial = np.clip(vector + step, low, high)
            there = residuals(trial)
            if float(there @ there) < least:
                break
            damping *= 10.0
        else:
            break
        damping = max(0.1 * damping, 1e-6)
        vector, here = trial, there
        if float(here @ here) > (1.0 - _GAIN) * least:
            break
    return vector
