"""The misfit between a bent tube and its profile: closest points, distances, cost and Jacobian."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from profiletool.records.design import Misfit
from profiletool.records.frames import Shape
from profiletool.records.profile import Profile
from profiletool.records.units import FloatArray

Float32 = NDArray[np.float32]
DEPTH_WEIGHT = 4.0  # of the square of what lies deeper in the object than it may


def depth_cost(depth: Float32, interference: float) -> Float32:
    """Square of a distance, more where it lies too deep in the object (depth positive)."""
    deep = np.maximum(depth - np.float32(interference), 0.0)
    return np.asarray(depth * depth + np.float32(DEPTH_WEIGHT) * deep * deep, dtype=np.float32)


def misfit(shape: Shape, profile: Profile) -> Misfit:
    """Distance between the object-facing line and the target profile, both ways.

    Every point of the profile counts with its distance to the line, and every point of the line
    with its distance to the profile, but for what lies beyond the profile's ends; both ways weigh
    the same.
    """
    return misfit_to(shape, profile.points)


def misfit_to(shape: Shape, points: FloatArray) -> Misfit:
    """Give the same for a profile of which only the points (N, 2) are known, 0.1 mm apart."""
    line, target = shapely.LineString(shape.facing), _target_line(points)
    shapely.prepare([line, target])
    to_line = shapely.distance(shapely.points(points), line)
    _, inside = _beside(shape, target)
    to_target = shapely.distance(shapely.points(shape.facing[inside]), target)
    ways = [way for way in (to_line, to_target) if len(way)]
    rms = np.sqrt(np.mean([np.mean(way**2) for way in ways]))
    return Misfit(float(rms), float(max(way.max() for way in ways)))


def depth_inside(shape: Shape, profile: Profile) -> float:
    """How deep the object-facing line lies inside the object at most, mm; 0 where it does not."""
    target = _target_line(profile.points)
    along, inside = _beside(shape, target)
    at = np.searchsorted(profile.s, along * (profile.length_mm / target.length))
    at = np.clip(at, 0, len(profile.s) - 1)
    away = shape.facing - profile.points[at]
    heading = profile.heading[at]
    inward = profile.sign * (np.cos(heading) * away[:, 1] - np.sin(heading) * away[:, 0])
    return float(np.max(inward, where=inside, initial=0.0))


def _target_line(points: FloatArray) -> shapely.LineString:
    """Thin a profile for distances: at half a millimetre an arc of 10 mm is right to 0.003 mm."""
    every = np.append(np.arange(0, len(points) - 1, 5), len(points) - 1)
    return shapely.LineString(points[every])


def _beside(shape: Shape, target: shapely.LineString) -> tuple[FloatArray, NDArray[np.bool_]]:
    """Where along the target each point of the facing line lies, and whether beyond neither end."""
    along = np.asarray(shapely.line_locate_point(target, shapely.points(shape.facing)))
    return along, (along > 0.0) & (along < target.length)


STEP_MM = 0.5  # spacing of the profile's points that count
_TOUCHING_MM = 1e-6  # a distance with no direction


def target_points(profile: Profile, step_mm: float = STEP_MM) -> FloatArray:
    """Points of a profile that count, evenly spaced, both ends among them: (M, 2) mm."""
    count = max(round(profile.length_mm / step_mm), 1)
    s = np.linspace(0.0, profile.length_mm, count + 1)
    return np.column_stack([np.interp(s, profile.s, profile.points[:, k]) for k in (0, 1)])


@dataclass(frozen=True)
class Feet:
    """Where a line is nearest to each of M points.

    Attributes
    ----------
    gap : (M,) mm
        Distance, negative where the line lies on the object's side of the point. Beyond the
        line's ends the distance to the end, positive.
    normal : (M, 2)
        Unit vectors: gap changes by normal . motion of the foot.
    first : (M,)
        Index of the line's point before the foot.
    share : (M,)
        Of the way from that point to the next one.
    """

    gap: FloatArray
    normal: FloatArray
    first: NDArray[np.intp]
    share: FloatArray

    def at(self, values: FloatArray) -> FloatArray:
        """Interpolate what is given at the line's points, (..., N, k), to the feet: (..., M, k)."""
        share = self.share[:, None]
        here, ahead = values[..., self.first, :], values[..., self.first + 1, :]
        return (1.0 - share) * here + share * ahead


def feet(facing: FloatArray, points: FloatArray, sign: float) -> Feet:
    """Find the feet of points (M, 2) on an object-facing line (N, 2)."""
    _, nearest = cKDTree(facing).query(points)
    nearest = np.asarray(nearest, dtype=np.intp)
    last = len(facing) - 2
    best: Feet | None = None
    for first in (np.maximum(nearest - 1, 0), np.minimum(nearest, last)):
        found = _on_segments(facing, points, first, sign)
        if best is None:
            best = found
            continue
        nearer = np.abs(found.gap) < np.abs(best.gap)
        best = Feet(
            np.where(nearer, found.gap, best.gap),
            np.where(nearer[:, None], found.normal, best.normal),
            np.where(nearer, found.first, best.first),
            np.where(nearer, found.share, best.share),
        )
    assert best is not None
    return best


def _on_segments(
    facing: FloatArray, points: FloatArray, first: NDArray[np.intp], sign: float
) -> Feet:
    start, step = facing[first], facing[first + 1] - facing[first]
    length = np.maximum(np.hypot(*step.T), 1e-12)
    along = np.einsum("mk,mk->m", points - start, step) / length**2
    share = np.clip(along, 0.0, 1.0)
    away = start + share[:, None] * step - points
    outward = sign * np.column_stack([step[:, 1], -step[:, 0]]) / length[:, None]
    distance = np.hypot(*away.T)
    # Past either end of the whole line there is no inside.
    beyond = ((along < 0.0) & (first == 0)) | ((along > 1.0) & (first == len(facing) - 2))
    inside = (np.einsum("mk,mk->m", away, outward) < 0.0) & ~beyond
    gap = np.where(inside, -distance, distance)
    apart = distance > _TOUCHING_MM
    normal = np.where(apart[:, None], away / np.where(apart, gap, 1.0)[:, None], outward)
    return Feet(gap, normal, first, share)


def residual_jacobian(found: Feet, motion: FloatArray) -> FloatArray:
    """Differentiate the gaps: (M, size), given the motion of the line's points, (size, N, 2).

    The feet slide along the line as it moves, which changes no distance to first order; so the
    points whose motion is given may be material ones or any others that stay on the line.
    """
    return np.asarray(np.einsum("mk,qmk->mq", found.normal, found.at(motion)))


_WEIGHT = 4.0  # of depth inside the object beyond what is allowed, against distance


def badness(gap: FloatArray, interference_mm: float) -> FloatArray:
    """Mean squared distance (...,) of gaps (..., M), depth beyond what is allowed weighing more."""
    deep = np.minimum(gap + interference_mm, 0.0)
    worth: FloatArray = np.mean(gap**2 + _WEIGHT * deep**2, axis=-1)
    return worth
