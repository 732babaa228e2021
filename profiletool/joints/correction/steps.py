"""Steps of a correction by a linear model of the distances: free, or in numbers to be built.

Rounding is part of the search: each number is rounded where that costs least, what is still free
is fitted again, and in the end numbers are moved by single steps and in pairs as long as that
brings the shape nearer.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np
from scipy.optimize import lsq_linear

from profiletool.joints.expected import ExpectedRows
from profiletool.joints.misfit import Deviation, Objective
from profiletool.records.units import BoolArray, FloatArray

# mm for a change by the scale: what moves nothing stays where it is, and all is looked for
# nearby, where the model holds.
_DAMPING, _BUILT_DAMPING = 0.1, 0.05
_ROUNDS = 30
_ACTIVE_ROUNDS = 5  # in which the one-sided terms settle what counts


@dataclass(frozen=True)
class Linear:
    """Signed distances near a vector, to first order; M distances, q numbers.

    Attributes
    ----------
    distance : (M,) mm
        See `profiletool.joints.closest.ClosestPoints`.
    jacobian : (M, q)
    vector, centre, low, high, scale : (q,)
        Where the distances were found, where better ones are looked for nearby, the bounds, and
        changes that matter about equally.
    objective : Objective
    errors : ExpectedRows or None
        What errors of a build cost at ``vector``.
    """

    distance: FloatArray
    jacobian: FloatArray
    vector: FloatArray
    centre: FloatArray
    low: FloatArray
    high: FloatArray
    scale: FloatArray
    objective: Objective
    errors: ExpectedRows | None = None

    def predicted(self, vector: FloatArray) -> FloatArray:
        """Distances (M,) at another vector."""
        distance: FloatArray = self.distance + self.jacobian @ (vector - self.vector)
        return distance

    def cost(self, distances: FloatArray, vectors: FloatArray) -> FloatArray:
        """Cost, mm², of distances (..., M) and of errors at vectors (..., q)."""
        total: FloatArray = self.objective.cost(Deviation(distances))
        if self.errors is not None:
            total = total + np.sum(self.errors.moved(vectors - self.vector) ** 2, axis=-1)
        return total


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
    best = at.copy()
    if not free.any():
        return best
    low = np.maximum(model.low, model.centre - reach)[free]
    high = np.minimum(model.high, model.centre + reach)[free]
    high = np.maximum(high, low + 1e-9)
    base = np.where(free, model.vector, at)
    here = Deviation(model.predicted(base), model.jacobian[:, free] * model.scale[free])
    start = model.vector[free]
    many = np.sqrt(len(here.distance))
    damping = damping_mm * many * np.eye(int(free.sum()))
    away = (start - model.centre[free]) / model.scale[free]
    rows, values = damping, damping @ away
    if model.errors is not None:
        errors = model.errors.scaled(many)
        rows = np.vstack([rows, errors.jacobian[:, free] * model.scale[free]])
        values = np.append(values, errors.moved(base - model.vector))
    bounds = ((low - start) / model.scale[free], (high - start) / model.scale[free])
    change = _least_squares(model.objective, here, (rows, values), bounds)
    best[free] = np.clip(start + change * model.scale[free], low, high)
    return best


def _least_squares(
    objective: Objective,
    here: Deviation,
    others: tuple[FloatArray, FloatArray],
    bounds: tuple[FloatArray, FloatArray],
) -> FloatArray:
    """Give the change of numbers, (q,), that makes the objective and the other rows least.

    One-sided terms: the rows that count are those that counted after the change before.
    """
    plain = [term for term in objective.shape if term.counts == "both"]
    one_sided = [term for term in objective.shape if term.counts != "both"]
    always = [term.linear(here, term.active(here)) for term in plain]
    active = [np.zeros(len(here.distance), dtype=bool) for _ in one_sided]
    for _ in range(_ACTIVE_ROUNDS):
        parts = zip(one_sided, active, strict=True)
        rows = [*always, others, *(term.linear(here, where) for term, where in parts)]
        A, b = (np.concatenate([row[k] for row in rows]) for k in (0, 1))
        change = lsq_linear(A, -b, bounds, method="bvls").x
        now = [term.active(here.moved(change)) for term in one_sided]
        if all(np.array_equal(a, b) for a, b in zip(now, active, strict=True)):
            break
        active = now
    return np.asarray(change, dtype=float)


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
    best = free_step(model, reach, damping_mm=_BUILT_DAMPING)
    while (discrete & ~held).any():
        whole = np.clip(np.round(best / size), low, high)
        cost = np.where(discrete & ~held, np.abs(whole - best / size) * strength, np.inf)
        k = int(np.argmin(cost))
        best[k] = whole[k] * size[k]
        held[k] = True
        best = free_step(model, reach, held, best, _BUILT_DAMPING)
    best = _local_search(model, best, discrete, size, low, high)
    return free_step(model, reach, discrete, best)


def _local_search(
    model: Linear,
    best: FloatArray,
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
    change = np.zeros((len(moves), len(best)))
    for row, move in zip(change, moves, strict=True):
        for k, way in move:
            row[k] = way * size[k]
    shifts = change @ model.jacobian.T
    shifts = shifts - (shifts @ basis) @ basis.T
    weight = _BUILT_DAMPING / model.scale

    def cost(distances: FloatArray, vectors: FloatArray) -> FloatArray:
        far = ((vectors - model.centre) * weight)[..., discrete]
        total: FloatArray = model.cost(distances, vectors) + np.sum(far**2, axis=-1)
        return total

    distance = model.predicted(best)
    distance = distance - basis @ (basis.T @ distance)
    least = float(cost(distance, best))
    for _ in range(_ROUNDS):
        there = (best + change) / size
        allowed = ((there >= low - 1e-6) & (there <= high + 1e-6))[:, where].all(axis=1)
        values = np.where(allowed, cost(distance + shifts, best + change), np.inf)
        k = int(np.argmin(values))
        if not values[k] < least - 1e-9:
            break
        least, best, distance = float(values[k]), best + change[k], distance + shifts[k]
    return best
