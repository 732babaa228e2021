"""Pose and lens of the camera, from the corners of one flat sheet.

A pinhole with its axis through the middle of the picture and radial distortion
x' = x (1 + k1 r^2 + k2 r^4) with r in units of the focal length (Brown 1971). One view of a plane
tells the focal length only where it is tilted (Zhang 2000, section 2.3), so what the file says of
it comes in as an observation with its own error; what remains unknown shows in the covariance.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from profiletool.image.sheet.parallax import USUAL_FOCAL
from profiletool.records.units import FloatArray

# Of a focal length that the file does not tell, relative: 20 to 60 mm equivalents.
_USUAL_SPREAD = 0.4
# Cameras round it to a millimetre and refer it to the diagonal or to the width.
_STORED_SPREAD = 0.04
_LENS_SPREAD = (0.1, 0.1)  # of k1 and k2, before any corner is looked at
_LEAST_NOISE_PX = 0.03  # what corners scatter at best
_USUAL_NOISE_PX = 0.3
_OUTLYING = 5.0
_UNBENDS = 30  # rounds that read the distortion backwards; each gains a digit or more
_LEAST_PER_VALUE = 4  # coordinates of corners for every value to be found
_LOG_FOCAL, _LENS, _TURN, _PLACE = 0, slice(1, 3), slice(3, 6), slice(6, 9)


@dataclass(frozen=True)
class View:
    """A camera's view of a sheet.

    Attributes
    ----------
    values : (9,)
        log of the focal length in px; k1, k2; rotation vector (3) from the board frame (its z away
        from the camera) to the camera's; where the board's origin is seen (2), px off the middle,
        and log of the px per mm there. So written, a sheet seen squarely leaves the focal length
        free without moving anything else.
    covariance : (9, 9)
    middle : (2,)
        The picture's middle, px.
    rms_px : float
        Root mean square distance of the corners to where they should be.
    kept : (N,) bool
        False for corners that were left out as misread.
    terms : int
        How many terms of the distortion the corners support: 0 to 2.
    """

    values: FloatArray
    covariance: FloatArray
    middle: FloatArray
    rms_px: float
    kept: NDArray[np.bool_]
    terms: int

    @property
    def camera_mm(self) -> FloatArray:
        """The camera's place in the board frame, (3,) mm; z counts up from the sheet here."""
        return _camera(self.values)

    @property
    def tilt_deg(self) -> float:
        """Angle between the camera's axis and the sheet's normal."""
        turn = _rotation(self.values)
        return math.degrees(math.acos(min(1.0, float(turn[2, 2]))))

    @property
    def height_share(self) -> float:
        """Standard deviation of the camera's height above the sheet, relative."""

        def log_height(values: FloatArray) -> float:
            return math.log(_camera(values)[2])

        slope = _gradient(log_height, self.values)
        return math.sqrt(float(slope @ self.covariance @ slope))

    def picture_of(self, points: FloatArray) -> FloatArray:
        """Project points of the sheet, (..., 2) mm, board frame, to the picture: (..., 2) px."""
        return _project(self.values, points, self.middle)

    def sheet_of(self, px: FloatArray) -> FloatArray:
        """Bring points (..., 2) px of the picture to the sheet: (..., 2) mm, board frame."""
        bent = (px - self.middle) / math.exp(self.values[_LOG_FOCAL])
        flat = bent
        for _ in range(_UNBENDS):
            flat = bent / _stretch(self.values, flat)
        plane = np.column_stack([_rotation(self.values)[:, :2], _shift(self.values)])
        rays = np.concatenate([flat, np.ones_like(flat[..., :1])], axis=-1)
        spots = rays @ np.linalg.inv(plane).T
        return np.asarray(spots[..., :2] / spots[..., 2:])

    def size_share(self, points: FloatArray) -> float:
        """Give the relative standard deviation of a length among ``points`` (N, 2) mm on the sheet.

        To first order: the parameters' errors move where a pixel is taken to lie on the sheet.
        """
        step = 1e-3
        columns = [
            (self.picture_of(points + step * axis) - self.picture_of(points - step * axis))
            / (2.0 * step)
            for axis in np.eye(2)
        ]
        inverse = np.linalg.inv(np.stack(columns, axis=-1))
        arms = points - points.mean(axis=0)

        def growth(values: FloatArray) -> float:
            moved = _project(values, points, self.middle) - self.picture_of(points)
            offset = np.einsum("nij,nj->ni", inverse, moved)
            return float((offset * arms).sum() / (arms**2).sum())

        slope = _gradient(growth, self.values)
        return math.sqrt(float(slope @ self.covariance @ slope))


def fit_view(px: FloatArray, mm: FloatArray, size: tuple[int, int], focal_px: float | None) -> View:
    """Find the camera that sees corners where they are seen.

    The terms of the distortion are let in one by one while Akaike's criterion (1974) falls by
    more than two: further terms would follow the corners' scatter.

    Parameters
    ----------
    px, mm : (N, 2)
        Corners in the picture frame and in the board frame, at least four.
    size : (width, height) px
    focal_px : float or None
        Focal length as the file has it.
    """
    middle = (np.array(size, float) - 1.0) / 2.0
    focal = focal_px or USUAL_FOCAL * max(size)
    spread = _STORED_SPREAD if focal_px else _USUAL_SPREAD
    kept = np.ones(len(px), bool)
    best = _best(px, mm, middle, focal, spread)
    for _ in range(2):
        misses = np.hypot(*(_project(best.x, mm, middle) - px).T)
        limit = _OUTLYING * max(3.0 * _LEAST_NOISE_PX, float(np.median(misses)))
        inside = misses <= limit
        if (inside == kept).all() or inside.sum() < max(4, 0.7 * len(px)):
            break
        kept = inside
        best = _best(px[kept], mm[kept], middle, focal, spread)
    misses = np.hypot(*(_project(best.x, mm[kept], middle) - px[kept]).T)
    rms = float(np.sqrt(np.mean(misses**2)))
    return View(best.x, best.covariance, middle, rms, kept, best.terms)


