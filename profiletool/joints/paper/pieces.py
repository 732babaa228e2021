"""Candidate joints of the paper's method: one between every two break points of a profile.

Glossary
--------
turn : of the profile between two break points, positive where it is convex
vertex : where the lines of the discretisation at both break points meet
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from profiletool.bending.kinematics import facing_stretch
from profiletool.records.frames import cross, direction
from profiletool.records.profile import Profile
from profiletool.records.units import BoolArray, FloatArray, IntArray

_STRAIGHT_RAD = np.radians(0.5)  # less turn than this is no joint
_BLOCKED_MM = 1000.0  # cost of a pair of lines that do not meet between their break points
_PER_RAD_MM = 100.0  # cost of turn beyond what a joint reaches
_PER_MM = 10.0  # cost of length that is missing for a cut


@dataclass(frozen=True)
class Rules:
    """Rules that a joint keeps to.

    Attributes
    ----------
    radius_mm : float
        Of the tube.
    openF_mm : (K,) array
        The cuts to choose from, ascending.
    theta_most_rad : (K,) array
        The most that each of them bends at the highest pressure.
    wrap_mm : float
        Least wrapped length between two windows.
    tolerance_mm : float
        How far the polygon may lie off the profile.
    interference_mm : float
        How deep it may run into the object.
    """

    radius_mm: float
    openF_mm: FloatArray
    theta_most_rad: FloatArray
    wrap_mm: float
    tolerance_mm: float
    interference_mm: float


@dataclass(frozen=True)
class Pieces:
    """All candidates from one break point i to the later ones (J of them)."""

    turn: FloatArray
    centre: FloatArray
    openF: FloatArray
    vertex: FloatArray
    deviation: FloatArray
    inward: FloatArray
    excess_turn: FloatArray
    missing_mm: FloatArray
    blocked: BoolArray

    def cost(self, rules: Rules) -> FloatArray:
        """Distance off the profile, and what breaks the rules in equivalents of it, mm."""
        off = np.maximum(self.deviation, self.inward * (rules.tolerance_mm / rules.interference_mm))
        return (
            off
            + _PER_RAD_MM * self.excess_turn
            + _PER_MM * self.missing_mm
            + _BLOCKED_MM * self.blocked
        )


def pieces_from(profile: Profile, grid: IntArray, i: int, rules: Rules) -> Pieces:
    """Judge the joints between break point i and every later one."""
    here, later = grid[i], grid[i + 1 :]
    turn = profile.sign * (profile.heading[later] - profile.heading[here])
    centre, bend = _centred(profile, here, later, turn, 0.4 * rules.radius_mm)
    # As in the paper's own drawing, half of a bend is cut and half stays wrapped.
    openF, excess = _cuts(0.5 * bend, np.abs(turn), rules)
    opened = openF + facing_stretch(turn, rules.radius_mm)
    # Beyond the profile's ends the tube goes on: its root, and its closed end.
    before = centre - profile.s[here] if here > 0 else np.inf
    after = np.where(later < len(profile.s) - 1, profile.s[later] - centre, np.inf)
    missing = np.maximum(0.5 * (opened + rules.wrap_mm) - np.minimum(before, after), 0.0)
    vertex, ahead, behind = _vertices(profile, here, later)
    # Lines that meet behind a break point leave no sector to bend between them.
    blocked = (np.abs(turn) < _STRAIGHT_RAD) | ~(ahead >= 0.0) | ~(behind >= 0.0)
    radius = np.where(turn < 0.0, opened / np.maximum(-turn, _STRAIGHT_RAD), 0.0)
    vertex = np.where(blocked[:, None], profile.points[(here + later) // 2], vertex)
    deviation, inward = _deviation(profile, grid[i:], vertex, radius)
    return Pieces(turn, centre, openF, vertex, deviation, inward, excess, missing, blocked)


def _centred(
    profile: Profile, here: int, later: IntArray, turn: FloatArray, window: float
) -> tuple[FloatArray, FloatArray]:
    """Arc length at which the curvature is centred, and the length that carries the turn.

    The latter is turn² / integral of curvature²: the whole length of an even arc, only the bend's
    where straights adjoin it.
    """
    turns = profile.sign * np.diff(profile.heading)
    middles = 0.5 * (profile.s[1:] + profile.s[:-1])
    # Curvature over a window: squared point by point it would count the noise.
    ends = np.clip(np.add.outer([-0.5, 0.5], middles / window) * window, 0.0, profile.s[-1])
    turned = np.diff(np.interp(ends, profile.s, profile.heading), axis=0)[0]
    square = (turned / (ends[1] - ends[0])) ** 2 * np.diff(profile.s)
    moment, energy = (
        np.concatenate([[0.0], np.cumsum(part)]) for part in (middles * turns, square)
    )
    with np.errstate(divide="ignore", invalid="ignore"):
        centre = (moment[later] - moment[here]) / turn
        bend = turn**2 / (energy[later] - energy[here])
    # Where turns of both signs cancel, the moment says nothing: take the middle.
    inside = (centre > profile.s[here]) & (centre < profile.s[later])
    return np.where(inside, centre, 0.5 * (profile.s[here] + profile.s[later])), np.nan_to_num(bend)


def _cuts(measured: FloatArray, bend: FloatArray, rules: Rules) -> tuple[FloatArray, FloatArray]:
    """Cut for each joint, and the turn that even the longest cut leaves over.

    Rounded up to the next one there is, and no shorter than the turn needs (step 5).
    """
    last = len(rules.openF_mm) - 1
    by_length = np.searchsorted(rules.openF_mm, measured - 1e-9)
    reaching = bend[:, None] <= rules.theta_most_rad + 1e-12
    by_turn = np.where(reaching.any(axis=1), np.argmax(reaching, axis=1), last)
    chosen = np.minimum(np.maximum(by_length, by_turn), last)
    return rules.openF_mm[chosen], np.maximum(bend - rules.theta_most_rad[chosen], 0.0)


def _vertices(
    profile: Profile, here: int, later: IntArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Points where the line at ``here`` meets later ones, (J, 2); distances along both, (J,)."""
    along = direction(profile.heading[here])
    other = direction(profile.heading[later])
    across = profile.points[later] - profile.points[here]
    with np.errstate(divide="ignore", invalid="ignore"):
        ahead = cross(across, other) / cross(along, other)
        behind = cross(across, along) / cross(other, along)
    with np.errstate(invalid="ignore"):
        vertex = profile.points[here] + ahead[:, None] * along
    return vertex, ahead, behind


