"""The neighbours of a design: other numbers of joints, less pressure, and what they would give."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True)
class Neighbour:
    """What another choice near the chosen one would give.

    Attributes
    ----------
    what : str
        "as chosen", "one joint fewer", "one joint more" or "lower pressure".
    joints : int
    pressure_bar : float
    rms_mm : float
        Off the profile, with perfect parts.
    expected_rms_mm : float or None
        The same of the actuator that is built, after its pressure is set; by the joint response's
        derivatives. None where perfect parts were asked for.
    by : {"FE", "joint response", "formula"}
        What ``rms_mm`` is by. By FE it is corrected and in numbers that can be built, as a design
        is; else it is as chosen, before its numbers are rounded.
    """

    what: str
    joints: int
    pressure_bar: float
    rms_mm: float
    expected_rms_mm: float | None
    by: Literal["FE", "joint response", "formula"]
