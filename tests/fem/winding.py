"""Tubes of circular section bent along chains of arcs, and another way to tell where they meet.

A point p of the surface lies in the tube where a section's plane passes through it nearer to the
section's centre than the radius: the zeros of (p - c(s)) . t(s) over the arc length s tell.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fem.sections import rotation_matrix

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class Arc:
    """Length, mm; turn, rad; direction of its axis across the tube, rad: 0 toward -y."""

    length: float
    turn: float
    axis: float = 0.0


@dataclass(frozen=True)
class Curve:
    """Sections of a bent tube at places s: centres (S, 3), mm, and rotations (S, 3, 3)."""

    s: FloatArray
    centre: FloatArray
    rotation: FloatArray

    def surface(self, radius: float, around: int) -> FloatArray:
        """Points of the surface: (S, around, 3), mm."""
        phi = 2.0 * np.pi * np.arange(around) / around
        circle = radius * np.column_stack([np.cos(phi), np.sin(phi), 0.0 * phi])
        points: FloatArray = self.centre[:, None] + circle @ np.swapaxes(self.rotation, 1, 2)
        return points


def wound(arcs: Sequence[Arc], places: FloatArray) -> Curve:
    """Lay arcs in a row, each tangent to the one before, and give the sections at places s."""
    start, turned, at = np.zeros(3), np.eye(3), 0.0
    centre, rotation = np.empty((len(places), 3)), np.empty((len(places), 3, 3))
    for number, arc in enumerate(arcs):
        last = number == len(arcs) - 1
        own = (places >= at - 1e-9) & ((places < at + arc.length - 1e-9) | last)
        to = np.append(places[own] - at, arc.length)
        spin = np.array([np.cos(arc.axis), np.sin(arc.axis), 0.0])
        angle = to * arc.turn / arc.length
        chord = rotation_matrix(0.5 * angle[:, None] * spin)[..., 2]
        c = start + (turned @ chord.T).T * (to * np.sinc(angle / (2.0 * np.pi)))[:, None]
        R = turned @ rotation_matrix(angle[:, None] * spin)
        centre[own], rotation[own] = c[:-1], R[:-1]
        start, turned, at = c[-1], R[-1], at + arc.length
    return Curve(places, centre, rotation)


def depth_by_sections(arcs: Sequence[Arc], radius: float) -> float:
    """Depth of the deepest point of the surface in another stretch of the tube, mm.

    Negative where nothing overlaps: minus the narrowest gap that a section's plane sees. Ends are
    flat. Straight out of a section, not the shortest way: a measure of its own.
    """
    length = sum(arc.length for arc in arcs)
    along = wound(arcs, np.linspace(0.0, length, int(length) + 1))
    fine = wound(arcs, np.linspace(0.0, length, 4 * int(length) + 1))
    tangent = fine.rotation[..., 2]
    disc = np.concatenate([along.surface(f * radius, 48)[[0, -1]] for f in (0.2, 0.4, 0.6, 0.8)])
    skin = along.surface(radius, 40)
    points = np.concatenate([skin.reshape(-1, 3), disc.reshape(-1, 3)])
    own = np.repeat(along.s, 40)
    own = np.concatenate([own, np.tile(np.repeat([0.0, length], 48), 4)])
    height = points @ tangent.T - (fine.centre * tangent).sum(axis=1)
    row, k = np.nonzero((height[:, :-1] > 0.0) != (height[:, 1:] > 0.0))
    share = height[row, k] / (height[row, k] - height[row, k + 1])
    s = fine.s[k] + share * np.diff(fine.s)[k]
    centre = fine.centre[k] + share[:, None] * np.diff(fine.centre, axis=0)[k]
    other = np.abs(s - own[row]) > 0.4
    away = np.linalg.norm(points[row] - centre, axis=1)[other]
    return radius - float(away.min(initial=np.inf))
