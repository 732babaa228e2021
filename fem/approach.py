"""The way of a free tube to an obstacle: its depth there, the first touch, where contact begins."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from fem.arrays import FloatArray
from fem.contact import Surface
from fem.gap import Obstacle
from fem.mesh import Mesh
from fem.sections import Chart, Pose
from fem.solution import State

_LEAN_MM = 0.4  # depth of a free state from which the tube gives way at once
_CLAMP_MM = 0.05  # depth at the clamp, where it cannot
_FINE = 8  # places between two free states, where first touch is looked for
_BISECTIONS = 20


class Approach:
    """The way of a free tube.

    Parameters
    ----------
    mesh : Mesh
    states : sequence of State
        From rest.
    obstacle : Obstacle

    Attributes
    ----------
    first_touch : float or None
        Pressure at which the free tube comes to the obstacle, MPa, once `starts` looked for it.

    Raises
    ------
    ValueError
        When half a tube meets an obstacle that is not symmetric.
    """

    def __init__(self, mesh: Mesh, states: Sequence[State], obstacle: Obstacle) -> None:
        self._mesh, self._free, self._obstacle = mesh, states, obstacle
        self._chart, self._surface = Chart(mesh), Surface.of(mesh)
        self.first_touch: float | None = None
        _check_symmetry(mesh, obstacle)

    def blocked(self) -> str:
        """Say that the clamped end lies in the obstacle; empty where it does not."""
        gap = self._obstacle.gap(self._mesh.X[0, self._mesh.outer_ring])
        deep = -float(gap.distance.min())
        return f"the clamped end lies {deep:.1f} mm deep in the object" if deep > _CLAMP_MM else ""

    def depth_of(self, x: FloatArray) -> FloatArray:
        """Depths of all points at nodes x: (L, c, q) mm."""
        points = self._surface.points(x.reshape(-1, 3))
        distance = self._obstacle.gap(points.reshape(-1, 3)).distance
        return -distance.reshape(points.shape[:3])

    def starts(self, most: float) -> list[State]:
        """Free states to begin at, best first; finds the first touch, too."""
        way = [s for s in self._free if s.pressure <= most * (1.0 + 1e-9)]
        good, stopped = [way[0]], False
        for before, after in pairwise(way):
            depths = self._depths(before, after)
            if self.first_touch is None and depths.max() > 0.0:
                self.first_touch = self._first(before, after, depths)
            stopped = stopped or bool(depths.max() > _LEAN_MM)
            if not stopped:
                good.append(after)
        return good[::-1]

    def _between(self, before: State, after: State) -> tuple[Pose, FloatArray]:
        first = self._chart.fitted(before.x)
        return first, self._chart.difference(first, self._chart.fitted(after.x))

    def depth_at(self, pose: Pose) -> float:
        """Give the largest depth at a pose, mm; below 0 outside of the obstacle."""
        points = self._surface.points(pose.x.reshape(-1, 3)).reshape(-1, 3)
        points = points[self._obstacle.near(points)]
        if not points.size:
            return -np.inf
        return -float(self._obstacle.gap(points).distance.min())

    def _depths(self, before: State, after: State) -> FloatArray:
        """Depths on the way from one free state to the next, (k,) mm."""
        pose, way = self._between(before, after)
        shares = np.linspace(0.0, 1.0, _FINE + 1)[1:]
        return np.array([self.depth_at(self._chart.move(pose, t * way)) for t in shares])

    def _first(self, before: State, after: State, depths: FloatArray) -> float:
        """Pressure of the first touch between two free states, by bisection."""
        pose, way = self._between(before, after)
        k = int(np.argmax(depths > 0.0))
        low, high = k / _FINE, (k + 1) / _FINE
        for _ in range(_BISECTIONS):
            middle = 0.5 * (low + high)
            if self.depth_at(self._chart.move(pose, middle * way)) > 0.0:
                high = middle
            else:
                low = middle
        return before.pressure + high * (after.pressure - before.pressure)


def _check_symmetry(mesh: Mesh, obstacle: Obstacle) -> None:
    if not mesh.half:
        return
    x = mesh.X[:, mesh.outer_ring].reshape(-1, 3)
    ours, theirs = (obstacle.gap(x * [sign, 1.0, 1.0]).distance for sign in (1.0, -1.0))
    if np.abs(ours - theirs).max() > 1e-6 * mesh.actuator.diameter:
        raise ValueError("half a tube cannot meet an obstacle that is not symmetric about x = 0")
