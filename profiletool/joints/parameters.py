"""An actuator as a vector of numbers to be fitted, and its residuals against a profile.

Glossary
--------
n : number of joints
place : where joint 1's centre lies along the base line, from the profile's start
feet : the points of the object-facing line that are nearest to the profile's
gap : what a residual is: distance, positive where the tube stands off the object, mm
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from profiletool.joints.model import Chain, Model
from profiletool.records import FloatArray, Pose, Profile, Shape

STEP_MM = 0.5  # spacing of the profile's points that count
PLACE_BACK_MM = 30.0  # joint 1 may lie this far before the profile's start
_TOUCHING_MM = 1e-6  # a distance with no direction


@dataclass(frozen=True)
class Limits:
    """What the tube, the gauze and the user allow.

    Attributes
    ----------
    alpha, pressure : (float, float)
        rad, MPa.
    wrap_mm, end_mm, root_mm : float
        Least wrapped length between two windows and at the closed end; least distance of the
        first joint's centre from the clamped end.
    max_length_mm : float
    base_turn_rad, base_offset_mm : float
        How far the base may turn away from the profile's start tangent and lie off it, either
        way; both 0 where it is fixed.
    """

    alpha: tuple[float, float]
    pressure: tuple[float, float]
    wrap_mm: float
    end_mm: float
    root_mm: float
    max_length_mm: float
    base_turn_rad: float = 0.0
    base_offset_mm: float = 0.0

    @property
    def base_free(self) -> bool:
        """Whether the base may leave the profile's start tangent."""
        return self.base_turn_rad > 0.0 or self.base_offset_mm > 0.0


@dataclass(frozen=True)
class Actuator:
    """A chain of joints under pressure, clamped in a pose; ``pressure`` in MPa."""

    chain: Chain
    pressure: float
    pose: Pose


