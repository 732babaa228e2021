"""Lines of single joints at one pressure, tabulated for the choice among many.

A joint is symmetric about its middle, so its motion is that of two straight lines that meet in a
*vertex* at the same distance from both edges of the window, and half of its line says all.

Glossary
--------
K, T, X : number of cuts (openF), of angles, of places along the line
reach : distance of the window's edges, on the straight lines carried on, from the vertex
bulge : how far the line lies off the straight line before the vertex, toward the bend
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from profiletool.bending.model import Model
from profiletool.joints.expected import ErrorSizes, angle_variance, slopes_of
from profiletool.records.units import Float32, FloatArray

LEAST_TURN = float(np.radians(3.0))  # a joint that turns less is none
STEP_MM = 0.25  # spacing of tabulated places
PAST_MM = 6.0  # tabulated past the vertex
_SAMPLED = 7  # angles at which the model is asked
_ANGLES = 33  # and to which it is interpolated
_CLEAR_MM = 8.0  # tabulated beyond the longest reach: the tube straightens out


@dataclass(frozen=True)
class Bends:
    """All joints of one sense at one pressure.

    Attributes
    ----------
    least, most : (K,) rad
        Angles that each cut gives; ``most`` is below ``least`` where it gives none.
    reach : (K, T) mm
        At evenly spaced angles from least to most.
    bulge, slope : (K, T, X) mm, cosine of the heading
        At places from ``-before`` to `PAST_MM` about the vertex.
    before : float, mm
    variance : (K, T) rad²
        Of the angle, by errors of a joint's own.
    """

    least: FloatArray
    most: FloatArray
    reach: FloatArray
    bulge: Float32
    slope: Float32
    before: float
    variance: FloatArray


def tabulate(
    model: Model,
    pressure: float,
    openF: FloatArray,
    sense: float,
    sizes: ErrorSizes | None = None,
) -> Bends:
    """Ask the model for the joints of one sense at one pressure.

    Parameters
    ----------
    model : Model
    pressure : float, MPa
    openF : (K,) array, mm
    sense : float
        +1 toward the object, -1 away from it.
    sizes : ErrorSizes, optional
        Of a build's errors; without them nothing is ever off.
    """
    narrow, wide = model.alpha
    least = np.maximum(model.theta(openF, wide, pressure), LEAST_TURN)
    most = np.asarray(model.theta(openF, narrow, pressure), dtype=float)
    lines = [
        _lines(model, pressure, float(cut), sense, low, high) if high > low else []
        for cut, low, high in zip(openF, least, most, strict=True)
    ]
    reaches = [np.array([_vertex(line) for line in of_cut]) for of_cut in lines]
    before = max([float(reach.max()) for reach in reaches if len(reach)], default=0.0) + _CLEAR_MM
    before = STEP_MM * np.ceil(before / STEP_MM)
    at = np.arange(-before, PAST_MM + 0.5 * STEP_MM, STEP_MM)
    shape = (len(openF), _ANGLES, len(at))
    reach = np.zeros(shape[:2])
    bulge, slope = np.zeros(shape, dtype=np.float32), np.ones(shape, dtype=np.float32)
    for k, of_cut in enumerate(lines):
        if not of_cut:
            continue
        halves = np.array(
            [_half(line, q, at, sense) for line, q in zip(of_cut, reaches[k], strict=True)]
        )
        where = np.linspace(0.0, _SAMPLED - 1.0, _ANGLES)
        reach[k] = np.interp(where, np.arange(_SAMPLED), reaches[k])
        bulge[k], slope[k] = np.moveaxis(_between(halves, where), 1, 0)
    variance = np.zeros(shape[:2])
    if sizes is not None:
        theta = np.linspace(least, most, _ANGLES, axis=1)
        alpha = np.nan_to_num(model.alpha_for(openF[:, None], theta, pressure), nan=narrow)
        variance = angle_variance(slopes_of(model, openF[:, None], alpha, pressure), sizes)
    return Bends(least, most, reach, bulge, slope, float(before), variance)


def _lines(
    model: Model, pressure: float, openF: float, sense: float, low: float, high: float
) -> list[FloatArray]:
    """Lines of one cut at evenly spaced angles."""
    theta = np.linspace(low, high, _SAMPLED)
    # The ends may miss by rounding what alpha_for takes.
    alpha = model.alpha_for(openF, theta, pressure)
    ends = np.linspace(model.alpha[1], model.alpha[0], _SAMPLED)
    alpha = np.where(np.isnan(alpha), ends, alpha)
    return [model.line(openF, float(a), pressure, sense) for a in alpha]


def _vertex(line: FloatArray) -> float:
    """Distance from the window's edge to where the straight lines at a joint's ends meet, mm."""
    x, y, heading = line[-1]
    return float(x - y / np.tan(heading))


def _half(line: FloatArray, vertex: float, at: FloatArray, sense: float) -> FloatArray:
    """Bulge and cosine of the heading at places about the vertex: (2, X)."""
    x, y, heading = line[-1]
    far = 2.0 * PAST_MM
    beyond = [x + far * np.cos(heading), y + far * np.sin(heading), heading]
    line = np.vstack([line, beyond])
    # As far as it advances: a turn beyond 90 deg comes back, far past the half that counts.
    ahead = np.maximum.accumulate(line[:, 0])
    kept = np.append(True, np.diff(ahead) > 0.0)
    line = line[kept]
    return np.array(
        [
            -sense * np.interp(at + vertex, line[:, 0], line[:, 1]),
            np.cos(np.interp(at + vertex, line[:, 0], line[:, 2])),
        ]
    )


def _between(values: FloatArray, where: FloatArray) -> FloatArray:
    """Interpolate along the first axis at fractional indices."""
    low = np.minimum(where.astype(int), len(values) - 2)
    share = (where - low)[:, None, None]
    return np.asarray((1.0 - share) * values[low] + share * values[low + 1])
