"""Plane curves by arc length: resampling, heading and curvature that pixel noise does not spoil."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from profiletool.records import FloatArray

_DEGREE = 3  # of the local polynomials: a circle's curvature comes out right to (h/R)² / 20
_HEADING_NOISE_RAD = np.radians(0.5)  # what smoothing leaves of the pixels' noise


@dataclass(frozen=True)
class Curve:
    """An open curve, equally spaced.

    Attributes
    ----------
    points : (N, 2) mm
    s : (N,) mm, from 0
    heading : (N,) rad, unwrapped, counter-clockwise from +x
    curvature : (N,) 1/mm, positive where the curve turns counter-clockwise
    """

    points: FloatArray
    s: FloatArray
    heading: FloatArray
    curvature: FloatArray


def arc_length(points: FloatArray) -> FloatArray:
    """Arc length along a polyline: (N, 2) -> (N,), starting at 0."""
    steps = np.hypot(*np.diff(points, axis=0).T)
    return np.concatenate([[0.0], np.cumsum(steps)])


def resample(points: FloatArray, step: float) -> FloatArray:
    """Resample an open polyline (N, 2) equally, ends kept, at the spacing nearest to ``step``."""
    keep = np.concatenate([[True], np.any(np.diff(points, axis=0) != 0.0, axis=1)])
    points = points[keep]
    s = arc_length(points)
    count = max(round(float(s[-1]) / step), 1) + 1
    at = np.linspace(0.0, s[-1], count)
    return np.column_stack([np.interp(at, s, points[:, 0]), np.interp(at, s, points[:, 1])])


def smoothing_width(noise_mm: float, spacing_mm: float) -> float:
    """Half-width of the window in which noise leaves the heading right to half a degree.

    A line fitted over +-h to points that scatter by ``noise_mm`` and are independent every
    ``spacing_mm`` has a slope variance of 3 noise² spacing / (2 h³).
    """
    return float((1.5 * noise_mm**2 * spacing_mm / _HEADING_NOISE_RAD**2) ** (1.0 / 3.0))


def make_curve(points: FloatArray, step: float, half_width: float) -> Curve:
    """Resample a polyline and fit cubics over +-``half_width`` around every point.

    Parameters
    ----------
    points : (N, 2) array, mm
    step : float, mm
        Spacing of the result.
    half_width : float, mm
        Near the ends the last whole window serves.
    """
    even = resample(points, step)
    s = arc_length(even)
    spacing = s[-1] / (len(s) - 1)
    reach = min(max(round(half_width / spacing), 2), (len(even) - 1) // 2)
    fitted, first, second = _local_polynomials(even, spacing, reach)
    heading = np.unwrap(np.arctan2(first[:, 1], first[:, 0]))
    speed = np.hypot(first[:, 0], first[:, 1])
    cross = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]
    return Curve(fitted, arc_length(fitted), heading, cross / speed**3)


def _local_polynomials(
    points: FloatArray, spacing: float, reach: int
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Value, first and second derivative of cubics fitted to 2 reach + 1 points each.

    What scipy.signal.savgol_filter does with mode="interp", whose import alone takes a second.
    """
    degree = min(_DEGREE, 2 * reach)
    offsets: FloatArray = np.arange(-reach, reach + 1) * spacing
    solve = np.linalg.pinv(np.vander(offsets, degree + 1, increasing=True))
    windows = np.lib.stride_tricks.sliding_window_view(points, 2 * reach + 1, axis=0)
    inner = np.einsum("kw,ncw->nkc", solve, windows)

    def at_end(coefficients: FloatArray, t: FloatArray) -> FloatArray:
        powers = np.vander(t, degree + 1, increasing=True)
        k = np.arange(degree + 1)
        slopes = np.zeros_like(powers)
        slopes[:, 1:] = powers[:, :-1] * k[1:]
        bends = np.zeros_like(powers)
        bends[:, 2:] = powers[:, :-2] * (k[2:] * k[1:-1])
        return np.stack([p @ coefficients for p in (powers, slopes, bends)], axis=1)

    middle = np.stack([inner[:, 0], inner[:, 1], 2.0 * inner[:, 2]], axis=1)
    ahead, behind = offsets[:reach], offsets[reach + 1 :]
    value, first, second = np.concatenate(
        [at_end(inner[0], ahead), middle, at_end(inner[-1], behind)]
    ).transpose(1, 0, 2)
    return value, first, second
