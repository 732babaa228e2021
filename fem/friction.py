"""Friction of a small slip as a potential: symmetric, and exact where the slip keeps its way.

Over one step from a held state the tangential slip d of a point costs mu lambda phi(|d|), lambda
the contact pressure of the last pass and phi' a ramp from 0 to 1. A next step counts the slip from
a place that is dragged along, at most the ramp behind, so that friction is kept.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem.arrays import FloatArray, IntArray

RAMP_MM = 0.05  # of slip, over which friction sets in
_LEAST = 1e-12


@dataclass(frozen=True)
class Hold:
    """A state that points slip from: L layers, c faces, q points.

    Attributes
    ----------
    points, normal : (L, c, q, 3)
        mm, and the obstacle's normals there.
    bound : (L, c, q) MPa
        The most that friction bears, mu lambda.
    """

    points: FloatArray
    normal: FloatArray
    bound: FloatArray

    def at(self, layers: slice, faces: tuple[IntArray, ...]) -> Hold:
        """Give the part of some faces of some layers: (f, q, ...)."""
        parts = (rows[layers][faces] for rows in (self.points, self.normal, self.bound))
        return Hold(*parts)

    def dragged(self, points: FloatArray) -> FloatArray:
        """Where slip of points (L, c, q, 3) is counted from on: friction is kept, not undone."""
        slip = self._slip(points)
        size = np.linalg.norm(slip, axis=-1)
        kept = np.minimum(1.0, RAMP_MM / np.maximum(size, _LEAST))
        touching = self.bound > 0.0
        return np.asarray(points - np.where(touching, kept, 0.0)[..., None] * slip)

    def _slip(self, points: FloatArray) -> FloatArray:
        moved = points - self.points
        across = (moved * self.normal).sum(axis=-1, keepdims=True)
        return np.asarray(moved - across * self.normal)

    def respond(self, points: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Energy (..., ) N/mm, force (..., 3) MPa on the obstacle's side, stiffness (..., 3, 3)."""
        slip = self._slip(points)
        size = np.linalg.norm(slip, axis=-1)
        within = size < RAMP_MM
        phi = np.where(within, 0.5 * size**2 / RAMP_MM, size - 0.5 * RAMP_MM)
        slope = np.where(within, 1.0 / RAMP_MM, 1.0 / np.maximum(size, RAMP_MM))  # phi' / size
        curve = np.where(within, 1.0 / RAMP_MM, 0.0)
        way = slip / np.maximum(size, _LEAST)[..., None]
        flat = np.eye(3) - self.normal[..., :, None] * self.normal[..., None, :]
        along = way[..., :, None] * way[..., None, :]
        stiffness = slope[..., None, None] * flat + (curve - slope)[..., None, None] * along
        return (
            self.bound * phi,
            (self.bound * slope)[..., None] * slip,
            self.bound[..., None, None] * stiffness,
        )
