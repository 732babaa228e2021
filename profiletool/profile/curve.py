"""Plane curves by arc length: resampling, heading and curvature that pixel noise does not spoil."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from profiletool.records.units import FloatArray

_DEGREE = 3  # of the polynomials for the positions: circles shrink by (h/R)⁴ only
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


def points_at(at: FloatArray, s: FloatArray, points: FloatArray) -> FloatArray:
    """Interpolate points (N, 2), given at rising places s (N,), to other places (K,): (K, 2)."""
    return np.column_stack([np.interp(at, s, points[:, k]) for k in (0, 1)])


def resample(points: FloatArray, step: float) -> FloatArray:
    """Resample an open polyline (N, 2) equally, ends kept, at the spacing nearest to ``step``."""
    keep = np.concatenate([[True], np.any(np.diff(points, axis=0) != 0.0, axis=1)])
    points = points[keep]
    s = arc_length(points)
    count = max(round(float(s[-1]) / step), 1) + 1
    at = np.linspace(0.0, s[-1], count)
    return points_at(at, s, points)


def ring_stretch(ring: FloatArray, start: float, end: float) -> FloatArray:
    """Cut a closed polygon (M, 2) from one arc length forward to another: (N, 2).

    Both may lie up to one round beyond its first point, either way.
    """
    closed = np.concatenate([ring, ring[:1]])
    once = arc_length(closed)
    at = (once[:-1] + once[-1] * np.array([[-1.0], [0.0], [1.0]])).ravel()
    points = np.tile(ring, (3, 1))
    first, last = points_at(np.array([start, end]), at, points)
    inside = (at > start) & (at < end)
    return np.concatenate([[first], points[inside], [last]])


def smoothing_width(noise_mm: float, spacing_mm: float) -> float:
    """Half-width of the window in which noise leaves the heading right to half a degree.

    A line fitted over +-h to points that scatter by ``noise_mm`` and are independent every
    ``spacing_mm`` has a slope variance of 3 noise² spacing / (2 h³).
    """
    return float((1.5 * noise_mm**2 * spacing_mm / _HEADING_NOISE_RAD**2) ** (1.0 / 3.0))


def make_curve(points: FloatArray, step: float, half_width: float) -> Curve:
    """Resample a polyline and fit it over +-``half_width`` around every point.

    Cubics give the positions, which then do not shrink where the curve bends; straight lines give
    the headings, which then do not overshoot beside a corner.

    Parameters
    ----------
    points : (N, 2) array, mm
    step : float, mm
        Spacing of the result.
    half_width : float, mm
        Nearer to the ends than this the cubic of the last whole window serves.
    """
    even = resample(points, step)
    spacing = arc_length(even)[-1] / (len(even) - 1)
    reach = min(max(round(half_width / spacing), 2), (len(even) - 1) // 2)
    fitted, direction = local_fits(even, spacing, reach)
    s = arc_length(fitted)
    heading = np.unwrap(np.arctan2(direction[:, 1], direction[:, 0]))
    return Curve(fitted, s, heading, np.gradient(heading, s))


def local_fits(points: FloatArray, spacing: float, reach: int) -> tuple[FloatArray, FloatArray]:
    """Give positions and directions, (N, 2) each, by least squares over 2 reach + 1 points.

    What scipy.signal.savgol_filter does with mode="interp"; its import alone takes a second.
    """
    degree = min(_DEGREE, 2 * reach)
    offsets = np.asarray(np.arange(-reach, reach + 1) * spacing, dtype=np.float64)
    solve = np.linalg.pinv(np.vander(offsets, degree + 1, increasing=True))
    windows = np.lib.stride_tricks.sliding_window_view(points, 2 * reach + 1, axis=0)
    slope = offsets / np.sum(offsets**2)

    def at_end(window: FloatArray, t: FloatArray) -> tuple[FloatArray, FloatArray]:
        coefficients = solve @ window.T
        powers = np.vander(t, degree + 1, increasing=True)
        slopes = powers[:, :-1] * np.arange(1, degree + 1)
        return powers @ coefficients, slopes @ coefficients[1:]

    first = at_end(windows[0], offsets[:reach])
    last = at_end(windows[-1], offsets[reach + 1 :])
    return (
        np.concatenate([first[0], windows @ solve[0], last[0]]),
        np.concatenate([first[1], windows @ slope, last[1]]),
    )
