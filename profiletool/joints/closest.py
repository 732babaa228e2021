"""Closest points of a bent tube's object-facing line to its profile, and their signed distances."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from profiletool.profile.curve import arc_length, points_at
from profiletool.records.profile import Profile
from profiletool.records.units import FloatArray

STEP_MM = 0.5  # spacing of the profile's points that count
_TOUCHING_MM = 1e-6  # a distance with no direction


def target_points(profile: Profile, step_mm: float = STEP_MM) -> FloatArray:
    """Points of a profile that count, evenly spaced, both ends among them: (M, 2) mm."""
    return _spaced(profile.s, profile.points, step_mm)


def spaced(points: FloatArray, step_mm: float = STEP_MM) -> FloatArray:
    """Space the points (N, 2) of a line evenly: as `target_points`."""
    return _spaced(arc_length(points), points, step_mm)


def _spaced(s: FloatArray, points: FloatArray, step_mm: float) -> FloatArray:
    count = max(round(float(s[-1]) / step_mm), 1)
    return points_at(np.linspace(0.0, float(s[-1]), count + 1), s, points)


@dataclass(frozen=True)
class ClosestPoints:
    """Points of an object-facing line, the closest to each of M points.

    Attributes
    ----------
    distance : (M,) mm
        Signed: negative where the line lies on the object's side of the point. Beyond the line's
        ends the distance to the end, positive.
    normal : (M, 2)
        Unit vectors: the distance changes by normal . motion of the closest point.
    first : (M,)
        Index of the line's point before the closest one.
    share : (M,)
        Of the way from that point to the next one.
    """

    distance: FloatArray
    normal: FloatArray
    first: NDArray[np.intp]
    share: FloatArray

    def at(self, values: FloatArray) -> FloatArray:
        """Interpolate values of the line's points, (..., N, k), to the closest: (..., M, k)."""
        share = self.share[:, None]
        here, ahead = values[..., self.first, :], values[..., self.first + 1, :]
        return (1.0 - share) * here + share * ahead


def closest_points(facing: FloatArray, points: FloatArray, sign: float) -> ClosestPoints:
    """Find where a line is closest to points.

    Parameters
    ----------
    facing : (N, 2) array, mm
        The object-facing line, from the clamped end; N at least 2.
    points : (M, 2) array, mm
    sign : float
        +1 where the object lies to the left of the line's direction, else -1 (see `Profile.sign`).
    """
    _, nearest = cKDTree(facing).query(points)
    nearest = np.asarray(nearest, dtype=np.intp)
    last = len(facing) - 2
    before = _on_segments(facing, points, np.maximum(nearest - 1, 0), sign)
    after = _on_segments(facing, points, np.minimum(nearest, last), sign)
    nearer = np.abs(after.distance) < np.abs(before.distance)
    return ClosestPoints(
        np.where(nearer, after.distance, before.distance),
        np.where(nearer[:, None], after.normal, before.normal),
        np.where(nearer, after.first, before.first),
        np.where(nearer, after.share, before.share),
    )


def _on_segments(
    facing: FloatArray, points: FloatArray, first: NDArray[np.intp], sign: float
) -> ClosestPoints:
    """Closest points (M,) on one segment each, that behind the line's point ``first`` (M,)."""
    start, step = facing[first], facing[first + 1] - facing[first]
    length = np.maximum(np.hypot(*step.T), 1e-12)
    along = np.einsum("mk,mk->m", points - start, step) / length**2
    share = np.clip(along, 0.0, 1.0)
    away = start + share[:, None] * step - points
    outward = sign * np.column_stack([step[:, 1], -step[:, 0]]) / length[:, None]
    magnitude = np.hypot(*away.T)
    # Past either end of the whole line there is no inside.
    beyond = ((along < 0.0) & (first == 0)) | ((along > 1.0) & (first == len(facing) - 2))
    inside = (np.einsum("mk,mk->m", away, outward) < 0.0) & ~beyond
    distance = np.where(inside, -magnitude, magnitude)
    apart = magnitude > _TOUCHING_MM
    normal = np.where(apart[:, None], away / np.where(apart, distance, 1.0)[:, None], outward)
    return ClosestPoints(distance, normal, first, share)


def distance_jacobian(closest: ClosestPoints, motion: FloatArray) -> FloatArray:
    """Differentiate the signed distances by the numbers that move the line: (M, q).

    The closest points slide along the line as it moves, which changes no distance to first order;
    so the points whose motion is given may be material ones or any others that stay on the line.

    Parameters
    ----------
    closest : ClosestPoints
    motion : (q, N, 2) array
        Motion of the line's points by each number.
    """
    return np.asarray(np.einsum("mk,qmk->mq", closest.normal, closest.at(motion)))
