"""The ground an object lies on: a smooth colour surface and how far each pixel is from it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from profiletool.records.units import FloatArray

FloatImage = NDArray[np.float32]
BoolImage = NDArray[np.bool_]

_FRAME_SHARE = 0.04  # width of the border that is looked at, of the shorter side
_SAMPLES = 6_000
_FLOOR_LAB = 1.5  # below this, colour differences are compression and rounding, not objects
_LEAST_DISTANCE = 2.5
_TUKEY = 4.0
_DEGREE = 2  # the border alone bears no more, and a freer surface would take in a pale object
_POWERS = [(n - k, k) for n in range(_DEGREE + 1) for k in range(n + 1)]


@dataclass(frozen=True)
class Ground:
    """The ground of a picture, in CIE Lab.

    Attributes
    ----------
    surface : (H, W, 3)
        The ground's colour, also where the object hides it.
    distance : (H, W)
        Difference to it in units of its own scatter.
    noise : float
        The distance that the ground itself hardly exceeds.
    scatter_lab : float
        Root mean square of the border's deviation from the surface, Lab units.
    """

    surface: FloatImage
    distance: FloatImage
    noise: float
    scatter_lab: float

    @property
    def level(self) -> float:
        """Distance from which on a pixel stands out."""
        return max(_LEAST_DISTANCE, 1.3 * self.noise)

    @property
    def standing(self) -> BoolImage:
        """What stands out, (H, W)."""
        return self.distance > self.level


def to_lab(rgb: NDArray[np.uint8]) -> FloatImage:
    """CIE Lab, L 0..100, of an (H, W, 3) picture."""
    scaled = rgb.astype(np.float32) / np.float32(255)
    return np.asarray(cv2.cvtColor(scaled, cv2.COLOR_RGB2LAB), np.float32)


def fit_ground(lab: FloatImage, usable: BoolImage, within: BoolImage | None = None) -> Ground:
    """Fit a smooth colour surface to the border.

    Parameters
    ----------
    lab : (H, W, 3)
        Picture in CIE Lab.
    usable : (H, W)
        False where a pixel says nothing about the ground.
    within : (H, W), or None
        A region that is the ground: its own border is looked at instead of the picture's.
    """
    height, width = lab.shape[:2]
    looked_at = frame_of(usable.shape, _FRAME_SHARE) if within is None else border_of(within)
    border = _sampled(usable & looked_at)
    if len(border[0]) < 2 * len(_POWERS):
        border = _sampled(usable)
    colours = lab[border].astype(np.float64)
    design = _basis(border, lab.shape)
    coefficients, weights = _border_fit(design, colours, _nearest_side(border, lab.shape))
    surface = _surface(coefficients, height, width)
    residuals = colours - design @ coefficients
    scatter = (residuals * weights[:, None]).T @ residuals / weights.sum()
    whitening = np.linalg.cholesky(np.linalg.inv(scatter + _FLOOR_LAB**2 * np.eye(3)))
    distance = np.linalg.norm((lab - surface) @ whitening.astype(np.float32), axis=2)
    inlying = weights > 0.1
    at_border = np.linalg.norm(residuals[inlying] @ whitening, axis=1)
    return Ground(
        surface=surface,
        distance=distance,
        noise=float(np.quantile(at_border, 0.995)),
        scatter_lab=float(np.sqrt(np.trace(scatter))),
    )


def frame_of(shape: tuple[int, ...], share: float) -> BoolImage:
    """Mask the border of a picture, of a share of its shorter side."""
    width = max(2, round(share * min(shape)))
    frame = np.ones(shape, bool)
    frame[width:-width, width:-width] = False
    return frame


def border_of(region: BoolImage) -> BoolImage:
    """Mask the border of a region, off its very edge."""
    size = float(np.sqrt(region.sum()))
    deep = cv2.distanceTransform(region.view(np.uint8), cv2.DIST_L2, 3)
    return np.asarray((deep > 1.0 + 0.02 * size) & (deep <= 3.0 + 0.06 * size))


def _nearest_side(index: Sequence[NDArray[np.intp]], shape: tuple[int, ...]) -> NDArray[np.intp]:
    rows, columns = index
    depths = (rows, shape[0] - 1 - rows, columns, shape[1] - 1 - columns)
    return np.asarray(np.argmin(np.stack(depths), axis=0))


def _sampled(mask: BoolImage) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    rows, columns = np.nonzero(mask)
    step = max(1, len(rows) // _SAMPLES)
    return rows[::step], columns[::step]


def _unit(index: NDArray[np.intp], size: int) -> FloatArray:
    return 2.0 * index / (size - 1) - 1.0


def _basis(index: Sequence[NDArray[np.intp]], shape: tuple[int, ...]) -> FloatArray:
    """Monomials to the second degree at rows and columns."""
    v, u = _unit(index[0], shape[0]), _unit(index[1], shape[1])
    return np.stack([u**p * v**q for p, q in _POWERS], axis=-1)


def _surface(coefficients: FloatArray, height: int, width: int) -> FloatImage:
    """Evaluate the fitted polynomial at every pixel, as products of its powers along x and y."""
    table = np.zeros((_DEGREE + 1, _DEGREE + 1, 3))
    for (p, q), row in zip(_POWERS, coefficients, strict=True):
        table[q, p] = row
    down = np.vander(_unit(np.arange(height), height), _DEGREE + 1, increasing=True)
    across = np.vander(_unit(np.arange(width), width), _DEGREE + 1, increasing=True)
    planes = [down @ table[..., channel] @ across.T for channel in range(3)]
    return np.stack(planes, axis=2).astype(np.float32)


def _border_fit(
    design: FloatArray, colours: FloatArray, side: NDArray[np.intp]
) -> tuple[FloatArray, FloatArray]:
    """Fit the quadratic surface that explains most of the border; give each sample's weight too.

    An object or a table's edge may take up a whole side of the frame, so the fit is also started
    from any three of the four.
    """
    starts = [np.ones(len(side), bool)] + [side != left_out for left_out in range(4)]
    fits = [_reweighted(design, colours, start) for start in starts if start.sum() > 50]

    def badness(fit: tuple[FloatArray, FloatArray]) -> float:
        misfit = np.linalg.norm(colours - design @ fit[0], axis=1)
        return float(np.minimum(misfit, 3.0 * _FLOOR_LAB).mean())

    return min(fits, key=badness)


def _reweighted(
    design: FloatArray, colours: FloatArray, start: BoolImage
) -> tuple[FloatArray, FloatArray]:
    """Reweighted least squares: absolute deviations first, then Tukey's biweight."""
    weights = np.where(start, 1.0, 1e-6)
    coefficients: FloatArray = np.zeros((design.shape[1], colours.shape[1]))
    for step in range(14):
        weighted = design * weights[:, None]
        coefficients = np.asarray(
            np.linalg.solve(weighted.T @ design, weighted.T @ colours), np.float64
        )
        misfit = np.linalg.norm(colours - design @ coefficients, axis=1)
        if step < 8:
            weights = np.where(start, 1.0, 1e-6) / np.maximum(misfit, 0.5)
        else:
            weights = _biweight(misfit, _scale(misfit))
    return coefficients, weights


def _scale(misfit: FloatArray) -> float:
    return max(1.0, 1.4826 * float(np.median(misfit)))


def _biweight(misfit: FloatArray, scale: float) -> FloatArray:
    return np.clip(1.0 - (misfit / (_TUKEY * scale)) ** 2, 1e-6, None) ** 2
