"""The outline as a sub-pixel polygon, its noise, and no more smoothing than that asks for."""

from __future__ import annotations

import numpy as np
from contourpy import LineType, contour_generator
from numpy.typing import NDArray

from profiletool.image.find.ground import BoolImage
from profiletool.image.find.masks import largest_filled
from profiletool.records.units import FloatArray

_QUIET_PX = 0.06  # noise below this is left alone
_LONGEST_WINDOW = 25
_SHORTEST_PX = 60  # along a shorter contour, noise and corners cannot be told apart


def largest_region(field: NDArray[np.float32]) -> BoolImage:
    """Find the largest region above one half of an (H, W) field, its holes filled."""
    return largest_filled(field > 0.5)


def outline(field: NDArray[np.float32], mask: BoolImage) -> FloatArray:
    """Half-level line of a field round one region, in the picture frame.

    Parameters
    ----------
    field : (H, W) float32
        Share of object per pixel, 0 to 1; outside the picture it counts as 0.
    mask : (H, W) bool
        The region, as `largest_region` gives it.

    Returns
    -------
    (N, 2) float64
        Closed polygon, x and y in pixels, down the left side and up the right one. Between a 0
        and a 1 it runs on the pixels' common boundary.
    """
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    top, left = max(rows[0] - 1, 0), max(columns[0] - 1, 0)
    window = np.s_[top : rows[-1] + 2, left : columns[-1] + 2]
    inside = mask[window]
    # Other regions are kept below the level, filled holes above it.
    cut = np.where(inside, np.maximum(field[window], 0.501), np.minimum(field[window], 0.499))
    generator = contour_generator(z=np.pad(cut, 1), line_type=LineType.Separate)
    lines = [np.asarray(line, np.float64) for line in generator.lines(0.5)]
    line = max(lines, key=lambda points: abs(signed_area(points)))[:-1]
    line = line[(line != np.roll(line, 1, axis=0)).any(axis=1)]
    origin = np.array([left - 1.0, top - 1.0])
    return np.asarray(origin + (line if signed_area(line) < 0 else line[::-1]))


def signed_area(polygon: FloatArray) -> float:
    """Area of an (N, 2) polygon; negative where it runs down the left side, y pointing down."""
    x, y = polygon.T
    return 0.5 * float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))


def resampled(polygon: FloatArray, step: float) -> FloatArray:
    """Points at equal arc length, about ``step`` apart, along a closed (N, 2) polygon."""
    closed = np.vstack([polygon, polygon[:1]])
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(closed, axis=0).T))])
    count = max(8, round(along[-1] / step))
    at = np.arange(count) * (along[-1] / count)
    return np.stack([np.interp(at, along, values) for values in closed.T], axis=1)


def position_noise(polygon: FloatArray) -> float:
    """Measure the standard deviation of a polygon's position across itself, in pixels.

    Third differences over two pixels see neither place, slope nor curvature; their median
    overlooks corners.
    """
    points = resampled(polygon, 1.0)
    lag = 2
    third = sum(
        factor * np.roll(points, shift * lag, axis=0)
        for factor, shift in ((1.0, -1), (-3.0, 0), (3.0, 1), (-1.0, 2))
    )
    chord = np.roll(points, -2 * lag, axis=0) - np.roll(points, 2 * lag, axis=0)
    normal = np.stack([-chord[:, 1], chord[:, 0]], axis=1)
    normal /= np.maximum(np.hypot(*normal.T), 1e-9)[:, None]
    across = np.abs((third * normal).sum(axis=1))
    return float(1.4826 * np.median(across) / np.sqrt(20.0))


def smoothed(polygon: FloatArray, least_noise: float = 0.0) -> tuple[FloatArray, float]:
    """Smooth a contour as far as its noise demands.

    Parameters
    ----------
    polygon : (N, 2)
        Closed contour in pixels.
    least_noise : float
        What is known of the noise, where it is too regular to be seen.

    Returns
    -------
    polygon : (M, 2)
        Unchanged where the noise is below a few hundredths of a pixel.
    noise_px : float
        Standard deviation of its points that remains.
    """
    noise = max(position_noise(polygon), least_noise)
    points = resampled(polygon, 0.5)
    window = min(2 * round(3 + 25 * noise) + 1, _LONGEST_WINDOW)
    if noise < _QUIET_PX or len(points) < 2 * _SHORTEST_PX:
        return polygon, noise
    # What a cubic leaves of noise that is independent every pixel, two points apart.
    return _calmed(points, window // 2), noise * min(1.0, float(np.sqrt(2.25 / (window / 2))))


def _calmed(points: FloatArray, reach: int) -> FloatArray:
    """Fit a cubic over ``reach`` points either way, round a closed line.

    Cubic: keeps slope and curvature, so that the outline does not shrink. It is what
    scipy.signal.savgol_filter does with mode="wrap", whose import alone takes most of a second.
    """
    weights = np.linalg.pinv(np.vander(np.arange(-reach, reach + 1.0), 4))[-1]
    round_ = np.pad(points, ((reach, reach), (0, 0)), mode="wrap")
    return np.stack([np.convolve(line, weights, mode="valid") for line in round_.T], axis=1)
