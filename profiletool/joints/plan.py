"""The plan of joints that either method gives."""

from __future__ import annotations

from dataclasses import dataclass

from profiletool.bending.model import Model
from profiletool.joints.layout import Layout
from profiletool.joints.optimal.choose import Choice, TradeOff
from profiletool.joints.paper.pieces import Rules
from profiletool.joints.paper.sectors import BendingSector
from profiletool.records.frames import Shape
from profiletool.records.request import Request
from profiletool.records.units import FloatArray

GOOD_SHARE = 0.01  # of the profile's length: RMS of a shape that is called good
_TOO_LONG = 1.1  # times the longest tube: rubber stretches by less
_TOO_FAR = 8.0  # times an RMS that will do: finite elements mend a few per cent of the angles


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
    hopeless : str
        Why finite elements would be wasted on it: so long a profile, or so poor a fit, that no
        correction helps; "" where they are not.
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
    hopeless: str = ""

    @property
    def trade_off(self) -> TradeOff | None:
        """The gain of more joints and more pressure; None for the paper's method."""
        return None if self.choice is None else self.choice.trade_off


def out_of_reach(length_mm: float, rms_mm: float, request: Request) -> str:
    """Say why no correction makes a design of joints, "" where one may.

    Parameters
    ----------
    length_mm : float
        Of the profile.
    rms_mm : float
        How far off it the joints bend by what they were chosen by.
    request : Request
    """
    longest = request.tube.max_length_mm
    if length_mm > _TOO_LONG * longest:
        return (
            f"the profile is {length_mm:.0f} mm long and the tube at most {longest:g} mm: no "
            "finite elements were run; shorten the stretch (`start_pct`, `end_pct`), or raise "
            "`max_length_mm`"
        )
    limit = request.tolerance_mm or GOOD_SHARE * length_mm
    if rms_mm > _TOO_FAR * limit:
        return (
            f"the joints chosen lie {rms_mm:.1f} mm RMS off the profile, where {limit:.2f} mm will "
            "do: no finite elements were run"
        )
    return ""