def _deviation(
    profile: Profile, indices: IntArray, vertex: FloatArray, radius: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Distances of the polygons from indices[0] on off the profile, and inside the object: (J,).

    Toward the object the polygon has a vertex. Away from it the hinge is on the far side and the
    object-facing line runs through the joint as an arc, of the given radius.
    """
    points = profile.points[indices]
    first = direction(profile.heading[indices[0]])
    last = direction(profile.heading[indices[1:]])
    away = points - vertex[:, None, :]
    on_first = away @ first
    on_last = np.einsum("jmc,jc->jm", away, last)
    # Positive where the polygon passes outside the object.
    to_line = profile.sign * np.where(
        on_first + on_last < 0.0, cross(first, away), cross(last[:, None, :], away)
    )
    half = 0.5 * (profile.heading[indices[1:]] - profile.heading[indices[0]])
    tangent = radius * np.abs(np.tan(half))
    bisector = direction(profile.heading[indices[0]] + half + np.pi / 2.0)
    centre = vertex + (np.sign(half) * radius / np.cos(half))[:, None] * bisector
    to_arc = np.hypot(*np.moveaxis(points - centre[:, None, :], -1, 0)) - radius[:, None]
    on_arc = (on_first > -tangent[:, None]) & (on_last < tangent[:, None])
    outside = np.where(on_arc, to_arc, to_line)
    within = np.tri(len(last), len(points), 1, dtype=bool)
    outward, inward = (
        np.max(off, axis=1, where=within, initial=0.0) for off in (outside, -outside)
    )
    distance = np.min(np.hypot(away[..., 0], away[..., 1]), axis=1, where=within, initial=np.inf)
    outward = np.maximum(outward, np.where(radius > 0.0, 0.0, distance))
    return np.maximum(outward, inward), inward
