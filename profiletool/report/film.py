"""The tube at rising pressures, thinned to what a page needs to move it.

Lengths are whole hundredths of a millimetre here, x to the right and y *down*, as SVG has it, so
that the page's script and this module write the same path for the same state.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from profiletool.records.design import Design
from profiletool.records.fe import FeState, Verification
from profiletool.records.frames import Shape
from profiletool.records.grip import Grip, GripState
from profiletool.records.units import FloatArray, IntArray

_POINTS = 84  # of a line, at most some more
_PER_MM = 100
_ABOVE = 0.01  # of the last free pressure: from there on states against the object follow


@dataclass(frozen=True)
class Film:
    """States of a tube, from rest on: free up to ``shown``, beyond it against its object.

    Attributes
    ----------
    shown : int
        The state that is drawn where nothing moves: the last free one.
    pressure_bar : (S,)
    theta_deg : (S, n)
        Positive toward the object.
    air_ml : (S,)
    lines : (S, 2, N, 2)
        The object-facing surface line, then the far one; hundredths of a mm, y down.
    windows : (n, 3)
        Where on the lines each joint's cut starts, has its centre, and ends.
    """

    shown: int
    pressure_bar: FloatArray
    theta_deg: FloatArray
    air_ml: FloatArray
    lines: IntArray
    windows: IntArray

    @property
    def moves(self) -> bool:
        """Whether there is more than one state."""
        return len(self.lines) > 1

    def outline(self) -> str:
        """Path of the whole tube as it is shown."""
        facing, far = self.lines[self.shown]
        return ring_path(facing, far)

    def window(self, joint: int) -> str:
        """Path of a joint's cut as it is shown; joints count from 0 here."""
        start, _, end = self.windows[joint].tolist()
        facing, far = self.lines[self.shown]
        return ring_path(facing[start : end + 1], far[start : end + 1])

    def centre(self, joint: int) -> tuple[str, str]:
        """Place of a joint's middle as it is shown, mm, y down as in SVG."""
        x, y = self.lines[self.shown, :, self.windows[joint, 1]].sum(axis=0) // 2
        return _mm(int(x)), _mm(int(y))

    def as_json(self) -> str:
        """Write all states for the page's script."""
        tree = {
            "shown": self.shown,
            "bar": np.round(self.pressure_bar, 4).tolist(),
            "theta": np.round(self.theta_deg, 4).tolist(),
            "air": np.round(self.air_ml, 3).tolist(),
            "lines": self.lines.reshape(len(self.lines), -1).tolist(),
            "windows": self.windows.tolist(),
        }
        return json.dumps(tree, separators=(",", ":"), allow_nan=False)


def film_of(found: Verification, design: Design, grip: Grip | None = None) -> Film:
    """Take the states of a finite-element run, rest among them, and harder ones on the object.

    Those are left out of an infeasible design, which would jump where the object comes.
    """
    free = (found.rest, *found.states)
    most = found.last.pressure_bar * (1.0 + _ABOVE)
    held: tuple[GripState, ...] = ()
    if grip is not None and design.feasible:
        held = tuple(s for s in grip.states if s.pressure_bar > most)
    states: tuple[FeState | GripState, ...] = (*free, *held)
    return _film(
        [state.shape for state in states],
        design,
        len(free) - 1,
        np.array([state.pressure_bar for state in states]),
        np.array([state.theta_deg for state in states]),
        np.array([state.air_ml for state in states]),
    )


def still_of(shape: Shape, design: Design) -> Film:
    """Make a film of a single shape, without angles and air."""
    n = len(design.joints)
    return _film([shape], design, 0, np.zeros(1), np.zeros((1, n)), np.zeros(1))


def ring_path(facing: IntArray, far: IntArray) -> str:
    """Path around what lies between two lines (N, 2)."""
    return path(np.concatenate([facing, far[::-1]])) + "Z"


def path(points: IntArray) -> str:
    """Path through points (N, 2)."""
    return "M" + " ".join(f"{_mm(x)},{_mm(y)}" for x, y in points.tolist())


def drawn(points: FloatArray) -> IntArray:
    """Take points (..., 2) in mm, object frame, to hundredths of a mm, y down."""
    return np.asarray(np.rint(_PER_MM * points * [1.0, -1.0]), dtype=np.int64)


def _film(
    shapes: Sequence[Shape],
    design: Design,
    shown: int,
    bar: FloatArray,
    theta: FloatArray,
    air: FloatArray,
) -> Film:
    along = shapes[0].along
    kept, windows = _thinned(along, design)
    lines = np.array([[shape.facing[kept], shape.far[kept]] for shape in shapes])
    return Film(shown, bar, theta, air, drawn(lines), windows)


def _thinned(along: FloatArray, design: Design) -> tuple[IntArray, IntArray]:
    """Choose points along the tube, evenly, and the joints' edges and centres; and where these are.

    Returns
    -------
    kept : (N,)
        Ascending indices into ``along``.
    windows : (n, 3)
        Indices into ``kept``.
    """
    centre = np.array([joint.centre_mm for joint in design.joints])
    half = 0.5 * np.array([joint.openF_mm for joint in design.joints])
    marks = np.abs(along - np.stack([centre - half, centre, centre + half], 1)[..., None])
    fixed = np.argmin(marks, axis=-1)
    count = max(_POINTS - fixed.size, 2)  # an attempt that is no design may have many joints
    even = np.rint(np.linspace(0, len(along) - 1, count))
    kept = np.unique(np.concatenate([even.astype(np.int64), fixed.ravel()]))
    return kept, np.searchsorted(kept, fixed)


def _mm(hundredths: int) -> str:
    """Write hundredths of a mm in mm, as JavaScript writes the same number."""
    written = f"{hundredths / _PER_MM:.2f}"
    return written.rstrip("0").rstrip(".")
