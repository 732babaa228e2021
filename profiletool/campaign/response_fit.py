"""The fit of the joint response's table to lines of finite-element runs.

Glossary
--------
S : states (pressures) of a run;  N : places along the tube;  n : joints
fields : see `profiletool.bending.response_table`
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from profiletool.bending.model import Chain
from profiletool.bending.neighbours import (
    ODD,
    PARAMETERS,
    Neighbours,
    batch,
    first_guess,
    log_factors,
)
from profiletool.bending.response import Response
from profiletool.bending.response_table import Axis, ResponseTable
from profiletool.records.frames import Pose, Shape
from profiletool.records.units import FloatArray

BASE = Pose(0.0, 0.0, 0.0)  # all lines begin here, along x ...
SIGN = -1.0  # ... and the object lies at -y
_INSIDE = np.array([0.0, 0.2, 0.4, 0.6, 0.75, 0.85, 0.925, 0.97, 1.0])
_OUTSIDE = np.array([0.15, 0.4, 0.8, 1.3, 2.0, 3.0, 4.5, 6.5, 9.0, 12.0, 16.0, 20.0, 25.0])
_LEAST_FALL = 0.006  # of log theta from one node of alpha to the next
_RIDGE = 0.02  # mm per 100 mm: what a parameter costs that leaves the first guess by 1
_ROUNDS = 40  # of the fit: it creeps from there
_LEAST_FACTOR = 0.2
_LOG_STEP = 0.01
_EVERY = 4  # of a line's points that count in a fit


@dataclass(frozen=True)
class Lines:
    """A run's lines, placed by `BASE` and `SIGN`.

    Attributes
    ----------
    name : str
    chain : Chain
    pressure : (S,) MPa
    along : (N,) mm
    facing, far : (S, N, 2) mm
    ended : str or None
        Why the run ended before the last pressure that was asked for.
    """

    name: str
    chain: Chain
    pressure: FloatArray
    along: FloatArray
    facing: FloatArray
    far: FloatArray
    ended: str | None


@dataclass(frozen=True)
class Error:
    """Distance of predicted object-facing lines from finite elements' at equal places.

    Attributes
    ----------
    rms, worst : (runs, S) list
        Root mean square and largest distance, mm per 100 mm of tube.
    """

    rms: FloatArray
    worst: FloatArray

    def summary(self) -> dict[str, float]:
        """Summarise all runs and states, mm per 100 mm of tube."""
        return {
            "rms_mm_per_100mm": round(float(np.sqrt(np.mean(self.rms**2))), 3),
            "median_mm_per_100mm": round(float(np.median(self.rms)), 3),
            "p95_mm_per_100mm": round(float(np.percentile(self.rms, 95.0)), 3),
            "worst_rms_mm_per_100mm": round(float(self.rms.max()), 3),
            "worst_point_mm_per_100mm": round(float(self.worst.max()), 3),
            "states": len(self.rms),
        }


def fields(lines: Lines) -> FloatArray:
    """Compute turn, stretch, shift and height of a run's states along the tube.

    Returns
    -------
    (S, 4, N)
        rad, then mm; see `profiletool.bending.response_table`.
    """
    across = lines.far - lines.facing
    turn = 0.5 * np.pi - np.unwrap(np.arctan2(across[..., 1], across[..., 0]), axis=-1)
    step = np.diff(turn, axis=-1)
    middle = 0.5 * (turn[..., 1:] + turn[..., :-1])
    x, y = np.moveaxis(np.diff(0.5 * (lines.facing + lines.far), axis=-2), -1, 0)
    chord = np.sinc(step / (2.0 * np.pi))
    stretch = (x * np.cos(middle) - y * np.sin(middle)) / chord - np.diff(lines.along)
    shift = (x * np.sin(middle) + y * np.cos(middle)) / chord
    start = np.zeros((len(turn), 1))
    summed = (np.concatenate([start, np.cumsum(part, axis=-1)], -1) for part in (stretch, shift))
    return np.stack([turn, *summed, np.hypot(across[..., 0], across[..., 1])], axis=1)


def tabulate(singles: Sequence[Lines], straight: Lines, tube: FloatArray) -> ResponseTable:
    """Build a table without neighbours' influence.

    Parameters
    ----------
    singles : sequence of Lines
        One joint each, on all nodes of a grid of alpha and openF, at the same pressures.
    straight : Lines
        A tube without joints at the same pressures.
    tube : (3,)
        Diameter and wall, mm, and C10 + C01, MPa.
    """
    pressure = straight.pressure
    alone = fields(straight)
    third = len(straight.along) // 3  # the ends' influence left out
    rise = alone[:, 1, -third] - alone[:, 1, third]
    strain = rise / (straight.along[-third] - straight.along[third])
    wrapped = np.array([strain, alone[:, 3, third:-third].mean(axis=1) - tube[0]])
    grid = {(float(s.chain.alpha[0]), float(s.chain.openF[0])): s for s in singles}
    alpha, openF = (np.array(sorted({key[k] for key in grid})) for k in (0, 1))
    shape = (len(alpha), len(openF), len(pressure))
    halves = np.empty((*shape, 4, len(_INSIDE) + len(_OUTSIDE)))
    for i, a in enumerate(alpha):
        for j, o in enumerate(openF):
            halves[i, j] = _half(grid[a, o], wrapped, tube[0])
    theta = 2.0 * halves[:, :, :, 0, -1]
    coarse = slice(len(pressure) % 2 == 0, None, 2)
    return ResponseTable(
        alpha=Axis.through(alpha),
        openF=Axis.through(openF),
        pressure=Axis.through(pressure),
        log_rate=_falling(np.log(theta / pressure)),
        coarse=Axis.through(pressure[coarse]),
        fields=(halves / theta[..., None, None])[:, :, coarse],
        inside=_INSIDE,
        outside=_OUTSIDE,
        wrapped=wrapped,
        neighbours=Neighbours(np.zeros((0, PARAMETERS))),
        diameter=float(tube[0]),
        wall=float(tube[1]),
        stiffness=float(tube[2]),
        about={},
    )


def _falling(log_rate: FloatArray) -> FloatArray:
    """Let theta fall with alpha, (A, O, P), where it does not do so by itself.

    Below 0.8 bar it is flat between 72 and 84 deg: up to 1 % higher at 84, which would make the
    search for alpha ambiguous.
    """
    falling = log_rate.copy()
    for k in range(len(falling) - 2, -1, -1):
        falling[k] = np.maximum(falling[k], falling[k + 1] + _LEAST_FALL)
    # The slope of the spline at its first node comes from the first three steps.
    _, second, third = -np.diff(falling[:4], axis=0)
    steep = (7.0 * second - 2.0 * third) / 11.0 + 0.5 * _LEAST_FALL
    falling[0] = np.maximum(falling[0], falling[1] + steep)
    return falling


def _half(single: Lines, wrapped: FloatArray, diameter: float) -> FloatArray:
    """Fields of one joint over half of it, less those of the wrapped tube: (S, 4, M)."""
    openF, centre = float(single.chain.openF[0]), float(single.chain.centre[0])
    z = np.concatenate([0.5 * openF * _INSIDE, 0.5 * openF + _OUTSIDE])
    x, along = single.along - centre, fields(single)
    before, after = (
        np.array([[np.interp(at, x, row) for row in state] for state in along]) for at in (-z, z)
    )
    parity = np.array([[-1.0], [-1.0], [1.0], [1.0]])
    half: FloatArray = 0.5 * (after + parity * before)
    half[:, 1] -= wrapped[0][:, None] * z
    half[:, 2] -= half[:, 2, -1:]
    half[:, 3] -= diameter + wrapped[1][:, None]
    return half


def factors_in(lines: Lines, response: Response) -> FloatArray:
    """Fit factors on the response's turn and stretch of every joint to a run's lines.

    Returns
    -------
    (S, n, 2)
        Least squares over both lines, state by state.
    """
    n = len(lines.chain.centre)
    found = np.ones((len(lines.pressure), n, 2))
    for state, pressure in enumerate(lines.pressure):

        def off(x: FloatArray, state: int = state, pressure: float = float(pressure)) -> FloatArray:
            factors = x.reshape(n, 2)
            shape = response.shape_by(factors, lines.chain, pressure, BASE, SIGN)
            return np.concatenate([d.ravel() for d in _distances(shape, lines, state)])

        start = found[state - 1] if state else found[0]
        found[state] = least_squares(off, start.ravel()).x.reshape(n, 2)
    return found


def _distances(shape: Shape, lines: Lines, state: int) -> tuple[FloatArray, FloatArray]:
    """How far a shape's facing and far lines lie off a run's, at places along it: (k, 2) each."""
    at = lines.along[::_EVERY]
    facing, far = (
        np.column_stack([np.interp(at, shape.along, own[:, k]) for k in (0, 1)]) - fe[::_EVERY]
        for own, fe in ((shape.facing, lines.facing[state]), (shape.far, lines.far[state]))
    )
    return facing, far


def fit_neighbours(
    runs: Sequence[Lines], factors: Sequence[FloatArray], response: Response
) -> Neighbours:
    """Fit the neighbours' influence to the factors found in runs.

    Errors count by what they do to the object-facing line, to first order.

    Parameters
    ----------
    runs : sequence of Lines
    factors : sequence of (S, n, 2)
        What `factors_in` finds in each run.
    response : Response
        Without neighbours' influence.
    """
    states = [
        (lines.chain, float(pressure), both)
        for lines, found in zip(runs, factors, strict=True)
        for pressure, both in zip(lines.pressure, np.maximum(found, _LEAST_FACTOR), strict=True)
    ]
    chains = batch([chain for chain, _, _ in states], [pressure for _, pressure, _ in states])
    count, most = chains.real.shape
    wanted, weight = np.zeros((count, most, 2)), np.zeros((count, 2 * most, 2 * most))
    for k, (chain, pressure, both) in enumerate(states):
        n = len(chain.centre)
        wanted[k, :n] = np.log(both)
        weight[k, : 2 * n, : 2 * n] = _sensitivity(chain, pressure, both, response)
    weight /= np.sqrt(count)
    start = first_guess().ravel()

    def off(x: FloatArray) -> FloatArray:
        miss = log_factors(x.reshape(len(ODD), -1), chains) - wanted
        miss = (weight @ miss.reshape(count, -1, 1)).ravel()
        return np.concatenate([miss, _RIDGE * (x - start)])

    found = least_squares(off, start, max_nfev=_ROUNDS).x
    return Neighbours(found.reshape(len(ODD), -1))


def _sensitivity(
    chain: Chain, pressure: float, factors: FloatArray, response: Response
) -> FloatArray:
    """Triangle whose product with errors of log factors has the line's RMS as its norm.

    In mm per 100 mm of tube; (2 n, 2 n) for n joints, their turns and stretches by turns.
    """
    base = response.shape_by(factors, chain, pressure, BASE, SIGN).facing
    columns = []
    for k in range(factors.size):
        moved = factors.copy()
        moved.flat[k] *= np.exp(_LOG_STEP)
        line = response.shape_by(moved, chain, pressure, BASE, SIGN).facing
        columns.append((line - base).ravel() / _LOG_STEP)
    per_point = np.array(columns).T / (np.sqrt(len(base)) * chain.length / 100.0)
    _, triangle = np.linalg.qr(per_point)
    return triangle


def check(runs: Sequence[Lines], response: Response) -> Error:
    """Compare predicted object-facing lines with those of runs not used in the fit.

    Parameters
    ----------
    runs : sequence of Lines
    response : Response
        Predicts from each run's chain and pressures alone.
    """
    rms, worst = [], []
    for lines in runs:
        hundred = lines.chain.length / 100.0
        for state, pressure in enumerate(lines.pressure):
            shape = response.shape(lines.chain, float(pressure), BASE, SIGN)
            facing, _ = _distances(shape, lines, state)
            square = np.sum(facing**2, axis=1)
            rms.append(float(np.sqrt(square.mean())) / hundred)
            worst.append(float(np.sqrt(square.max())) / hundred)
    return Error(np.array(rms), np.array(worst))
