"""A changed design bent from the state of a similar one: quick, and not verified."""

from __future__ import annotations

from fem.solution import Solution
from profiletool.joints.again import posed_of
from profiletool.records.design import Design
from profiletool.records.frames import Shape
from profiletool.records.making import request_again
from profiletool.records.profile import Profile
from profiletool.verify.forward import FeForwardModel


def bent_near(design: Design, profile: Profile, known: Solution | None) -> tuple[Shape, Solution]:
    """Bend a design by finite elements at its operating pressure alone.

    Parameters
    ----------
    design : Design
    profile : Profile
    known : Solution or None
        Of a design with as many joints; None to begin from rest.

    Raises
    ------
    CannotBend
        See `profiletool.joints.correction.correct`.
    """
    asked = request_again(design, profile, refine=False)
    alike = known is not None and len(known.states[-1].theta) == len(design.joints)
    model = FeForwardModel(asked.tube, asked.model, known=known if alike else None)
    return model.bend(posed_of(design), profile.sign, None)
