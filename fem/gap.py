"""The gap between points and an obstacle, and the obstacles of simple shape."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from fem.arrays import BoolArray, FloatArray

NEAR_MM = 1.0  # within which gaps are exact
_LEAST = 1e-9  # mm, of a distance that is divided by


@dataclass(frozen=True)
class Gap:
    """Gaps of points (...).

    Attributes
    ----------
    distance : (...), mm
        From the obstacle; negative inside it.
    normal : (..., 3)
        Its gradient: the obstacle's outward unit normal at the closest point.
    bend : (..., 3, 3), 1/mm
        Its second derivative.
    """

    distance: FloatArray
    normal: FloatArray
    bend: FloatArray


class Obstacle(Protocol):
    """A rigid body."""

    def gap(self, x: FloatArray) -> Gap:
        """Give the gaps of points x (n, 3), mm."""

    def near(self, x: FloatArray) -> BoolArray:
        """Tell quickly which points (n, 3) may be less than `NEAR_MM` away, or inside: (n,)."""


@dataclass(frozen=True)
class Plane:
    """All that lies behind a plane.

    Attributes
    ----------
    point : (3,) mm
    normal : (3,)
        Outward, a unit vector.
    """

    point: FloatArray
    normal: FloatArray

    def near(self, x: FloatArray) -> BoolArray:
        """See `Obstacle`."""
        return np.asarray((x - self.point) @ self.normal < NEAR_MM)

    def gap(self, x: FloatArray) -> Gap:
        """See `Obstacle`."""
        normal = np.broadcast_to(self.normal, x.shape)
        return Gap((x - self.point) @ self.normal, normal, np.zeros((*x.shape, 3)))


@dataclass(frozen=True)
class Cylinder:
    """A cylinder without ends.

    Attributes
    ----------
    point : (3,) mm
        On its axis.
    axis : (3,)
        A unit vector.
    radius : float, mm
    inside : bool
        Whether the body is what lies outside of the cylinder, as a sleeve is.
    """

    point: FloatArray
    axis: FloatArray
    radius: float
    inside: bool = False

    def near(self, x: FloatArray) -> BoolArray:
        """See `Obstacle`."""
        return self.gap(x).distance < NEAR_MM

    def gap(self, x: FloatArray) -> Gap:
        """See `Obstacle`."""
        arm = x - self.point
        return _round(arm - (arm @ self.axis)[..., None] * self.axis, self.radius, self.inside,
                      np.eye(3) - np.outer(self.axis, self.axis))  # fmt: skip


@dataclass(frozen=True)
class Sphere:
    """A ball.

    Attributes
    ----------
    centre : (3,) mm
    radius : float, mm
    """

    centre: FloatArray
    radius: float

    def near(self, x: FloatArray) -> BoolArray:
        """See `Obstacle`."""
        return np.asarray(np.linalg.norm(x - self.centre, axis=-1) < self.radius + NEAR_MM)

    def gap(self, x: FloatArray) -> Gap:
        """See `Obstacle`."""
        return _round(x - self.centre, self.radius, False, np.eye(3))


def _round(arm: FloatArray, radius: float, inside: bool, across: FloatArray) -> Gap:
    """Gap to what has one curvature in all directions of ``across`` (3, 3)."""
    far = np.maximum(np.linalg.norm(arm, axis=-1), _LEAST)
    n = arm / far[..., None]
    bend = (across - n[..., :, None] * n[..., None, :]) / far[..., None, None]
    sign = -1.0 if inside else 1.0
    return Gap(sign * (far - radius), sign * n, sign * bend)