@dataclass(frozen=True)
class Parameters:
    """Which numbers of an actuator are free, and in which order.

    A vector holds, one after the other:

    =========  =========  ====================================================================
    alpha      n          rad
    wrapped    n - 1      mm, between the windows
    place      1          mm, of joint 1 along the base line from the profile's start
    pressure   1          MPa
    turn       0 or 1     rad, of the base from the start tangent, toward the object positive
    offset     0 or 1     mm, of the base from the profile's start, away from the object
    =========  =========  ====================================================================

    The last two only where `Limits.base_free`. The clamped end follows from ``place``: at the
    profile's start, or behind it where joint 1 would be nearer to it than the limits allow. In
    either case joint 1 and all behind it slide along the base line with ``place``.

    Attributes
    ----------
    openF, sense : (n,)
        As in `Chain`.
    end_mm : float
        Wrapped length at the closed end.
    start : (x, y), mm
    heading : float, rad
        The profile's start and its direction.
    sign : float
        Of the profile.
    limits : Limits
    """

    openF: FloatArray
    sense: FloatArray
    end_mm: float
    start: tuple[float, float]
    heading: float
    sign: float
    limits: Limits

    @property
    def joints(self) -> int:
        """Number of joints."""
        return len(self.openF)

    @property
    def size(self) -> int:
        """Length of a vector."""
        return 2 * self.joints + 1 + 2 * self.limits.base_free

    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """Give the least and the largest vector: (size,) each."""
        n, limits = self.joints, self.limits
        free = np.array([limits.base_turn_rad, limits.base_offset_mm] * limits.base_free)
        low = [limits.alpha[0]] * n + [limits.wrap_mm] * (n - 1)
        high = [limits.alpha[1]] * n + [np.inf] * (n - 1)
        low += [-PLACE_BACK_MM, limits.pressure[0]]
        high += [np.inf, limits.pressure[1]]
        return np.concatenate([low, -free]), np.concatenate([high, free])

    def scale(self) -> FloatArray:
        """Give changes that move the shape by about as much: (size,)."""
        n = self.joints
        scale = [0.1] * n + [1.0] * (n - 1) + [1.0, 0.004] + [0.02, 1.0] * self.limits.base_free
        return np.array(scale)

    def root(self, place: float) -> float:
        """Distance of joint 1's centre from the clamped end, mm."""
        room = 0.5 * float(self.openF[0]) + self.limits.wrap_mm
        return max(self.limits.root_mm, room, place)

    def root_grows(self, vector: FloatArray) -> bool:
        """Whether the root grows with ``place``; else joint 1 slides with all of the tube."""
        place = float(vector[2 * self.joints - 1])
        return self.root(place + 1e-6) > self.root(place)

    def unpack(self, vector: FloatArray) -> Actuator:
        """Build the actuator of a vector: (size,)."""
        n = self.joints
        alpha, wrapped = vector[:n], vector[n : 2 * n - 1]
        place, pressure = (float(v) for v in vector[2 * n - 1 : 2 * n + 1])
        turn, offset = vector[2 * n + 1 :] if self.limits.base_free else (0.0, 0.0)
        root = self.root(place)
        F = 0.5 * (self.openF[1:] + self.openF[:-1]) + wrapped
        centre = root + np.concatenate([[0.0], np.cumsum(F)])
        length = float(centre[-1] + 0.5 * self.openF[-1]) + self.end_mm
        heading = self.heading + self.sign * float(turn)
        (tx, ty), (nx, ny) = base_axes(heading, self.sign)
        back = place - root
        pose = Pose(
            self.start[0] + back * tx + float(offset) * nx,
            self.start[1] + back * ty + float(offset) * ny,
            float(np.degrees(heading)),
        )
        return Actuator(Chain(centre, self.openF, alpha, self.sense, length), pressure, pose)

    def pack(self, actuator: Actuator) -> FloatArray:
        """Give the vector of an actuator: (size,), the inverse of `unpack` but for the end."""
        chain, pose = actuator.chain, actuator.pose
        heading = float(np.radians(pose.heading_deg))
        turn = self.sign * (heading - self.heading)
        turn = float(np.remainder(turn + np.pi, 2.0 * np.pi) - np.pi)
        along, across = base_axes(heading, self.sign)
        away = np.array([pose.x_mm, pose.y_mm]) - self.start
        place = float(away @ along) + float(chain.centre[0])
        F = np.diff(chain.centre) - 0.5 * (self.openF[1:] + self.openF[:-1])
        base = [turn, float(away @ across)] * self.limits.base_free
        return np.concatenate([chain.alpha, F, [place, actuator.pressure], base])

    def with_end(self, end_mm: float) -> Parameters:
        """Give the same with another wrapped length at the closed end."""
        return replace(self, end_mm=max(end_mm, self.limits.end_mm))


def parameters_of(chain: Chain, profile: Profile, limits: Limits) -> Parameters:
    """Free the numbers of a chain that is to follow a profile."""
    x, y = (float(v) for v in profile.points[0])
    end = chain.length - float(chain.centre[-1] + 0.5 * chain.openF[-1])
    heading = float(profile.heading[0])
    return Parameters(chain.openF, chain.sense, end, (x, y), heading, profile.sign, limits)


def base_axes(heading: float, sign: float) -> tuple[FloatArray, FloatArray]:
    """Give unit vectors along the tube and away from the object, (2,) each."""
    cos, sin = np.cos(heading), np.sin(heading)
    return np.array([cos, sin]), sign * np.array([sin, -cos])


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


def facing_motion(
    parameters: Parameters, model: Model, vector: FloatArray, shape: Shape, share: float = 0.03
) -> FloatArray:
    """Differentiate the facing line with respect to the vector, by differences: (size, N, 2).

    Points are followed by their place ``along`` the straight tube. Steps are a ``share`` of
    `Parameters.scale`, inward where a bound is near; smaller ones would see how the line is
    sampled.
    """
    _, high = parameters.bounds()
    motion = np.empty((parameters.size, *shape.facing.shape))
    for k, step in enumerate(share * parameters.scale()):
        moved = vector.copy()
        moved[k] += step if moved[k] + step <= high[k] else -step
        at = parameters.unpack(moved)
        other = model.shape(at.chain, at.pressure, at.pose, parameters.sign)
        for axis in (0, 1):
            there = np.interp(shape.along, other.along, other.facing[:, axis])
            motion[k, :, axis] = (there - shape.facing[:, axis]) / (moved[k] - vector[k])
    return motion
