"""Loads that fingers carry by friction and undercuts: linear programs over friction cones."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.optimize import linprog
from scipy.sparse import csr_array

from profiletool.records.grip import Pad, Payload
from profiletool.records.units import FloatArray

UP = np.array([0.0, 1.0, 0.0])  # of the object frame
_SIDES = 8  # of a friction cone's pyramid
_WAYS = 4  # level axes that the tilting moment is tried about
_LEAST = 1e-6  # of all force: a point that bears less does not count
_PATCH_MM = 2.5  # of the object that one point stands for where there are many
_MANY = 40  # points of a finger


def payload_of(
    pad: Pad, fingers: int, friction: tuple[float, ...], pressure_bar: float
) -> Payload | None:
    """Say what equal fingers around the object's axis, x = z = 0, carry.

    Parameters
    ----------
    pad : Pad
        Of one of them.
    fingers : int
    friction : tuple of float
        Coefficients.
    pressure_bar : float

    Returns
    -------
    Payload or None
        None where nothing touches.
    """
    size = np.linalg.norm(pad.force, axis=1)
    kept = size > _LEAST * max(float(size.sum()), 1e-300)
    if not kept.any():
        return None
    points, force = around(*_thinned(pad.points[kept], pad.force[kept]), fingers)
    alone = float(force[:, 1].sum())
    return Payload(
        fingers, pressure_bar, friction,
        tuple(most_load(points, force, mu) for mu in friction),
        tuple(least_tilt(points, force, mu) for mu in friction),
        alone,
    )  # fmt: skip


def _thinned(points: FloatArray, force: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Put points (n, 3) that are close together where their forces' middle is."""
    if len(points) <= _MANY:
        return points, force
    cells, group = np.unique(np.floor(points / _PATCH_MM), axis=0, return_inverse=True)
    size = np.linalg.norm(force, axis=1)
    total = np.bincount(group.ravel(), size, len(cells))[:, None]

    def summed(rows: FloatArray) -> FloatArray:
        columns = [np.bincount(group.ravel(), row, len(cells)) for row in rows.T]
        return np.column_stack(columns)

    resultant = summed(force)
    # As much normal force as before, along the mean normal.
    resultant *= total / np.linalg.norm(resultant, axis=1)[:, None]
    return summed(size[:, None] * points) / total, resultant


def around(points: FloatArray, force: FloatArray, fingers: int) -> tuple[FloatArray, FloatArray]:
    """Repeat points and forces (n, 3) for fingers evenly around the axis: (fingers n, 3) each."""
    turns = 2.0 * np.pi * np.arange(fingers) / fingers
    c, s, z = np.cos(turns), np.sin(turns), np.zeros(fingers)
    R = np.array([[c, z, s], [z, z + 1.0, z], [-s, z, c]]).transpose(2, 0, 1)
    turned = (np.einsum("fij,nj->fni", R, rows).reshape(-1, 3) for rows in (points, force))
    first, second = turned
    return first, second


def most_load(points: FloatArray, force: FloatArray, friction: float) -> float:
    """Largest weight that contact carries, N; 0 where not even none can be held.

    Parameters
    ----------
    points : (n, 3) mm
        Of the object, y upward.
    force : (n, 3) N
        Normal forces on the object.
    friction : float
        Coefficient: tangential forces at each point are up to so much of its normal force.
    """
    found = _solved(points, force, friction, -UP, np.zeros(3))
    return max(found, 0.0)


def least_tilt(points: FloatArray, force: FloatArray, friction: float) -> float:
    """Largest moment that contact bears about the weakest level axis through its middle, N mm.

    Whatever pushes the object up or down beside, such as a palm, is borne in the middle.
    """
    most = np.inf
    for turn in np.pi * np.arange(_WAYS) / _WAYS:
        axis = np.array([np.cos(turn), 0.0, np.sin(turn)])
        most = min(most, _solved(points, force, friction, np.zeros(3), axis))
    return max(float(most), 0.0) + 0.0  # no minus zero


def _solved(
    points: FloatArray, force: FloatArray, friction: float, push: FloatArray, turn: FloatArray
) -> float:
    """Largest share of a push (N) or a turn (N mm) that friction and normal forces balance.

    Negative where only the opposite is borne; -inf where neither.
    """
    n = len(points)
    normal = np.linalg.norm(force, axis=1)
    tangents = _tangents(force / normal[:, None])  # (n, sides, 3)
    weight = np.linalg.norm(force, axis=1).sum()
    arm = points - (normal[:, None] * points).sum(axis=0) / weight
    scale = max(float(np.abs(arm).max()), 1e-9)
    wrench = np.concatenate([tangents, np.cross(arm[:, None], tangents) / scale], axis=-1).reshape(
        -1, 6
    )
    held = np.concatenate([force.sum(axis=0), np.cross(arm, force).sum(axis=0) / scale])
    asked = np.concatenate([push, turn])
    # Unknowns: tangential forces along the pyramids' edges, then the share, either sign. A turn
    # leaves the vertical force to whatever else holds the object.
    rows = np.array([0, 2, 3, 4, 5]) if not push.any() else np.arange(6)
    equal = np.column_stack([wrench.T, asked])[rows]
    edges = np.arange(n * _SIDES)
    # scipy's stubs know of no sparse matrix here, which its documentation names first.
    cone: Any = csr_array(
        (np.ones(len(edges)), (edges // _SIDES, edges)), shape=(n, len(edges) + 1)
    )
    cost = np.zeros(n * _SIDES + 1)
    cost[-1] = -1.0
    bounds = [(0.0, None)] * (n * _SIDES) + [(None, None)]
    found = linprog(
        cost, A_ub=cone, b_ub=friction * normal, A_eq=equal, b_eq=-held[rows], bounds=bounds,
        method="highs",
    )  # fmt: skip
    if found.x is None:
        return -np.inf
    return float(found.x[-1]) * (scale if turn.any() else 1.0)


def _tangents(normal: FloatArray) -> FloatArray:
    """Edges of the friction pyramids of normals (n, 3): (n, sides, 3), one of them the steepest."""
    steep = UP - (normal @ UP)[:, None] * normal
    size = np.linalg.norm(steep, axis=1)
    level = size < 1e-9  # the steepest way on a level place is any
    steep[level] = [1.0, 0.0, 0.0]
    steep /= np.where(level, 1.0, size)[:, None]
    across = np.cross(normal, steep)
    turn = 2.0 * np.pi * np.arange(_SIDES)[:, None] / _SIDES
    return np.asarray(np.cos(turn) * steep[:, None, :] + np.sin(turn) * across[:, None, :])
