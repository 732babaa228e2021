"""The next vector to try by a linear model of the gaps: free, or in steps that can be built.

Rounding is part of the search: each number is rounded where that costs least, what is still free
is fitted again, and in the end numbers are moved by single steps and in pairs as long as that
brings the shape nearer.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import lsq_linear

from profiletool.joints.misfit import _WEIGHT, badness
from profiletool.records.units import FloatArray

BoolArray = NDArray[np.bool_]
# mm for a change by the scale: what moves nothing stays where it is, and all is looked for
# nearby, where the model holds.
_DAMPING, _BUILT_DAMPING = 0.1, 0.05
_ROUNDS = 30


@dataclass(frozen=True)
class Linear:
    """Gaps near a vector, to first order; M gaps, q numbers.

    Attributes
    ----------
    gap : (M,) mm
        See `profiletool.joints.correction.parameters.Feet`.
    jacobian : (M, q)
    vector, centre, low, high, scale : (q,)
        Where the gaps were found, where better ones are looked for nearby, the bounds, and changes
        that matter about equally.
    interference_mm : float
        How deep the tube may lie in the object.
    """

    gap: FloatArray
    jacobian: FloatArray
    vector: FloatArray
    centre: FloatArray
    low: FloatArray
    high: FloatArray
    scale: FloatArray
    interference_mm: float

    def predicted(self, vector: FloatArray) -> FloatArray:
        """Gaps (M,) at another vector."""
        gap: FloatArray = self.gap + self.jacobian @ (vector - self.vector)
        return gap


def free_step(
    model: Linear,
    reach: FloatArray,
    held: BoolArray | None = None,
    at: FloatArray | None = None,
    damping_mm: float = _DAMPING,
) -> FloatArray:
    """Best vector (q,) within the bounds and ``reach`` (q,) of the model's centre.

    Where ``held`` is true, numbers stay as they are in ``at``.
    """
    at = model.vector if at is None else at
    free = np.ones(len(at), dtype=bool) if held is None else ~held
    found = at.copy()
    if not free.any():
        return found
    low = np.maximum(model.low, model.centre - reach)[free]
    high = np.minimum(model.high, model.centre + reach)[free]
    high = np.maximum(high, low + 1e-9)
    base = np.where(free, model.vector, at)
    gap, jacobian = model.predicted(base), model.jacobian[:, free] * model.scale[free]
    start = model.vector[free]
    damping = damping_mm * np.sqrt(len(gap)) * np.eye(int(free.sum()))
    away = (start - model.centre[free]) / model.scale[free]
    deep = np.zeros(len(gap), dtype=bool)
    for _ in range(5):
        extra = np.sqrt(_WEIGHT)
        A = np.concatenate([jacobian, damping, extra * jacobian[deep]])
        b = np.concatenate([gap, damping @ away, extra * (gap + model.interference_mm)[deep]])
        bounds = ((low - start) / model.scale[free], (high - start) / model.scale[free])
        change = lsq_linear(A, -b, bounds, method="bvls").x
        now = gap + jacobian @ change < -model.interference_mm
        if (now == deep).all():
            break
        deep = now
    found[free] = np.clip(start + change * model.scale[free], low, high)
    return found


def built_step(model: Linear, step: FloatArray, reach: FloatArray) -> FloatArray:
    """Best vector (q,) whose numbers are multiples of ``step`` (q,); 0 leaves a number free.

    All stay within ``reach`` (q,) of the model's centre.
    """
    discrete = step > 0.0
    if not discrete.any():
        return free_step(model, reach)
    size = np.where(discrete, step, 1.0)
    low, high = np.ceil(model.low / size - 1e-9), np.floor(model.high / size + 1e-9)
    low = np.clip(np.ceil((model.centre - reach) / size - 1e-9), low, high)
    high = np.clip(np.floor((model.centre + reach) / size + 1e-9), low, high)
    strength = np.linalg.norm(model.jacobian, axis=0) * size
    held = np.zeros(len(step), dtype=bool)
    found = free_step(model, reach, damping_mm=_BUILT_DAMPING)
    while (discrete & ~held).any():
        whole = np.clip(np.round(found / size), low, high)
        cost = np.where(discrete & ~held, np.abs(whole - found / size) * strength, np.inf)
        k = int(np.argmin(cost))
        found[k] = whole[k] * size[k]
        held[k] = True
        found = free_step(model, reach, held, found, _BUILT_DAMPING)
    found = _searched(model, found, discrete, size, low, high)
    return free_step(model, reach, discrete, found)


def _searched(
    model: Linear,
    found: FloatArray,
    discrete: BoolArray,
    size: FloatArray,
    low: FloatArray,
    high: FloatArray,
) -> FloatArray:
    """Move single numbers and pairs by one step as long as that helps; the free ones follow."""
    basis = np.linalg.qr(model.jacobian[:, ~discrete])[0]
    where = np.flatnonzero(discrete)
    unit = [(k, way) for k in where.tolist() for way in (1.0, -1.0)]
    moves = [[one] for one in unit] + [[a, b] for a, b in combinations(unit, 2) if a[0] != b[0]]
    change = np.zeros((len(moves), len(found)))
    for row, move in zip(change, moves, strict=True):
        for k, way in move:
            row[k] = way * size[k]
    shifts = change @ model.jacobian.T
    shifts = shifts - (shifts @ basis) @ basis.T
    weight = _BUILT_DAMPING / model.scale

    def worth(gaps: FloatArray, vectors: FloatArray) -> FloatArray:
        far = ((vectors - model.centre) * weight)[..., discrete]
        total: FloatArray = badness(gaps, model.interference_mm) + np.sum(far**2, axis=-1)
        return total

    gap = model.predicted(found)
    gap = gap - basis @ (basis.T @ gap)
    best = float(worth(gap, found))
    for _ in range(_ROUNDS):
        there = (found + change) / size
        allowed = ((there >= low - 1e-6) & (there <= high + 1e-6))[:, where].all(axis=1)
        values = np.where(allowed, worth(gap + shifts, found + change), np.inf)
        k = int(np.argmin(values))
        if not values[k] < best - 1e-9:
            break
        best, found, gap = float(values[k]), found + change[k], gap + shifts[k]
    return found
