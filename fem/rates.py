"""Derivatives of a state by its inputs, and what follows from them to first order."""

from __future__ import annotations

from dataclasses import dataclass

from fem.actuator import Actuator
from fem.arrays import FloatArray


@dataclass(frozen=True)
class Rate:
    """Derivatives by one parameter.

    Attributes
    ----------
    theta : (joints,) rad per unit
    facing : (layers + 1, 3) mm per unit
        Of the object-facing line at the rings, which move along the tube with the parameter.
    z : (layers + 1,) mm per unit
        Of the rings' places along the tube.
    volume : float, mm^3 per unit
    moved : (layers + 1, ring + mid, 3) mm per unit
        Of all nodes, which move along the tube with the parameter.
    """

    theta: FloatArray
    facing: FloatArray
    z: FloatArray
    volume: float
    moved: FloatArray

    def __neg__(self) -> Rate:
        """By the parameter with its sign changed."""
        return Rate(*(-value for value in vars(self).values()))

    def plus(self, other: Rate, factor: float) -> Rate:
        """By this parameter and a multiple of another one together."""
        pairs = zip(vars(self).values(), vars(other).values(), strict=True)
        return Rate(*(one + factor * more for one, more in pairs))


@dataclass(frozen=True)
class Sensitivities:
    """Derivatives of one state by its inputs.

    Attributes
    ----------
    pressure : Rate, per MPa
    alpha : tuple of Rate, per rad
        By each joint's alpha_closed.
    openF : tuple of Rate, per mm
        By each cut's length, the wrapped lengths kept.
    wrapped : tuple of Rate, per mm
        By the length of each wrapped sector, the cuts' lengths kept; the first is the root's.
    wall : Rate, per mm
        By the wall's thickness, the outer diameter kept.
    gauze : Rate, per share of itself
        By the threads' stiffness.
    """

    pressure: Rate
    alpha: tuple[Rate, ...]
    openF: tuple[Rate, ...]
    wrapped: tuple[Rate, ...]
    wall: Rate
    gauze: Rate

    def rubber(self, pressure: float) -> Rate:
        """Give derivatives by the rubber's stiffness, per share of itself, at a pressure in MPa.

        By dimensional analysis: rubber, gauze and pressure in proportion give the same shape.
        Where gravity or the like acts as well, its share is left out.
        """
        return (-self.gauze).plus(self.pressure, -pressure)


def flow_to(rates: Sensitivities, known: Actuator, new: Actuator, rise: float) -> FloatArray:
    """Motion of the nodes from a known actuator to a similar one, to first order, mm.

    Parameters
    ----------
    rates : Sensitivities
        Of the known actuator's state.
    known, new : Actuator
        With as many windows, and the same but for lengths and angles.
    rise : float
        Of the pressure, MPa.

    Returns
    -------
    (layers + 1, ring + mid, 3)
    """
    flow = rise * rates.pressure.moved
    for rate, v, w in zip(rates.alpha, known.windows, new.windows, strict=True):
        flow = flow + (w.alpha - v.alpha) * rate.moved
    for rate, v, w in zip(rates.openF, known.windows, new.windows, strict=True):
        flow = flow + (w.openF - v.openF) * rate.moved
    for rate, (a, b), (c, d) in zip(rates.wrapped, known.wrapped, new.wrapped, strict=True):
        flow = flow + ((d - c) - (b - a)) * rate.moved
    return flow
