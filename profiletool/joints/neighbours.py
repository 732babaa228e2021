"""What a joint's neighbours, the clamped end and the closed end do to its bending and stretch.

A wrapped sector of a few millimetres does not isolate what lies on its two sides: its threads
take up their load by shear in the rubber, over some tens of millimetres. To good approximation
a joint keeps the form of its fields; they are only scaled, its turn by one factor, its stretch by
another. The logarithms of both factors are sums over the joint's two sides, of polynomials in the
joint's and its neighbour's sizes that fade out with the wrapped length in between. Fitted to
finite elements of pairs and of random actuators.

Glossary
--------
n : joints;  2 n : sides, all those toward the clamped end first
K : kinds of neighbour;  G : fading functions of the gap;  T : terms of a polynomial
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from profiletool.joints.model import Chain
from profiletool.records import FloatArray

SAME, OPPOSITE, CLAMPED, CLOSED = range(4)  # kinds of neighbour
FADING_MM = (2.5, 8.0, 25.0)
PLUG_MM = 1.0  # rigid at the closed end
# Middle and half width of the ranges: alpha in rad, openF in mm, pressure in MPa.
_ALPHA, _OPENF, _PRESSURE = (2.2, 0.95), (10.0, 6.0), (0.13, 0.09)
_VARIABLES = 5
TERMS = 1 + _VARIABLES + _VARIABLES * (_VARIABLES + 1) // 2
_FIRST, _SECOND = np.triu_indices(_VARIABLES)


@dataclass(frozen=True)
class Sides:
    """What lies on both sides of every joint.

    Attributes
    ----------
    gap : (2 n,) mm
        Wrapped length up to the neighbour's cut, the clamped end or the plug.
    kind : (2 n,) int
        SAME or OPPOSITE neighbour, CLAMPED or CLOSED end.
    sizes : (2 n, 5)
        alpha and openF of the joint, of its neighbour (0 at an end), and the pressure; each from
        -1 to 1.
    """

    gap: FloatArray
    kind: NDArray[np.intp]
    sizes: FloatArray


@dataclass(frozen=True)
class Neighbours:
    """The fitted influence; ``coefficients`` (K, G * T, 2) for turn and stretch."""

    coefficients: FloatArray

    def log_factors(self, chain: Chain, pressure: float) -> FloatArray:
        """Logarithm of the factors on turn and stretch: (n, 2)."""
        if len(chain.centre) == 0:
            return np.empty((0, 2))
        beside = sides_of(chain, pressure)
        parts = np.einsum("st,stk->sk", terms(beside), self.coefficients[beside.kind])
        factors: FloatArray = parts.reshape(2, -1, 2).sum(axis=0)
        return factors


def sides_of(chain: Chain, pressure: float) -> Sides:
    """Look to both sides of every joint of a chain of the tabulated tube; pressure in MPa."""
    n = len(chain.centre)
    start, end = chain.centre - 0.5 * chain.openF, chain.centre + 0.5 * chain.openF
    ends = np.concatenate([[0.0], end]), np.concatenate([start, [chain.length - PLUG_MM]])
    gap = ends[1] - ends[0]
    same = np.where(chain.sense[1:] * chain.sense[:-1] > 0.0, SAME, OPPOSITE)
    alpha, openF = _unit(chain.alpha, _ALPHA), _unit(chain.openF, _OPENF)
    none = np.zeros(1)
    sizes = np.empty((2 * n, _VARIABLES))
    sizes[:, 0], sizes[:, 1] = np.tile(alpha, 2), np.tile(openF, 2)
    sizes[:, 2] = np.concatenate([none, alpha[:-1], alpha[1:], none])
    sizes[:, 3] = np.concatenate([none, openF[:-1], openF[1:], none])
    sizes[:, 4] = (pressure - _PRESSURE[0]) / _PRESSURE[1]
    return Sides(
        gap=np.concatenate([gap[:-1], gap[1:]]),
        kind=np.concatenate([[CLAMPED], same, same, [CLOSED]]),
        sizes=sizes,
    )


def terms(sides: Sides) -> FloatArray:
    """Fading functions times all terms up to the second power: (2 n, G * T)."""
    u = sides.sizes
    powers = np.concatenate([np.ones((len(u), 1)), u, u[:, _FIRST] * u[:, _SECOND]], axis=1)
    fading = np.exp(-sides.gap[:, None] / np.array(FADING_MM))
    both: FloatArray = fading[:, :, None] * powers[:, None, :]
    return both.reshape(len(u), -1)


def _unit(values: FloatArray, about: tuple[float, float]) -> FloatArray:
    unit: FloatArray = (values - about[0]) / about[1]
    return unit
