"""The surrogate of a forward model near an actuator that it has bent: it agrees with it there."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from profiletool.bending.model import Model
from profiletool.joints.closest import closest_points, distance_jacobian
from profiletool.joints.correction.parameters import Parameters, facing_motion
from profiletool.joints.correction.steps import Linear, built_step, free_step
from profiletool.joints.expected import Expected, ExpectedRows
from profiletool.records.units import FloatArray

_REACH = 3.0  # steps over the scale
_ROUNDS = 5  # of a search


@dataclass(frozen=True)
class _Bent:
    """Distances (M,), their derivatives (M, q) and what errors cost, by the model."""

    distance: FloatArray
    jacobian: FloatArray
    errors: ExpectedRows | None


@dataclass(frozen=True)
class Surrogate:
    """A forward model near one of its iterates, by a cheaper bending model.

    The bending model's distances are shifted so that they and their derivatives agree with the
    forward model's at the iterate; what remains of the bending model is how the derivatives change
    from there.

    Attributes
    ----------
    linear : Linear
        Distances and derivatives at the iterate, by the forward model.
    parameters : Parameters
    model : Model
        The bending model.
    points : (M, 2) mm
        Of the profile.
    expected : Expected or None
        What errors of a build cost, where they count.
    """

    linear: Linear
    parameters: Parameters
    model: Model
    points: FloatArray
    expected: Expected | None = None

    def free(self, share: float) -> tuple[FloatArray, float]:
        """Find the best vector within a share of the reach, and the cost it promises."""
        reach = share * _REACH * self.linear.scale
        return self._sought(lambda linear: free_step(linear, reach))

    def built(self, step: FloatArray) -> tuple[FloatArray, float]:
        """Find the best vector among multiples of ``step`` (size,), and the cost it promises."""
        reach = _REACH * self.linear.scale
        # Coarse steps stay next to where the model holds best.
        reach = np.where(step > 0.5 * self.linear.scale, np.minimum(step, reach), reach)
        return self._sought(lambda linear: built_step(linear, step, reach))

    def below(self, pressure: float) -> Surrogate:
        """Keep to pressures below one, MPa."""
        k = 2 * self.parameters.joints
        high = self.linear.high.copy()
        high[k] = max(min(high[k], pressure), self.linear.low[k])
        return replace(self, linear=replace(self.linear, high=high))

    def broyden_update(self, vector: FloatArray, distance: FloatArray) -> Surrogate:
        """Correct the derivatives by the distances, (M,), that were found at another vector.

        The least change, counted in the numbers' scales, that makes them agree (Broyden 1965).
        """
        error = distance - self._near(self._bent(vector), vector).distance
        way = (vector - self.linear.vector) / self.linear.scale
        change = np.outer(error, way / self.linear.scale) / float(way @ way)
        return replace(self, linear=replace(self.linear, jacobian=self.linear.jacobian + change))

    def _sought(self, step: Callable[[Linear], FloatArray]) -> tuple[FloatArray, float]:
        base = self.linear
        best, least = step(base), np.inf
        at = best
        for _ in range(_ROUNDS):
            near = self._near(self._bent(at), at)
            promised = float(near.cost(near.distance, at))
            if promised < least:
                best, least = at, promised
            after = step(near)
            if np.allclose(after, at, atol=1e-4 * base.scale.min()):
                break
            at = after
        return best, least

    @cached_property
    def _base(self) -> _Bent:
        return self._bent(self.linear.vector)

    def _bent(self, vector: FloatArray) -> _Bent:
        """Bend the actuator of a vector by the model alone."""
        at = self.parameters.unpack(vector)
        shape = self.model.shape(at.chain, at.pressure, at.pose, self.parameters.sign)
        closest = closest_points(shape.facing, self.points, self.parameters.sign)
        motion = facing_motion(self.parameters, self.model, vector, shape)
        errors = None
        if self.expected is not None:
            errors = self.expected.rows(self.parameters, vector, shape, closest)
        return _Bent(closest.distance, distance_jacobian(closest, motion), errors)

    def _near(self, bent: _Bent, vector: FloatArray) -> Linear:
        """Distances and derivatives at another vector: the model's, shifted."""
        base, model = self.linear, self._base
        slope = base.jacobian - model.jacobian
        shift = base.distance - model.distance + slope @ (vector - base.vector)
        return replace(
            base,
            vector=vector,
            distance=bent.distance + shift,
            jacobian=bent.jacobian + slope,
            errors=bent.errors,
        )
