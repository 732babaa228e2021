"""A changed design bent from the state of a similar one: quick, and not verified."""

from __future__ import annotations

from fem.rates import Sensitivities
from fem.sensitivity import sensitivities
from fem.solution import Solution
from profiletool.joints.again import posed_of
from profiletool.records.design import Design
from profiletool.records.frames import Shape
from profiletool.records.making import request_again
from profiletool.records.profile import Profile
from profiletool.verify.forward import FeForwardModel


class NearBench:
    """What bends designs that differ a little, each from the state of the one before."""

    def __init__(self) -> None:
        self._known: Solution | None = None
        self._rates: Sensitivities | None = None

    def bend(self, design: Design, profile: Profile) -> tuple[Shape, Solution]:
        """Bend a design by finite elements at its operating pressure alone.

        Raises
        ------
        CannotBend
            See `profiletool.joints.correction.correct`.
        """
        asked, known = request_again(design, profile, refine=False), self._known
        if known is not None and len(known.states[-1].theta) != len(design.joints):
            known = None
        model = FeForwardModel(asked.tube, asked.model, known=known, rates=self._rates)
        shape, self._known = model.bend(posed_of(design), profile.sign, None)
        self._rates = None
        return shape, self._known

    def prepare(self) -> None:
        """Differentiate the last state, for the next one to begin nearer; some time's work."""
        if self._known is not None and self._rates is None:
            state = self._known.states[-1]
            self._rates = sensitivities(
                self._known.mesh, state.x, state.pressure, angles=False, tube=False
            )
