"""The plan of joints that either method gives."""

from __future__ import annotations

from dataclasses import dataclass

from profiletool.bending.model import Model
from profiletool.joints.layout import Layout
from profiletool.joints.optimal.choose import Choice, TradeOff
from profiletool.joints.paper.pieces import Rules
from profiletool.joints.paper.sectors import BendingSector
from profiletool.records.frames import Shape
from profiletool.records.units import FloatArray


@dataclass(frozen=True)
class Plan:
    """Joints for a profile.

    Attributes
    ----------
    layout : Layout
    by : str
        What the joints were chosen by: "formula" or "joint response".
    bent : Shape
        The tube as that bends it.
    places : (n,) mm
        Where the joints lie along the profile.
    notes : tuple of str
    sectors : tuple of BendingSector
    rules : Rules or None
        Of the paper's method; empty and None for the other.
    choice : Choice or None
    model : Model or None
        Of the optimal method.
    """

    layout: Layout
    by: str
    bent: Shape
    places: FloatArray
    notes: tuple[str, ...] = ()
    sectors: tuple[BendingSector, ...] = ()
    rules: Rules | None = None
    choice: Choice | None = None
    model: Model | None = None

    @property
    def trade_off(self) -> TradeOff | None:
        """The gain of more joints and more pressure; None for the paper's method."""
        return None if self.choice is None else self.choice.trade_off
