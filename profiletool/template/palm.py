"""The palm that the clamped tubes are screwed to: how many, where, and what is drilled.

A palm lies on the far side of the clamped tubes. That of one finger lies along its tube; fingers
around the axis of a body of revolution share a level one, whatever the slope of their clamps.

Glossary
--------
plan : seen along the palm's normal, from the side away from the tubes; x to the right as in the
    side view, y away from who looks at it; origin the object's axis, or the tube's open end
    where the object has none; mm
r : distance from the plan's origin along a finger, outward, mm
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from profiletool.records.units import FloatArray

HOLE_MM = 3.2  # M3, clearance
ASIDE_MM = 6.0  # from a tube's side to the middle of its screws
EDGE_MM = 6.0  # from clamps and holes to the palm's edge


@dataclass(frozen=True)
class ClampedTube:
    """The straight piece of tube in its clamp, in the object frame.

    Attributes
    ----------
    start : (2,) mm
        Where its object-facing line begins, at the open end.
    along, outward : (2,)
        Unit vectors along the tube, and from its object-facing to its far line.
    length_mm, diameter_mm : float
        From the open end to the clamp's edge; of the tube.
    side : float
        +1 where the finger reaches to the right, else -1.
    """

    start: FloatArray
    along: FloatArray
    outward: FloatArray
    length_mm: float
    diameter_mm: float
    side: float

    @property
    def edge(self) -> FloatArray:
        """Base point of the design, (2,) mm: the object-facing line at the clamp's edge."""
        return self.at(self.length_mm, 0.0)

    @property
    def slope_deg(self) -> float:
        """How far the tube points below the horizontal; negative above it."""
        return float(np.degrees(np.arctan2(-self.along[1], self.side * self.along[0])))

    def at(self, along: float, across: float) -> FloatArray:
        """Return the point (2,) ``along`` the tube and ``across`` from its facing line, mm."""
        return np.asarray(self.start + along * self.along + across * self.outward)

    @property
    def ring(self) -> FloatArray:
        """Its outline in the side view, (4, 2) mm."""
        length, across = self.length_mm, self.diameter_mm
        corners = ((0.0, 0.0), (length, 0.0), (length, across), (0.0, across))
        return np.array([self.at(*corner) for corner in corners])


@dataclass(frozen=True)
class Palm:
    """The palm and the fingers on it.

    Attributes
    ----------
    origin : (2,) mm
        The plan's origin on the palm's near face, object frame.
    along, normal : (2,)
        Unit vectors in the side view: where finger 1 points on the palm, and away from the tubes.
    on_axis : bool
        Whether the origin is the object's axis.
    turns_deg : tuple of float
        Direction of every finger in the plan, counter-clockwise from x; the side view's first.
    span_mm : (float, float)
        r of the clamps as seen in the plan, from and to.
    diameter_mm : float
        Of a tube.
    saddle_mm : float
        r of the screws.
    base_mm : float
        r of the base point, at the clamp's edge.
    fitting_mm : float or None
        r at which the air fittings run into the palm; None where they do not.
    fittings_meet : bool
        Whether they run into each other before that.
    opening_mm : float
        Radius of the opening that the object reaches through; 0 where it does not.
    """

    origin: FloatArray
    along: FloatArray
    normal: FloatArray
    on_axis: bool
    turns_deg: tuple[float, ...]
    span_mm: tuple[float, float]
    diameter_mm: float
    saddle_mm: float
    base_mm: float
    fitting_mm: float | None = None
    fittings_meet: bool = False
    opening_mm: float = 0.0

    @property
    def fingers(self) -> int:
        """How many there are."""
        return len(self.turns_deg)

    @property
    def aside_mm(self) -> float:
        """From a tube's middle to the middle of its screws."""
        return self.diameter_mm / 2 + ASIDE_MM

    @property
    def radius_mm(self) -> float:
        """Of the round palm that fingers around an axis share, in whole mm."""
        half = self.diameter_mm / 2
        corners = np.hypot(np.abs(self.span_mm).max(), half)
        holes = np.hypot(self.saddle_mm, self.aside_mm) + HOLE_MM / 2
        return float(np.ceil(max(corners, holes) + EDGE_MM))

    @property
    def reach_mm(self) -> tuple[float, float]:
        """Where its edges lie along finger 1: r from and to."""
        if self.fingers > 1:
            return -self.radius_mm, self.radius_mm
        low = min(self.span_mm[0], self.saddle_mm - HOLE_MM / 2)
        high = max(self.span_mm[1], self.saddle_mm + HOLE_MM / 2)
        return low - EDGE_MM, high + EDGE_MM

    @property
    def half_width_mm(self) -> float:
        """From finger 1's middle to the palm's edge."""
        if self.fingers > 1:
            return self.radius_mm
        return float(np.ceil(self.aside_mm + HOLE_MM / 2 + EDGE_MM))

    def at(self, r: float, off: float) -> FloatArray:
        """Return the point (2,) in the side view at ``r`` and ``off`` the near face, mm."""
        return np.asarray(self.origin + r * self.along + off * self.normal)

    def in_plan(self, finger: int, *places: tuple[float, float]) -> FloatArray:
        """Return ``places``, (r, aside) mm each at a finger counted from 0, in the plan (N, 2)."""
        turn = np.radians(self.turns_deg[finger])
        out = np.array([np.cos(turn), np.sin(turn)])
        return np.array([r * out + t * np.array([-out[1], out[0]]) for r, t in places])

    @property
    def holes(self) -> FloatArray:
        """Middles of the screw holes in the plan, (2 x fingers, 2) mm."""
        pair = (self.saddle_mm, self.aside_mm), (self.saddle_mm, -self.aside_mm)
        return np.concatenate([self.in_plan(k, *pair) for k in range(self.fingers)])

    @property
    def clamps(self) -> tuple[FloatArray, ...]:
        """Outlines of the clamped tubes in the plan, (4, 2) mm each."""
        (low, high), half = self.span_mm, self.diameter_mm / 2
        ring = ((low, -half), (high, -half), (high, half), (low, half))
        return tuple(self.in_plan(k, *ring) for k in range(self.fingers))
