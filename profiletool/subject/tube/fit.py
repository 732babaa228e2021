"""The tube fitted to the edges of a picture: place, scale, and how each joint is off the model.

Edges are looked for across the predicted lines of the wrapped sectors, within a reach that
narrows from round to round; each round is a robust linear fit.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from profiletool.records.units import BoolArray, FloatArray, IntArray
from profiletool.subject.tube.camera import Camera
from profiletool.subject.tube.edges import Shown
from profiletool.subject.tube.family import Family
from profiletool.subject.tube.rows import Gaps, Rows, edge_rows, line_gaps, prior_gaps
from profiletool.subject.tube.values import Fitted, Known, Line, Tube

_REACH_MM = (5.0, 3.5, 2.5, 1.8, 1.3, 1.0, 0.8, 0.8, 0.8)
_WHOLE = 2  # rounds in which the model's pressure is fitted, and no joint by itself
_CLOSE = 5  # from this round on it is close, and what lies far off does not count at all
_LEAST_PX, _MODEL_PX = 0.05, 0.15  # what edges scatter at best, and a model's own waves
_MOST_MM = 0.05  # of their scatter, once close: edges that scatter more are of something else
_TUKEY, _CAUCHY = 4.685, 2.385
_START = np.array([3.0, 3.0, np.radians(3.0), np.inf])  # sigmas of a start: mm, mm, rad, any size
_BELIEVED = 0.3  # of an edge's weight
_LAGS = 3  # places along a line, over which residuals may hang together


def fit_tube(
    picture: Shown,
    camera: Camera,
    family: Family,
    start: Tube,
    lines: Mapping[int, Line] | None = None,
    known: Known | None = None,
    near: bool = False,
) -> Fitted:
    """Fit a tube to a picture's edges.

    Parameters
    ----------
    picture : Shown
    camera : Camera
    family : Family
    start : Tube
        Within some mm of where it lies.
    lines : mapping of int to Line, optional
        By sector.
    known : Known, optional
    near : bool
        Whether it starts from a fit of this very picture.
    """
    tube, given = start, lines or {}
    if known is None:  # the lines of a straight tube do not say where along them it lies
        known = Known(start.values()[:4], np.diag(1.0 / _START))

    def beforehand(at: Tube) -> Gaps:
        return prior_gaps(family, at, camera, known).plus(line_gaps(camera, family, at, given))

    rounds = tuple(enumerate(_REACH_MM))[_CLOSE if near else 0 :]
    for k, reach in rounds:
        rows = edge_rows(picture, camera, family, tube, reach)
        step, _, _ = _solve(rows, beforehand(tube), _free(family, k < _WHOLE), k < _CLOSE)
        tube = _kept(tube.of(tube.values() + step), family)
    rows, free, more = (
        edge_rows(picture, camera, family, tube, reach),
        _free(family, False),
        beforehand(tube),
    )
    step, weight, _ = _solve(rows, more, free, False)
    residual = rows.off - rows.slope @ step
    covariance = _covariance(rows, more, free, weight, residual)
    tube = _kept(tube.of(tube.values() + step), family)
    believed = weight > _BELIEVED
    share = np.array(
        [believed[rows.sector == k].mean() if (rows.sector == k).any() else 0.0
         for k in range(family.joints + 1)]
    )  # fmt: skip
    outline = camera.lines(tube.outline(family), tube.place, tube.size)
    rms = float(np.sqrt(np.mean(residual[believed] ** 2))) if believed.any() else np.nan
    return Fitted(
        tube, covariance, rows.px[rows.seen], rows.sector[rows.seen], believed[rows.seen],
        share, rms, float(1.0 - picture.inside(outline, 0.0).mean()),
    )  # fmt: skip


def _kept(tube: Tube, family: Family) -> Tube:
    return replace(tube, bar=float(np.clip(tube.bar, 0.0, family.top)))


def _free(family: Family, whole: bool) -> BoolArray:
    """Which values are fitted: the model's pressure, or each joint by itself."""
    joints = np.full(3 * family.joints, not whole)
    return np.concatenate([[True] * 4, [whole], joints])


def _solve(
    rows: Rows, more: Gaps, free: BoolArray, wide: bool
) -> tuple[FloatArray, FloatArray, float]:
    """Fit robustly; the step (V,), the weights (N,) of the edges, and their scatter, px."""
    slope = rows.slope[:, free]
    step = np.zeros(int(free.sum()))
    weight, scale = rows.seen.astype(float), 1.0
    for _ in range(8):
        residual = rows.off - slope @ step
        scale = _scatter(residual[rows.seen])
        if not wide:
            scale = min(scale, max(_MODEL_PX, _MOST_MM * rows.px_per_mm))
        z = residual / scale
        if wide:
            weight = rows.seen / (1.0 + (z / _CAUCHY) ** 2)
        else:
            weight = rows.seen * np.clip(1.0 - (z / _TUKEY) ** 2, 0.0, None) ** 2
        root = np.sqrt(weight) / scale
        A = np.concatenate([root[:, None] * slope, more.slope[:, free]])
        step = np.linalg.lstsq(A, np.concatenate([root * rows.off, more.off]), rcond=None)[0]
    whole = np.zeros(len(free))
    whole[free] = step
    return whole, weight, scale


def _scatter(residual: FloatArray) -> float:
    if not len(residual):
        return 1.0
    return max(_MODEL_PX, 1.4826 * float(np.median(np.abs(residual))))


def _covariance(
    rows: Rows, more: Gaps, free: BoolArray, weight: FloatArray, residual: FloatArray
) -> FloatArray:
    """Covariance of the values; edges that hang together count for fewer."""
    believed = weight > _BELIEVED
    spread = float(np.sqrt(np.mean(residual[believed] ** 2))) if believed.any() else 1.0
    spread = max(spread, _LEAST_PX) * np.sqrt(_together(residual, believed, rows.group))
    A = (np.sqrt(weight) / spread)[:, None] * rows.slope[:, free]
    A = np.concatenate([A, more.slope[:, free]])
    found = np.zeros((len(free), len(free)))
    found[np.ix_(free, free)] = np.linalg.inv(A.T @ A)
    return found


def _together(residual: FloatArray, believed: BoolArray, group: IntArray) -> float:
    """By how much the variance of a mean is more than that of independent residuals."""
    square = float(np.mean(residual[believed] ** 2)) if believed.any() else 1.0
    total = 1.0
    for lag in range(1, _LAGS + 1):
        both = believed[lag:] & believed[:-lag] & (group[lag:] == group[:-lag])
        if both.sum() < 10:
            break
        shared = float(np.mean(residual[lag:][both] * residual[:-lag][both])) / square
        if shared <= 0.0:
            break
        total += 2.0 * shared
    return total
