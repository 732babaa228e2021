"""Obstacles that a plane outline makes: extruded, or turned about an axis.

The plane is that of bending. Its coordinates (u, v) are the model's (z, y): along the straight
tube, and away from the object. The body lies on the right of the outline as it is gone along.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.ndimage import gaussian_filter1d
from scipy.spatial import cKDTree

from fem.arrays import BoolArray, FloatArray
from fem.gap import NEAR_MM, Gap

STEP_MM = 0.1
SMOOTH_MM = 0.5  # standard deviation of what the outline is smoothed by
_AHEAD_MM = 50.0  # that an open outline goes on straight
_CELL_MM = 1.0  # of the raster that tells what is near
_BEYOND_MM = 5.0  # that the raster reaches beyond the outline
_ROUNDS = 3
_FLAT = 0.05  # of 1 + k g, next to a centre of curvature


class Outline:
    """A smooth curve with the signed distance of points in its plane.

    Parameters
    ----------
    points : (N, 2) mm
        In order; the body is on their right.
    closed : bool
        An open outline goes on straight at both ends.
    smooth_mm : float
        Standard deviation of the smoothing along the curve.
    back_mm : float
        How far the body lies behind the points.

    Raises
    ------
    ValueError
        When the points make no curve.
    """

    def __init__(
        self,
        points: FloatArray,
        *,
        closed: bool = False,
        smooth_mm: float = SMOOTH_MM,
        back_mm: float = 0.0,
    ) -> None:
        if len(points) < 3 or not np.isfinite(points).all():
            raise ValueError("an outline needs three points or more")
        s, even = _spaced(_prolonged(points, closed), closed)
        if smooth_mm > 0.0:
            mode: Literal["wrap", "nearest"] = "wrap" if closed else "nearest"
            body = even[:-1] if closed else even
            even = gaussian_filter1d(body, smooth_mm / (s[1] - s[0]), axis=0, mode=mode)
            even = np.concatenate([even, even[:1]]) if closed else even
        self._s = s
        self._at = CubicSpline(s, even, bc_type="periodic" if closed else "natural")
        self._closed, self._back = closed, back_mm
        self._tree = cKDTree(even)
        tangent = self._at(s, 1)
        self._normal = _left(tangent / np.linalg.norm(tangent, axis=1)[:, None])
        self._points = even
        self._corner = even.min(axis=0) - _BEYOND_MM
        self._near = self._raster(even.max(axis=0) + _BEYOND_MM)

    def _raster(self, last: FloatArray) -> BoolArray:
        """Cells about the outline that hold points less than `NEAR_MM` away, or in the body."""
        count = np.ceil((last - self._corner) / _CELL_MM).astype(int)
        at = np.stack(np.meshgrid(*(np.arange(n) + 0.5 for n in count), indexing="ij"), axis=-1)
        middle = (self._corner + _CELL_MM * at).reshape(-1, 2)
        far, k = self._tree.query(middle)
        outside = ((middle - self._points[k]) * self._normal[k]).sum(axis=1) > 0.0
        reach = NEAR_MM + _CELL_MM
        return np.asarray(~(outside & (far > reach))).reshape(*count)

    def near(self, p: FloatArray) -> BoolArray:
        """Tell which points p (n, 2) may be less than `NEAR_MM` away, or in the body: (n,)."""
        cell = np.floor((p - self._corner) / _CELL_MM).astype(int)
        return np.asarray(self._near[tuple(np.clip(cell, 0, np.array(self._near.shape) - 1).T)])

    def distance(self, p: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """Signed distance of points p (n, 2), exact where it is below 1 mm.

        Returns
        -------
        distance : (n,) mm
            Negative in the body.
        tangent, normal : (n, 2)
            At the closest point, the normal outward.
        curvature : (n,) 1/mm
            Of the level curve through the point: positive where the body is convex.
        """
        _, nearest = self._tree.query(p)
        s = self._s[nearest].copy()
        normal = self._normal[nearest]
        distance = ((p - self._points[nearest]) * normal).sum(axis=1)
        tangent = -_left(normal)
        curvature = np.zeros(len(p))
        near = np.flatnonzero(distance < NEAR_MM)
        if near.size:
            at = self._closest(p[near], s[near])
            foot, slope, second = (self._at(at, k) for k in (0, 1, 2))
            speed = np.linalg.norm(slope, axis=1)
            t = slope / speed[:, None]
            n = _left(t)
            k = -(second * n).sum(axis=1) / speed**2
            g = ((p[near] - foot) * n).sum(axis=1)
            distance[near], tangent[near], normal[near] = g, t, n
            curvature[near] = k / np.maximum(1.0 + k * g, _FLAT)
        return distance + self._back, tangent, normal, curvature

    def _closest(self, p: FloatArray, s: FloatArray) -> FloatArray:
        """Arc lengths of the closest points, from those of the nearest samples."""
        first = s
        for _ in range(_ROUNDS):
            foot, slope, second = (self._at(s, k) for k in (0, 1, 2))
            arm = p - foot
            speed = (slope**2).sum(axis=1)
            fall = np.maximum(speed - (arm * second).sum(axis=1), _FLAT * speed)
            s = first + np.clip(s - first + (arm * slope).sum(axis=1) / fall, -STEP_MM, STEP_MM)
            if not self._closed:
                s = np.clip(s, self._s[0], self._s[-1])
        return s


@dataclass(frozen=True)
class Extruded:
    """An outline that is the same at every distance from the plane of bending."""

    outline: Outline

    def near(self, x: FloatArray) -> BoolArray:
        """See `fem.gap.Obstacle`."""
        return self.outline.near(x[..., [2, 1]])

    def gap(self, x: FloatArray) -> Gap:
        """See `fem.gap.Obstacle`."""
        distance, t, n, k = self.outline.distance(x[..., [2, 1]])
        along = _placed(t[:, 0], t[:, 1])
        bend = k[:, None, None] * along[:, :, None] * along[:, None, :]
        return Gap(distance, _placed(n[:, 0], n[:, 1]), bend)


@dataclass(frozen=True)
class Revolved:
    """An outline turned about an axis in the plane of bending.

    Attributes
    ----------
    outline : Outline
        In (u, v), of the side of the axis toward which ``out`` points.
    point : (2,) mm
        On the axis.
    axis, out : (2,)
        Unit vectors along the axis and away from it.
    """

    outline: Outline
    point: FloatArray
    axis: FloatArray
    out: FloatArray

    def _turned(self, x: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Points (n, 2) turned into the plane, and how far off the axis before and after."""
        arm = x[:, [2, 1]] - self.point
        along, off = arm @ self.axis, arm @ self.out
        r = np.maximum(np.hypot(off, x[:, 0]), 1e-9)
        return self.point + along[:, None] * self.axis + r[:, None] * self.out, off, r

    def near(self, x: FloatArray) -> BoolArray:
        """See `fem.gap.Obstacle`."""
        return self.outline.near(self._turned(x)[0])

    def gap(self, x: FloatArray) -> Gap:
        """See `fem.gap.Obstacle`."""
        p, off, r = self._turned(x)
        distance, t, n, k = self.outline.distance(p)
        outward = _placed(*(off / r * self.out[:, None])) + _across(x[:, 0] / r)
        around = _placed(*(-x[:, 0] / r * self.out[:, None])) + _across(off / r)
        axis = _placed(*(np.ones_like(r) * self.axis[:, None]))

        def in_space(v: FloatArray) -> FloatArray:
            turned: FloatArray = (v @ self.axis)[:, None] * axis + (v @ self.out)[:, None] * outward
            return turned

        tangent = in_space(t)
        bend = k[:, None, None] * tangent[:, :, None] * tangent[:, None, :]
        bend += ((n @ self.out) / r)[:, None, None] * around[:, :, None] * around[:, None, :]
        return Gap(distance, in_space(n), bend)


