"""The shapes that a tube may have: a model's states at all pressures, and joints off by a little.

Frame: mm, x along the clamped tube, y toward the object, the origin on its axis at the clamp.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline

from profiletool.records.bench import Predicted
from profiletool.records.frames import Shape, direction, outward
from profiletool.records.units import BoolArray, FloatArray, IntArray

_TURNS = np.radians(5.0)  # of a joint, before its own course of turning is taken
_BEYOND = 1.05  # of the last pressure, as far as states go on


@dataclass(frozen=True)
class Outline:
    """A tube's lines; S places along it.

    Attributes
    ----------
    axis : (S, 2) mm
    out : (S, 2)
        Unit vectors across it, away from the object.
    half : (S,) mm
        Half of its width.
    """

    axis: FloatArray
    out: FloatArray
    half: FloatArray


@dataclass(frozen=True)
class Family:
    """Outlines over the pressure, the joints' own turns, lengthenings and shifts; J joints.

    Attributes
    ----------
    along : (S,) mm
        On the straight tube.
    fields : CubicSpline
        Over bar: (4, S) turn, half width, and the steps along and across.
    theta : CubicSpline
        Over bar: (J,) deg.
    top : float, bar
    turning : (J, S)
        Share of a joint's turn that is made before each place: 0 to 1.
    lengthening : (J, S)
        Share of its lengthening, and of its shift.
    sector : (S,) int
        Wrapped sector of every place, from 0; -1 in a cut.
    middles : (J + 1,) int
        Places of the sectors' middles.
    sign, error_share : float
        As in `Predicted`.
    """

    along: FloatArray
    fields: CubicSpline
    theta: CubicSpline
    top: float
    turning: FloatArray
    lengthening: FloatArray
    sector: IntArray
    middles: IntArray
    sign: float
    error_share: float

    @property
    def joints(self) -> int:
        """How many."""
        return len(self.turning)

    @property
    def radius(self) -> float:
        """Half of the width at rest, mm."""
        return float(np.median(self.fields(0.0)[1]))

    def outline(
        self, bar: float, turn: FloatArray, grow: FloatArray, shift: FloatArray | None = None
    ) -> Outline:
        """Bend the tube: as the model does at a pressure, each joint then by its own (J,) more.

        Parameters
        ----------
        bar : float
        turn : (J,) rad
            Toward the object.
        grow, shift : (J,) mm
            Along the tube, and across it, away from the object.
        """
        heading, half, ahead, aside = self.fields(np.clip(bar, 0.0, _BEYOND * self.top)).copy()
        heading += turn @ self.turning
        inside = np.diff(self.lengthening, axis=1)
        ahead[1:] += grow @ inside
        if shift is not None:
            aside[1:] += shift @ inside
        out = outward(heading, 1.0)
        middle = np.concatenate([heading[:1], 0.5 * (heading[1:] + heading[:-1])])
        steps = ahead[:, None] * direction(middle) + aside[:, None] * outward(middle, 1.0)
        return Outline(np.cumsum(steps, axis=0), out, half)

    def theta_deg(self, bar: float, turn: FloatArray) -> FloatArray:
        """Angles of such a tube's joints, (J,) deg."""
        return np.asarray(self.theta(np.clip(bar, 0.0, _BEYOND * self.top)) + np.degrees(turn))

    def wrapped(self, margin: float) -> BoolArray:
        """Places (S,) of wrapped sectors, ``margin`` mm clear of cuts and clamp."""
        inside = self.sector >= 0
        steps = round(margin / float(self.along[1] - self.along[0]))
        kept = inside.copy()
        for k in range(1, steps + 1):
            kept[k:] &= inside[:-k]
            kept[:-k] &= inside[k:]
        kept[: 2 * steps] = False
        return kept


def family_of(predicted: Predicted) -> Family:
    """Make the family of a model's states."""
    along = predicted.shapes[0].along
    base = np.radians(predicted.heading_deg)
    rows = np.array([_fields(shape, predicted.sign, base) for shape in [*predicted.shapes]])
    starts, ends = predicted.windows_mm.T
    bounds = np.concatenate([[along[0]], np.ravel(predicted.windows_mm), [along[-1]]])
    middles = np.searchsorted(along, 0.5 * (bounds[::2] + bounds[1::2])).astype(np.int64)
    last = rows[-1, 0]
    turning = [
        _share(along, last, (middles[k], middles[k + 1]), (starts[k], ends[k]))
        for k in range(len(starts))
    ]
    lengthening = [_ramp(along, start, end) for start, end in predicted.windows_mm]
    sector = np.searchsorted(np.ravel(predicted.windows_mm), along)
    bars = predicted.pressure_bar
    return Family(
        along,
        CubicSpline(bars, rows),
        CubicSpline(bars, predicted.theta_deg),
        float(bars[-1]),
        np.array(turning),
        np.array(lengthening),
        np.where(sector % 2 == 0, sector // 2, -1),
        middles,
        predicted.sign,
        predicted.error_share,
    )


def _fields(shape: Shape, sign: float, base: float) -> FloatArray:
    """Turn, half width and steps of a shape, in the family's frame: (4, S)."""
    facing, far = shape.facing, shape.far
    across = 0.5 * (far - facing)
    half = np.linalg.norm(across, axis=1)
    heading = np.unwrap(np.arctan2(sign * across[:, 0], -sign * across[:, 1]))
    heading += 2.0 * np.pi * np.round((base - heading[0]) / (2.0 * np.pi))
    steps = np.diff(0.5 * (facing + far), axis=0)
    middle = 0.5 * (heading[1:] + heading[:-1])
    ahead = np.concatenate([[0.0], (steps * direction(middle)).sum(axis=1)])
    aside = np.concatenate([[0.0], (steps * outward(middle, sign)).sum(axis=1)])
    return np.stack([sign * (heading - base), half, ahead, aside])


def _ramp(along: FloatArray, start: float, end: float) -> FloatArray:
    return np.asarray(np.clip((along - start) / (end - start), 0.0, 1.0))


def _share(
    along: FloatArray, turn: FloatArray, middles: tuple[int, int], window: tuple[float, float]
) -> FloatArray:
    """Share of a joint's turn made before each place: the model's own, else even in the cut."""
    a, b = middles
    whole = turn[b] - turn[a]
    if abs(whole) < _TURNS:
        return _ramp(along, *window)
    share = (turn - turn[a]) / whole
    share[:a], share[b:] = 0.0, 1.0
    return np.asarray(np.clip(share, 0.0, 1.0))
