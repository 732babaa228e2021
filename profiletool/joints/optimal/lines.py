"""The lines that wrapped sectors may lie on: the nodes of the choice of joints.

Every place on the profile has a few lines through it or near it, at a few headings about the
profile's own. The first joint starts on a base line; behind the profile's end the places go on
along its last tangent, where no distance counts, so that the last joint may end there.

Glossary
--------
N, M : number of lines, of points
place : index of the point at which a line stands for the profile
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from profiletool.joints.bounds import Limits
from profiletool.profile.curve import points_at
from profiletool.records.frames import base_axes, direction, outward
from profiletool.records.profile import Profile
from profiletool.records.units import FloatArray, IntArray

_BEYOND_MM = 20.0
_CORNER_RAD = 0.2  # turn from place to place that makes a corner
_FAN_RAD = 0.1
_CORNER_OFFSETS_MM = (1.2, 2.5, 4.5)
_FREE_HEADINGS, _FREE_OFFSETS = 7, 5  # base lines where the base is free


@dataclass(frozen=True)
class Discretisation:
    """Spacings of the grid that joints are chosen on.

    Attributes
    ----------
    step_mm : float
        Spacing of the places, and of the points whose distance counts.
    turns_rad : tuple of float
        Headings of lines, about the profile's.
    offsets_mm : tuple of float
        Of lines from the profile, away from the object.
    pressure_step : float, MPa
    least_pressure : float, MPa
    """

    step_mm: float = 1.75
    turns_rad: tuple[float, ...] = (-0.05, 0.0, 0.05)
    offsets_mm: tuple[float, ...] = (-0.3, 0.3)
    pressure_step: float = 0.02
    least_pressure: float = 0.08


FINE = Discretisation()
# Where no line on the profile will do: bridges over corners and hollows.
WIDE = Discretisation(
    step_mm=2.5,
    turns_rad=(-0.2, -0.1, 0.0, 0.1, 0.2),
    offsets_mm=(-0.3, 0.7, 2.0, 4.5),
    least_pressure=0.16,
)
FAR = Discretisation(
    step_mm=4.0,
    turns_rad=(-0.3, -0.15, 0.0, 0.15, 0.3),
    offsets_mm=(-4.0, -1.0, 2.0, 5.0, 9.0),
    least_pressure=0.16,
)


@dataclass(frozen=True)
class CandidateLines:
    """All lines, and the profile's points as each of them sees them.

    Attributes
    ----------
    place : (N,)
        Index of a point; -1 for base lines.
    turn : (N,) rad
        Heading, counted from the base's, toward the object positive.
    point : (N, 2) mm
        A point of the line at its place.
    along, out : (N, M) mm
        The points in the line's frame: along it from ``point``, and off it away from the object.
    weight : (M,) mm
        Length of profile that each point stands for; 0 behind the profile's end.
    lever2 : (M,) mm³ per rad²
        Integral, over the profile behind a point, of the square of the normal motion there by an
        angle at the point.
    swing2 : float, mm³
        Integral of the square of the normal motion where all angles grow by their own size.
    base : int
        The first so many lines are base lines.
    """

    place: IntArray
    turn: FloatArray
    point: FloatArray
    along: FloatArray
    out: FloatArray
    weight: FloatArray
    lever2: FloatArray
    swing2: float
    base: int


def lines_of(profile: Profile, limits: Limits, grid: Discretisation) -> CandidateLines:
    """Lay the lines of a discretisation on a profile.

    Parameters
    ----------
    profile : Profile
    limits : Limits
        They say whether, and how far, the base may leave the profile's start tangent.
    grid : Discretisation
    """
    count = max(round(profile.length_mm / grid.step_mm), 2)
    step = profile.length_mm / count
    s = step * np.arange(count + 1 + int(_BEYOND_MM / step), dtype=float)
    points, turn = _extended(profile, s)
    away = outward(float(profile.heading[0]) + profile.sign * turn, profile.sign)
    weight = np.where(np.arange(len(s)) <= count, step, 0.0)
    weight[[0, count]] *= 0.5

    turns, offsets = _base_lines(limits)
    _, base_away = base_axes(float(profile.heading[0]), profile.sign)
    base_points = profile.points[0] + offsets[:, None] * base_away
    at, heading_turn, off = _fan(profile, s, turn, grid)
    place = np.concatenate([np.full(len(turns), -1), at])
    line_turn = np.concatenate([turns, heading_turn])
    point = np.concatenate([base_points, points[at] + off[:, None] * away[at]])
    heading = float(profile.heading[0]) + profile.sign * line_turn
    cos, sin = np.cos(heading)[:, None], np.sin(heading)[:, None]
    x, y = (points[None, :, k] - point[:, k, None] for k in (0, 1))
    along, out = cos * x + sin * y, profile.sign * (sin * x - cos * y)
    lever = _levers(points, float(profile.heading[0]) + profile.sign * turn)
    swing = np.diff(turn, prepend=0.0) @ lever
    return CandidateLines(
        place,
        line_turn,
        point,
        along,
        out,
        weight,
        np.asarray(lever**2 @ weight),
        float(swing**2 @ weight),
        len(turns),
    )


def _levers(points: FloatArray, heading: FloatArray) -> FloatArray:
    """Give the normal motion of points by an angle at another one before them: (M by, M of)."""
    arm = points[None] - points[:, None]
    return np.triu(np.einsum("mk,vmk->vm", direction(heading), arm), 1)


def _fan(
    profile: Profile, s: FloatArray, turn: FloatArray, grid: Discretisation
) -> tuple[IntArray, FloatArray, FloatArray]:
    """Places (indices), turns and offsets of all lines but the base ones, flat.

    At a corner the lines fan out over all headings that the profile takes there.
    """
    half = 0.5 * (s[1] - s[0])
    fine = profile.sign * (profile.heading - profile.heading[0])
    at, turns, offsets = [], [], []
    for place in range(1, len(s)):
        first, last = np.searchsorted(profile.s, [s[place] - half, s[place] + half])
        here = fine[first : last + 1] if first < len(fine) else turn[place : place + 1]
        low, high = float(here.min()), float(here.max())
        tilts = turn[place] + np.array(grid.turns_rad)
        off = np.array(grid.offsets_mm)
        if high - low > _CORNER_RAD:
            count = int(np.ceil((high - low) / _FAN_RAD)) + 1
            tilts = np.linspace(low, high, count)
            off = np.append(off, _CORNER_OFFSETS_MM)
        pairs = np.meshgrid(tilts, off, indexing="ij")
        turns.append(pairs[0].ravel())
        offsets.append(pairs[1].ravel())
        at.append(np.full(tilts.size * off.size, place))
    return np.concatenate(at), np.concatenate(turns), np.concatenate(offsets)


def _extended(profile: Profile, s: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Points (M, 2) and turns (M,) of a profile that goes straight on behind its end."""
    turn = profile.sign * (np.interp(s, profile.s, profile.heading) - profile.heading[0])
    past = np.maximum(s - profile.length_mm, 0.0)[:, None]
    points = points_at(s, profile.s, profile.points)
    return points + past * direction(profile.heading[-1]), turn


def _base_lines(limits: Limits) -> tuple[FloatArray, FloatArray]:
    """Give turns and offsets of the base lines, flat."""
    if not limits.base_free:
        return np.zeros(1), np.zeros(1)
    turns = np.linspace(-limits.base_turn_rad, limits.base_turn_rad, _FREE_HEADINGS)
    offsets = np.linspace(-limits.base_offset_mm, limits.base_offset_mm, _FREE_OFFSETS)
    grid = np.meshgrid(turns, offsets, indexing="ij")
    return grid[0].ravel(), grid[1].ravel()
