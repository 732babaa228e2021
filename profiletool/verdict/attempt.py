"""An attempt at a design: the plan, the design and its finite-element run, to be judged."""

from __future__ import annotations

from dataclasses import dataclass

from formula.theta import Formula
from profiletool.joints.plan import Plan
from profiletool.records.design import Design
from profiletool.records.frames import Shape
from profiletool.records.profile import Profile
from profiletool.records.request import Request
from profiletool.subject.find import Subject
from profiletool.verify.check import Check


@dataclass(frozen=True)
class Attempt:
    """A design before its verdict, with everything that it was made from.

    Attributes
    ----------
    request : Request
    subject : Subject
    formula : Formula
    plan : Plan
    design : Design
    shape : Shape
        The tube as the formula bends it.
    check : Check or None
        The finite-element run; None where none was asked for.
    """

    request: Request
    subject: Subject
    formula: Formula
    plan: Plan
    design: Design
    shape: Shape
    check: Check | None

    @property
    def profile(self) -> Profile:
        """The target profile."""
        return self.subject.profile

    @property
    def best_shape(self) -> Shape:
        """The tube as finite elements bend it, else as the joints were chosen by."""
        return (self.check.shape if self.check is not None else None) or self.plan.bent
