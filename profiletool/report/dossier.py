"""The dossier: everything that the report tells, gathered from a result."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from profiletool.joints.optimal.choose import TradeOff
from profiletool.pipeline import Result
from profiletool.records.design import Design
from profiletool.records.fe import Verification
from profiletool.records.frames import Shape
from profiletool.records.grip import Grip
from profiletool.records.request import Request
from profiletool.records.seal import proven
from profiletool.report.asked import options_of
from profiletool.report.plots import Mark
from profiletool.report.scene import Scene
from profiletool.report.tables import AskedOption
from profiletool.verify.check import Check


@dataclass(frozen=True)
class Dossier:
    """Everything that the report tells.

    Attributes
    ----------
    scene : Scene
        The object with the tube beside it; its design is the report's.
    by_formula : Shape
        The tube as the formula bends it.
    check : Check or None
        The finite-element run; None where none was asked for.
    reasons : tuple of str
        Why the design is infeasible; none where it is feasible.
    marks : sequence of Mark
        Angles to compare those of finite elements with.
    trade_off : TradeOff or None
    template_svg : str
        The cut template, as its file has it.
    options : sequence of AskedOption
        What was asked for.
    most_bar : float
        Highest pressure that was asked for.
    request : Request
    grip : Grip or None
        The finger on its object.
    """

    scene: Scene
    by_formula: Shape
    check: Check | None
    reasons: tuple[str, ...]
    marks: Sequence[Mark]
    trade_off: TradeOff | None
    template_svg: str
    options: Sequence[AskedOption]
    most_bar: float
    request: Request
    grip: Grip | None = None

    @property
    def found(self) -> Verification | None:
        """Results of finite elements; None where they were not run."""
        run = None if self.check is None else self.check.run
        return None if run is None else run.verification

    @property
    def unverified(self) -> str | None:
        """Why the design is not verified; None where it is."""
        design = self.scene.design
        if proven(design):
            return None
        if design.verified:
            return "it was changed since finite elements verified it"
        if self.check is None or self.check.failure is None:
            return "no finite-element run has checked this design"
        return f"finite elements: {self.check.failure}"


def dossier_of(result: Result, scene: Scene, template_svg: str) -> Dossier:
    """Gather what the report tells; the scene and the template are those of the other files."""
    return Dossier(
        scene=scene,
        by_formula=result.shape,
        check=result.check,
        reasons=result.reasons,
        marks=formula_marks(result.design),
        trade_off=result.plan.trade_off,
        template_svg=template_svg,
        options=options_of(result.request),
        most_bar=result.request.tube.max_pressure_bar,
        grip=result.grip,
        request=result.request,
    )


def formula_marks(design: Design) -> tuple[Mark, ...]:
    """Angles by the formula at the operating pressure, to compare with those of FE."""
    angles = [joint.signed(joint.theta_formula_deg) for joint in design.joints]
    label = f"formula, {design.pressure_bar:.2f} bar"
    return (Mark(label, design.pressure_bar, angles),)
