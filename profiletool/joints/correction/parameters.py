"""Parameters of an actuator: the vector of the numbers that are fitted to a profile.

Glossary
--------
n : number of joints
place : where joint 1's centre lies along the base line, from the profile's start
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from profiletool.bending.model import Chain, Model
from profiletool.joints.bounds import Limits
from profiletool.profile.curve import points_at
from profiletool.records.frames import Pose, Shape, base_axes
from profiletool.records.profile import Profile
from profiletool.records.units import FloatArray

PLACE_BACK_MM = 30.0  # joint 1 may lie this far before the profile's start


@dataclass(frozen=True)
class PosedChain:
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
    openF, alpha_center : (n,)
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
    alpha_center: FloatArray
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

    def unpack(self, vector: FloatArray) -> PosedChain:
        """Build the posed chain of a vector: (size,)."""
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
        return PosedChain(
            Chain(centre, self.openF, alpha, self.alpha_center, length), pressure, pose
        )

    def pack(self, posed: PosedChain) -> FloatArray:
        """Give the vector of a posed chain: (size,), the inverse of `unpack` but for the end."""
        chain, pose = posed.chain, posed.pose
        heading = float(np.radians(pose.heading_deg))
        turn = self.sign * (heading - self.heading)
        turn = float(np.remainder(turn + np.pi, 2.0 * np.pi) - np.pi)
        along, across = base_axes(heading, self.sign)
        away = np.array([pose.x_mm, pose.y_mm]) - self.start
        place = float(away @ along) + float(chain.centre[0])
        F = np.diff(chain.centre) - 0.5 * (self.openF[1:] + self.openF[:-1])
        base = [turn, float(away @ across)] * self.limits.base_free
        return np.concatenate([chain.alpha, F, [place, posed.pressure], base])

    def with_end(self, end_mm: float) -> Parameters:
        """Parameters with another wrapped length at the closed end, not below the least one."""
        return replace(self, end_mm=max(end_mm, self.limits.end_mm))


def parameters_of(chain: Chain, profile: Profile, limits: Limits) -> Parameters:
    """Free the numbers of a chain that is to follow a profile."""
    x, y = (float(v) for v in profile.points[0])
    end = chain.length - float(chain.centre[-1] + 0.5 * chain.openF[-1])
    heading = float(profile.heading[0])
    return Parameters(chain.openF, chain.alpha_center, end, (x, y), heading, profile.sign, limits)


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
        there = points_at(shape.along, other.along, other.facing)
        motion[k] = (there - shape.facing) / (moved[k] - vector[k])
    return motion
