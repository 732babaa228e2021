"""The forward model by finite elements, for `profiletool.joints.correction.correct`.

Every state but the first is found from a similar actuator's, and the sensitivities are FE's own,
by direct differentiation.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from fem.actuator import Actuator
from fem.errors import BadGeometry, NotConverged
from fem.mesh import Mesh
from fem.near import solve_near
from fem.rates import Rate, Sensitivities, flow_to
from fem.sensitivity import sensitivities
from fem.solution import Solution
from fem.solver import solve
from profiletool.joints.correction.correct import CannotBend, Iterate
from profiletool.joints.correction.parameters import PosedChain
from profiletool.records.frames import Shape, base_axes
from profiletool.records.model import PAPER_MODEL, ModelInputs
from profiletool.records.request import TubeSpec
from profiletool.records.units import FloatArray
from profiletool.verify.lines import on_line, shape_of
from profiletool.verify.run import ended, said, shortly
from profiletool.verify.tube import tube_of


class FeForwardModel:
    """A forward model by finite elements of the whole actuator.

    ``told`` is called before each is bent; ``known`` is the solution of a similar one to begin
    from, ``rates`` its sensitivities, which make that surer.
    """

    def __init__(
        self,
        spec: TubeSpec,
        model: ModelInputs = PAPER_MODEL,
        told: Callable[[], None] | None = None,
        known: Solution | None = None,
        rates: Sensitivities | None = None,
    ) -> None:
        self._spec, self._model, self._told, self._known = spec, model, told, known
        self._rates: tuple[Solution, Sensitivities] | None = None  # the last ones found
        if known is not None and rates is not None:
            self._rates = known, rates

    def bend(
        self, posed: PosedChain, sign: float, near: Iterate[Solution] | None
    ) -> tuple[Shape, Solution]:
        """Bend an actuator, from a similar one's state where that leads there."""
        if self._told is not None:
            self._told()
        try:
            axes = base_axes(float(np.radians(posed.pose.heading_deg)), sign)
            tube = tube_of(posed.chain, self._spec, self._model, axes)
            known = self._known if near is None else near.state
            solution = self._solved(tube, known, posed.pressure)
        except NotConverged as error:
            raise CannotBend(shortly(error), error.reached) from error
        except BadGeometry as error:
            raise CannotBend(f"cannot be modelled: {error}", 0.0) from error
        if solution.critical is not None:
            raise CannotBend(said(ended(solution.critical)), solution.critical.pressure)
        return shape_of(solution.mesh, solution.states[-1], posed.pose, sign), solution

    def motion(self, iterate: Iterate[Solution]) -> FloatArray:
        """Motion of the object-facing line's points by each number: (size, N, 2)."""
        rates = rates_of(iterate)
        self._rates = (iterate.state, rates)
        return motion_of(iterate, rates)

    def _solved(self, tube: Actuator, known: Solution | None, pressure: float) -> Solution:
        if known is not None:
            flow = None
            if self._rates is not None and self._rates[0] is known:
                rise = pressure - known.states[-1].pressure
                flow = flow_to(self._rates[1], known.mesh.actuator, tube, rise)
            try:
                return solve_near(tube, known, pressure, flow=flow)
            except NotConverged:
                pass  # too far off: all the way from rest, then
        return solve(tube, [pressure])


def rates_of(iterate: Iterate[Solution]) -> Sensitivities:
    """Differentiate an iterate's state."""
    solution = iterate.state
    x, pressure = solution.states[-1].x, iterate.posed.pressure
    return sensitivities(solution.mesh, x, pressure, angles=False, tube=False)


def motion_of(iterate: Iterate[Solution], rates: Sensitivities) -> FloatArray:
    """Differentiate the object-facing line's points by each number of the vector: (size, N, 2)."""
    parameters, shape = iterate.parameters, iterate.shape
    solution, at = iterate.state, iterate.posed
    heading = np.radians(at.pose.heading_deg)
    along, outward = base_axes(float(heading), parameters.sign)

    def placed(rate: Rate) -> FloatArray:
        return placed_motion(rate, shape, solution.mesh, (along, outward))

    grows = parameters.root_grows(iterate.vector)
    slide = placed(rates.wrapped[0]) if grows else np.broadcast_to(along, shape.facing.shape)
    rows = [*_inner(rates, placed), slide, placed(rates.pressure)]
    if parameters.limits.base_free:
        arm = shape.facing - parameters.start
        rows.append(parameters.sign * np.column_stack([-arm[:, 1], arm[:, 0]]))
        rows.append(np.broadcast_to(outward, shape.facing.shape))
    return np.stack(rows)


def _inner(rates: Sensitivities, placed: Callable[[Rate], FloatArray]) -> list[FloatArray]:
    return [placed(rate) for rate in (*rates.alpha, *rates.wrapped[1:-1])]


def placed_motion(
    rate: Rate, shape: Shape, mesh: Mesh, axes: tuple[FloatArray, FloatArray]
) -> FloatArray:
    """Motion of a line's points in the object frame per unit: (N, 2).

    ``axes`` are unit vectors along the clamped tube and away from the object.
    """
    moved = on_line(mesh, rate.moved, shape.along)
    placed: FloatArray = moved[:, 2, None] * axes[0] + moved[:, 1, None] * axes[1]
    return placed
