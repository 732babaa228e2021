"""Steps 4 to 6 of the paper's method: a profile to bending and nondeformable sectors.

The *lines of the discretisation* touch the profile at break points, one between every two joints
and one at each end. Two lines that follow each other meet where the curvature between their break
points is centred (exactly so for small turns), which is where the paper puts the bending sector,
and the angle between them is the joint's theta. So choosing joints is choosing break points: the
path of least cost from the profile's start to its end, found by dynamic programming.

Glossary
--------
BS, NS : bending sector, nondeformable sector
turn : of the profile between two break points, positive where it is convex
vertex : where two lines meet
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from profiletool.joints.paper.pieces import Pieces, Rules, pieces_from
from profiletool.records.frames import cross, direction
from profiletool.records.profile import Profile
from profiletool.records.units import FloatArray, IntArray

_GRID_SHARE = 0.1  # of the tube's radius: break points are tried this far apart
_GRID_TURN_RAD = np.radians(6.0)  # or closer, where the profile turns
_MOST_BREAKS = 260  # the work grows with the cube of their number
_MOST_JOINTS = 24
_WORTH_MM = 0.5
_FAINT = 1e-6  # weight of what lies within the tolerance against what lies beyond


@dataclass(frozen=True)
class BendingSector:
    """A bending sector and the stretch of profile that it stands for.

    Attributes
    ----------
    start, centre, end : float, mm
        Arc lengths on the profile: break point, middle of the bending sector, next break point.
    vertex : (x, y), mm
        Where the two lines meet.
    turn_rad : float
        Positive toward the object.
    openF_mm : float
    deviation_mm : float
        Largest distance of the polygon from the profile.
    inward_mm : float
        Deepest place of the polygon inside the object.
    excess_turn_rad, missing_mm : float
        What is beyond the reach of one joint: turn, and room for its cut. Zero where it fits.
    blocked : bool
        The lines do not meet between their break points: there is nothing to bend.
    """

    start: float
    centre: float
    end: float
    vertex: tuple[float, float]
    turn_rad: float
    openF_mm: float
    deviation_mm: float
    inward_mm: float
    excess_turn_rad: float
    missing_mm: float
    blocked: bool


def discretise(
    profile: Profile, rules: Rules, count: int | None = None
) -> tuple[BendingSector, ...]:
    """Choose the fewest joints whose polygon stays within the tolerance.

    Of equally many the polygon with the least sum of squared deviations is taken. Where no
    number of joints reaches the tolerance, the polygon is taken that is beyond it by the least
    in sum, so that one bad place leaves the others good; its sectors say what is missing.

    Parameters
    ----------
    profile : Profile
    rules : Rules
    count : int, optional
        Number of joints; as few as reach the tolerance by default.

    Returns
    -------
    tuple of BendingSector, in order along the profile; empty where the profile is straight
    """
    grid = _grid(profile, _GRID_SHARE * rules.radius_mm)
    pieces = [pieces_from(profile, grid, i, rules) for i in range(len(grid) - 1)]
    cost = np.full((len(grid), len(grid)), np.inf)
    for i, piece in enumerate(pieces):
        cost[i, i + 1 :] = piece.cost(rules)
    if _straight_deviation(profile) <= rules.tolerance_mm:
        return ()
    path = _best_path(cost, rules.tolerance_mm, count)
    return tuple(_sector(profile, grid, pieces[i], i, j) for i, j in pairwise(path))


def _grid(profile: Profile, spacing: float) -> IntArray:
    """Pick the indices of the points that may be break points, both ends among them."""
    turned = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(profile.heading)))])
    measure = profile.s / spacing + turned / _GRID_TURN_RAD
    count = min(int(np.ceil(measure[-1])), _MOST_BREAKS)
    at = np.searchsorted(measure, np.linspace(0.0, measure[-1], count + 1))
    return np.unique(np.clip(at, 0, len(measure) - 1))


def _straight_deviation(profile: Profile) -> float:
    away = profile.points - profile.points[0]
    return float(np.abs(cross(direction(profile.heading[0]), away)).max())


def _best_path(cost: FloatArray, tolerance: float, count: int | None) -> list[int]:
    """Break points (grid positions, both ends included) of the best polygon.

    For every number of joints: the least sum of what is beyond the tolerance, of equals the least
    sum of squared deviations. The fewest joints with nothing beyond win; where there are none,
    one more joint must take away at least `_WORTH_MM`.
    """
    last = len(cost) - 1
    most = min(count or _MOST_JOINTS, last)
    beyond = np.maximum(cost - tolerance, 0.0)
    step = beyond + _FAINT * np.minimum(cost, tolerance) ** 2 / tolerance**2
    total = np.full(len(cost), np.inf)
    total[0] = 0.0
    origins, sums = [], np.empty(most)
    for n in range(most):
        through = total[:, None] + step
        origins.append(np.argmin(through, axis=0))
        total = np.min(through, axis=0)
        sums[n] = total[last]
    numbers = np.arange(1, most + 1)
    within = np.flatnonzero(sums <= 2.0 * _FAINT * numbers)
    best = within[0] if within.size else np.argmin(sums + _WORTH_MM * numbers)
    joints = min(count or int(best) + 1, most)
    path = [last]
    for origin in reversed(origins[:joints]):
        path.append(int(origin[path[-1]]))
    return path[::-1]


def _sector(profile: Profile, grid: IntArray, piece: Pieces, i: int, j: int) -> BendingSector:
    k = j - i - 1
    return BendingSector(
        start=float(profile.s[grid[i]]),
        centre=float(piece.centre[k]),
        end=float(profile.s[grid[j]]),
        vertex=(float(piece.vertex[k, 0]), float(piece.vertex[k, 1])),
        turn_rad=float(piece.turn[k]),
        openF_mm=float(piece.openF[k]),
        deviation_mm=float(piece.deviation[k]),
        inward_mm=float(piece.inward[k]),
        excess_turn_rad=float(piece.excess_turn[k]),
        missing_mm=float(piece.missing_mm[k]),
        blocked=bool(piece.blocked[k]),
    )
