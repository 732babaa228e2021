"""The forward model of a correction by the bending model that joints are chosen by."""

from __future__ import annotations

from profiletool.bending.model import Model
from profiletool.joints.correction.correct import Iterate
from profiletool.joints.correction.parameters import PosedChain, facing_motion
from profiletool.records.frames import Shape
from profiletool.records.units import FloatArray


class BendingForwardModel:
    """A forward model by a `profiletool.bending.model.Model`."""

    def __init__(self, model: Model) -> None:
        self._model = model

    def bend(
        self, posed: PosedChain, sign: float, near: Iterate[None] | None
    ) -> tuple[Shape, None]:
        """Bend an actuator."""
        return self._model.shape(posed.chain, posed.pressure, posed.pose, sign), None

    def motion(self, iterate: Iterate[None]) -> FloatArray:
        """Motion of the object-facing line's points by each number: (size, N, 2)."""
        return facing_motion(iterate.parameters, self._model, iterate.vector, iterate.shape)
