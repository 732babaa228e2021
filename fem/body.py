"""A rigid obstacle that may move in the plane x = 0: its motion, and the border of the equations.

The motion q has two translations and a turn, or some directions among them. Seen from the
obstacle, a point x is at y = R(-turn) (x - about - shift); contact's potential is one of y. Its
derivatives by q border the tangent K of the tube:

    [K  B] [du]     [residual]
    [B' C] [dq] = - [s       ]
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem.arrays import BoolArray, FloatArray
from fem.contact import Contact, Surface
from fem.gap import Gap, Obstacle
from fem.mesh import Mesh


@dataclass(frozen=True)
class Body:
    """How an obstacle may move, and what pulls at it.

    Attributes
    ----------
    ways : (k, 3)
        Directions of its motion: along y, along z (mm), and a turn about x (rad).
    load : (3,)
        Force along y and z on the whole tube's obstacle, N, and moment about x, N mm.
    about : (3,) mm
        Where it turns about, in the plane x = 0.
    """

    ways: FloatArray
    load: FloatArray
    about: FloatArray


@dataclass(frozen=True)
class Moved:
    """An obstacle off its place.

    Attributes
    ----------
    obstacle : Obstacle
    motion : (3,)
        Along y and z, mm, and about x, rad.
    about : (3,) mm
    """

    obstacle: Obstacle
    motion: FloatArray
    about: FloatArray

    def _turned(self) -> FloatArray:
        c, s = np.cos(self.motion[2]), np.sin(self.motion[2])
        return np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])

    def _seen(self, x: FloatArray) -> FloatArray:
        centre = self.about + np.array([0.0, *self.motion[:2]])
        return np.asarray((x - centre) @ self._turned() + self.about)

    def near(self, x: FloatArray) -> BoolArray:
        """See `fem.gap.Obstacle`."""
        return self.obstacle.near(self._seen(x))

    def gap(self, x: FloatArray) -> Gap:
        """See `fem.gap.Obstacle`."""
        found, R = self.obstacle.gap(self._seen(x)), self._turned()
        return Gap(found.distance, found.normal @ R.T, R @ found.bend @ R.T)


@dataclass(frozen=True)
class Border:
    """Derivatives of contact's potential by the motion; those of half a tube in a half model.

    Attributes
    ----------
    slope : (k,)
        By the motion: the force that would hold the obstacle against the tube.
    mixed : (k, layers + 1, ring + mid, 3)
        By the motion and the nodes.
    curve : (k, k)
        By the motion twice.
    """

    slope: FloatArray
    mixed: FloatArray
    curve: FloatArray


def border_of(
    contact: Contact, mesh: Mesh, x: FloatArray, body: Body, motion: FloatArray
) -> Border:
    """Give the border at nodes x, where contact's obstacle is moved by ``motion`` (3,)."""
    surface = Surface.of(mesh)
    points = surface.points(x.reshape(-1, 3))
    offset = 0.0 if contact.offset is None else contact.offset
    _, push, moduli = contact.derivatives(points, surface.area, offset)
    flat, G, K = points.reshape(-1, 3), push.reshape(-1, 3), moduli.reshape(-1, 3, 3)
    arm = flat - body.about - np.array([0.0, *motion[:2]])
    shifts = np.pad(body.ways[:, :2], ((0, 0), (1, 0)))  # (k, 3)
    turns = body.ways[:, 2]
    velocity = shifts[:, None] + turns[:, None, None] * _about_x(arm)  # (k, n, 3)
    stiff = np.einsum("nij,knj->kni", K, velocity)
    mixed = -stiff + turns[:, None, None] * _about_x(G)
    pull = G.sum(axis=0)
    lever = turns[:, None] * (_about_x(shifts) @ pull)[None, :]
    curve = np.einsum("kni,lni->kl", velocity, stiff) + lever + lever.T
    curve += np.outer(turns, turns) * float((G * _about_x(_about_x(arm))).sum())
    nodal = np.zeros((len(turns), x.size // 3, 3))
    for rows, each in zip(nodal, mixed.reshape(-1, *points.shape), strict=True):
        np.add.at(rows, surface.nodes, surface.N.T @ each)
    slope = -np.einsum("ni,kni->k", G, velocity)
    return Border(slope, nodal.reshape(-1, *x.shape), curve)


def _about_x(v: FloatArray) -> FloatArray:
    """Cross the x axis with vectors (..., 3)."""
    return np.stack([np.zeros_like(v[..., 0]), -v[..., 2], v[..., 1]], axis=-1)