@dataclass(frozen=True)
class _Fit:
    x: FloatArray
    covariance: FloatArray
    terms: int
    criterion: float


def _best(px: FloatArray, mm: FloatArray, middle: FloatArray, focal: float, spread: float) -> _Fit:
    known = spread < _USUAL_SPREAD
    starts = [
        start
        for factor in ((1.0,) if known else (1.0, 0.6, 1.7))
        for start in _starts(px, mm, middle, focal * factor)
    ]
    fits = [_fit(px, mm, middle, start, (focal, spread), 0, rounds=1) for start in starts]
    start = min(fits, key=lambda fit: fit.criterion).x
    best = _fit(px, mm, middle, start, (focal, spread), 0)
    for terms in (1, 2):
        if 2 * len(px) < _LEAST_PER_VALUE * (7 + terms):
            break
        tried = _fit(px, mm, middle, best.x, (focal, spread), terms)
        if tried.criterion > best.criterion - 2.0:
            # What is left out for want of evidence is unknown still, not nought.
            return replace(best, covariance=tried.covariance)
        best = tried
    return best


def _starts(px: FloatArray, mm: FloatArray, middle: FloatArray, focal: float) -> list[FloatArray]:
    """Poses to start from: a plane seen from afar leaves two."""
    matrix = np.array([[focal, 0.0, middle[0]], [0.0, focal, middle[1]], [0.0, 0.0, 1.0]])
    points = np.column_stack([mm, np.zeros(len(mm))])
    _, turns, shifts, _ = cv2.solvePnPGeneric(points, px, matrix, None, flags=cv2.SOLVEPNP_IPPE)
    return [
        _values(focal, np.ravel(turn), np.ravel(shift))
        for turn, shift in zip(turns, shifts, strict=True)
    ]


def _fit(
    px: FloatArray,
    mm: FloatArray,
    middle: FloatArray,
    start: FloatArray,
    prior: tuple[float, float],
    terms: int,
    rounds: int = 3,
) -> _Fit:
    """Fit with so many terms of distortion; the corners' scatter is what they say it is."""
    free = np.r_[_LOG_FOCAL, 1 : 1 + terms, 3:9]
    focal, spread = prior
    noise = _USUAL_NOISE_PX
    values = start.copy()
    for _ in range(rounds):

        def misfit(some: FloatArray, noise: float = noise) -> FloatArray:
            whole = values.copy()
            whole[free] = some
            gap = (_project(whole, mm, middle) - px).ravel() / noise
            known = (whole[_LOG_FOCAL] - math.log(focal)) / spread
            return np.concatenate([gap, [known], (whole[_LENS] / _LENS_SPREAD)[:terms]])

        found = least_squares(misfit, values[free], method="lm", x_scale="jac", max_nfev=2000)
        values[free] = found.x
        squares = float(((_project(values, mm, middle) - px) ** 2).sum())
        noise = max(_LEAST_NOISE_PX, math.sqrt(squares / max(1, 2 * len(px) - len(free) + 1)))
    slopes = np.asarray(found.jac, np.float64)
    covariance = np.zeros((9, 9))
    covariance[np.ix_(free, free)] = np.linalg.inv(slopes.T @ slopes)
    count = 2 * len(px)
    floor = count * _LEAST_NOISE_PX**2
    known = (values[_LOG_FOCAL] - math.log(focal)) / spread
    criterion = count * math.log(max(squares, floor) / count) + 2 * len(free) + known**2
    return _Fit(values, covariance, terms, criterion)


def _values(focal: float, turn: FloatArray, shift: FloatArray) -> FloatArray:
    px_per_mm = focal / shift[2]
    seen = shift[:2] * px_per_mm
    return np.array([math.log(focal), 0.0, 0.0, *turn, *seen, math.log(px_per_mm)])


def _shift(values: FloatArray) -> FloatArray:
    x, y, size = values[_PLACE]
    return np.array([x, y, math.exp(values[_LOG_FOCAL])]) / math.exp(size)


def _rotation(values: FloatArray) -> FloatArray:
    return np.asarray(cv2.Rodrigues(values[_TURN])[0], np.float64)


def _camera(values: FloatArray) -> FloatArray:
    place = -_rotation(values).T @ _shift(values)
    return place * [1.0, 1.0, -1.0]


def _project(values: FloatArray, points: FloatArray, middle: FloatArray) -> FloatArray:
    seen = points @ _rotation(values)[:, :2].T + _shift(values)
    flat = seen[..., :2] / seen[..., 2:]
    bent = flat * _stretch(values, flat)
    return np.asarray(math.exp(values[_LOG_FOCAL]) * bent + middle)


def _stretch(values: FloatArray, flat: FloatArray) -> FloatArray:
    """By how much the lens moves points (..., 2) off its axis, (..., 1)."""
    k1, k2 = values[_LENS]
    square = (flat**2).sum(axis=-1, keepdims=True)
    return np.asarray(1.0 + square * (k1 + square * k2))


def _gradient(function: Callable[[FloatArray], float], values: FloatArray) -> FloatArray:
    steps = 1e-5 * np.maximum(1.0, np.abs(values))
    return np.array(
        [
            (function(values + step) - function(values - step)) / (2.0 * steps[k])
            for k, step in enumerate(np.diag(steps))
        ]
    )
