"""Influence of neighbours, of the clamped end and of the closed end on a joint's turn and stretch.

A cut lets the sections at its two edges warp: the threads that it severs move apart further than
those of the uncut sector. Wrapped sectors resist, by shear in the rubber; threads that are stiff
along the axis carry the warping over some tens of millimetres, so neighbours see each other's.
To good approximation a joint keeps the form of its fields; they are only scaled, its turn by one
factor, its stretch by another, and those follow from how far its edges warp apart compared with
the joint alone.

Every mode of warping is a chain of springs: the edges of the cuts are its nodes, wrapped sectors
join them as shear-lag bars (fixed at the clamped end and at the plug), cuts as springs that are
stretched by what the cut wants to warp. Odd modes change their sign with the side that a joint
bends to, even ones do not. The numbers of the modes are fitted to finite elements of pairs and of
random actuators.

Glossary
--------
n : joints (the most of any chain of a batch);  B : chains of a batch;  m : modes
lag : length over which a wrapped sector takes warping up, mm
apart : warping of a cut's edges away from each other, over that of the joint alone, less 1
along : warping of both edges the same way, over the same
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from profiletool.bending.model import Chain
from profiletool.records.units import FloatArray

ODD = (False, True, False, True)  # whether a mode changes its sign with the side
PARAMETERS = 25  # of a mode; see `_mode`
PLUG_MM = 1.0  # rigid at the closed end
_FAR_MM = 1e3  # stands for no neighbour
_LEAST_MM = 0.3  # wrapped sectors count no shorter
# Middle and half width of the ranges: alpha in rad, openF in mm, pressure in MPa.
_ALPHA, _OPENF, _PRESSURE = (2.2, 0.95), (10.0, 6.0), (0.13, 0.09)
_MOST = 3.0  # beyond it ``apart`` and ``along`` level off
_LOG_MOST = 6.0


@dataclass(frozen=True)
class ChainBatch:
    """Chains of the tabulated tube at one pressure each, filled up to the same number of joints.

    Attributes
    ----------
    wrapped : (B, n + 1) mm
        Lengths of the wrapped sectors before, between and behind the cuts.
    terms : (B, n, 5)
        1, alpha, openF, pressure, alpha squared; each from -1 to 1.
    sense : (B, n)
    real : (B, n) bool
        False where a chain is filled up.
    """

    wrapped: FloatArray
    terms: FloatArray
    sense: FloatArray
    real: NDArray[np.bool_]


@dataclass(frozen=True)
class Neighbours:
    """The fitted influence; ``modes`` (m, PARAMETERS), none of them where there is none."""

    modes: FloatArray

    def none(self) -> Neighbours:
        """Leave the influence out."""
        return Neighbours(self.modes[:0])

    def log_factors(self, chain: Chain, pressure: float) -> FloatArray:
        """Logarithm of the factors on turn and stretch: (n, 2)."""
        if len(self.modes) == 0 or len(chain.centre) == 0:
            return np.zeros((len(chain.centre), 2))
        (factors,) = log_factors(self.modes, batch([chain], [pressure]))
        return np.asarray(factors)


def batch(chains: Sequence[Chain], pressures: Sequence[float]) -> ChainBatch:
    """Line chains up at their clamped ends."""
    most = max(len(chain.centre) for chain in chains)
    shape = (len(chains), most)
    wrapped, terms = np.full((len(chains), most + 1), _FAR_MM), np.zeros((*shape, 5))
    sense, real = np.ones(shape), np.zeros(shape, dtype=bool)
    for b, (chain, pressure) in enumerate(zip(chains, pressures, strict=True)):
        n = len(chain.centre)
        half = 0.5 * chain.openF
        wrapped[b, 0] = chain.centre[0] - half[0]
        wrapped[b, 1:n] = np.diff(chain.centre) - half[1:] - half[:-1]
        wrapped[b, n] = chain.length - PLUG_MM - chain.centre[-1] - half[-1]
        alpha = (chain.alpha - _ALPHA[0]) / _ALPHA[1]
        terms[b, :, 0], terms[b, :n, 1], terms[b, :n, 4] = 1.0, alpha, alpha**2
        terms[b, :n, 2] = (chain.openF - _OPENF[0]) / _OPENF[1]
        terms[b, :, 3] = (pressure - _PRESSURE[0]) / _PRESSURE[1]
        sense[b, :n], real[b, :n] = chain.sense, True
    return ChainBatch(wrapped, terms, sense, real)


def log_factors(modes: FloatArray, chains: ChainBatch) -> FloatArray:
    """Logarithm of the factors on turn and stretch: (B, n, 2).

    A mode's parameters, the logarithms over `ChainBatch.terms`: 4 of what a cut wants to warp (no
    constant: only the ratio between joints counts), 5 of a cut's stiffness, 1 of the lag, 1 of the
    resistance of a cut to warping of both edges the same way; then for turn and stretch 5 of the
    effect of ``apart``; for turn, then for stretch, that of the squares of ``along`` and
    ``apart``.
    """
    terms, n = chains.terms, chains.sense.shape[1]
    lag, shear = (np.exp(modes[:, k])[:, None, None] for k in (9, 10))
    wanted = _exp(_of_terms(terms[..., 1:], modes[:, :4]))
    wanted *= np.where(np.array(ODD)[:, None, None], chains.sense, 1.0)
    stiff = _exp(_of_terms(terms, modes[:, 4:9]))
    # In proportion to openF, of which the third term is (openF - 10) / 6.
    shear = shear * (1.0 + 0.6 * terms[..., 2])
    over_lag = np.maximum(chains.wrapped, _LEAST_MM) / lag
    hold, join = 1.0 / np.tanh(over_lag), 1.0 / np.sinh(np.minimum(over_lag, 50.0))
    left = np.arange(0, 2 * n, 2)
    right = left + 1
    springs = np.zeros((*wanted.shape[:2], 2 * n, 2 * n))
    springs[..., left, left] = hold[..., :-1] + stiff + shear
    springs[..., right, right] = hold[..., 1:] + stiff + shear
    springs[..., left, right] = springs[..., right, left] = shear - stiff
    between = np.where(chains.real[:, 1:], -join[..., 1:-1], 0.0)
    springs[..., right[:-1], left[1:]] = springs[..., left[1:], right[:-1]] = between
    pull = np.empty((*wanted.shape[:2], 2 * n, 1))
    pull[..., right, 0] = stiff * wanted
    pull[..., left, 0] = -pull[..., right, 0]
    warp = np.linalg.solve(springs, pull)[..., 0]
    alone = 2.0 * stiff * wanted / (1.0 + 2.0 * stiff)
    apart = _levelled((warp[..., right] - warp[..., left]) / alone - 1.0)
    along = _levelled((warp[..., right] + warp[..., left]) / alone)
    added = [
        apart * _of_terms(terms, modes[:, first : first + 5])
        + along**2 * modes[:, square, None, None]
        + apart**2 * modes[:, square + 1, None, None]
        for first, square in ((11, 21), (16, 23))
    ]
    total: FloatArray = np.stack(added, axis=-1).sum(axis=0)
    return total


def _of_terms(terms: FloatArray, part: FloatArray) -> FloatArray:
    """Polynomials of all modes, whose coefficients are ``part`` (m, k): (m, B, n)."""
    return np.moveaxis(terms @ part.T, -1, 0)


def _exp(values: FloatArray) -> FloatArray:
    return np.asarray(np.exp(np.minimum(np.maximum(values, -_LOG_MOST), _LOG_MOST)))


def _levelled(values: FloatArray) -> FloatArray:
    levelled: FloatArray = _MOST * np.tanh(values / _MOST)
    return levelled


def first_guess() -> FloatArray:
    """Modes from which a fit may start: (m, PARAMETERS)."""
    guess = np.zeros((len(ODD), PARAMETERS))
    guess[:, 4], guess[:, 9], guess[:, 10] = -0.5, np.log([8.0, 25.0, 3.0, 60.0]), -3.0
    guess[:, [11, 16]] = 0.1
    return guess