def _left(v: FloatArray) -> FloatArray:
    return np.stack([-v[..., 1], v[..., 0]], axis=-1)


def _placed(u: FloatArray, v: FloatArray) -> FloatArray:
    """Vectors of the plane (u, v) in the model's x, y, z."""
    return np.stack([np.zeros_like(u), v, u], axis=-1)


def _across(x: FloatArray) -> FloatArray:
    return np.stack([x, np.zeros_like(x), np.zeros_like(x)], axis=-1)


def _prolonged(points: FloatArray, closed: bool) -> FloatArray:
    if closed:
        return points if np.allclose(points[0], points[-1]) else np.vstack([points, points[:1]])
    first, last = points[0] - points[1], points[-1] - points[-2]
    return np.vstack(
        [
            points[0] + _AHEAD_MM * first / np.linalg.norm(first),
            points,
            points[-1] + _AHEAD_MM * last / np.linalg.norm(last),
        ]
    )


def _spaced(points: FloatArray, closed: bool) -> tuple[FloatArray, FloatArray]:
    """Arc lengths (n,) and points (n, 2), every 0.1 mm."""
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    kept = np.concatenate([[True], steps > 0.0])
    points, along = points[kept], np.concatenate([[0.0], np.cumsum(steps[steps > 0.0])])
    if along[-1] < 10.0 * STEP_MM:
        raise ValueError("an outline must be a millimetre long or more")
    s = np.linspace(0.0, along[-1], int(np.ceil(along[-1] / STEP_MM)) + 1)
    return s, np.column_stack([np.interp(s, along, points[:, k]) for k in (0, 1)])
