"""A change of a design by hand."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Edit:
    """A change by hand; None leaves a number as it is.

    Attributes
    ----------
    joint : int or None
        Its number; None where the pressure alone is changed.
    alpha_deg, openF_mm : float or None
    move_mm : float or None
        By which the joint moves along the tube, toward the closed end; its neighbours stay.
    pressure_bar : float or None
    """

    joint: int | None = None
    alpha_deg: float | None = None
    openF_mm: float | None = None
    move_mm: float | None = None
    pressure_bar: float | None = None
