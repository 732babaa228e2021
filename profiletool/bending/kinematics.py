"""Shape of an actuator whose joints bend by given angles.

A joint is an arc of constant curvature. Lengths are kept on the line through the axis of
rotation, which lies between the axis of the tube and its uncut surface: the paper takes the
surface itself (1.0 R); finite elements of the whole bulb actuator at 1.90 bar give 0.79 R, since
the threads in the middle of the uncut sector go slack.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import ArrayLike

from profiletool.records.frames import Pose, Shape, direction, outward
from profiletool.records.units import FloatArray

PIVOT_SHARE = 0.79  # of the tube's radius, from its axis toward the uncut sector
STEP_MM = 0.25  # spacing of a shape's points on the straight tube


@dataclass(frozen=True)
class Bend:
    """One joint as the kinematics sees it.

    ``centre_mm`` and ``openF_mm`` along the straight tube; ``turn_rad`` positive toward the
    object, negative away from it.
    """

    centre_mm: float
    openF_mm: float
    turn_rad: float


def facing_stretch(turn_rad: ArrayLike, radius_mm: float) -> FloatArray:
    """Lengthening of the object-facing line in a joint, mm; it shortens where negative.

    Lengths are kept on the axis of rotation, at `PIVOT_SHARE` of the radius.

    Parameters
    ----------
    turn_rad : (...)
        Positive toward the object.
    radius_mm : float
        Of the tube.
    """
    turn = np.asarray(turn_rad, dtype=float)
    stretch: FloatArray = PIVOT_SHARE * radius_mm * np.abs(turn) - radius_mm * turn
    return stretch


def deform(
    bends: Sequence[Bend], length_mm: float, radius_mm: float, pose: Pose, sign: float
) -> Shape:
    """Shape of the tube for given joint angles.

    Parameters
    ----------
    bends : sequence of Bend, in order along the tube
    length_mm, radius_mm : float
    pose : Pose
        Of the object-facing line at the clamped end.
    sign : float
        +1 where a turn toward the object is counter-clockwise (see `Profile.sign`).
    """
    edges = [0.0]
    rates = []  # (turn, stretch of the facing line) per mm of straight tube
    for bend in bends:
        edges += [bend.centre_mm - bend.openF_mm / 2.0, bend.centre_mm + bend.openF_mm / 2.0]
        stretch = float(facing_stretch(bend.turn_rad, radius_mm))
        rates += [(0.0, 1.0), (bend.turn_rad / bend.openF_mm, 1.0 + stretch / bend.openF_mm)]
    edges.append(length_mm)
    rates.append((0.0, 1.0))
    along, turn, speed = _sample(np.array(edges), np.array(rates))
    heading = np.radians(pose.heading_deg) + sign * turn
    # Exact for constant curvature: every step runs along its chord.
    step = np.diff(turn)
    chord = np.diff(along) * speed * np.sinc(step / (2.0 * np.pi))
    middle = 0.5 * (heading[1:] + heading[:-1])
    steps = chord[:, None] * direction(middle)
    start = np.array([[pose.x_mm, pose.y_mm]])
    facing = np.concatenate([start, start + np.cumsum(steps, axis=0)])
    across = outward(heading, sign)
    return Shape(along, facing, facing + radius_mm * across, facing + 2.0 * radius_mm * across)


def _sample(edges: FloatArray, rates: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Sample (along, turn) at steps that end on the edges, and the stretch within each step."""
    counts = np.maximum(np.ceil(np.diff(edges) / STEP_MM).astype(int), 1)
    along = np.concatenate(
        [[edges[0]]]
        + [np.linspace(a, b, n + 1)[1:] for a, b, n in zip(edges, edges[1:], counts, strict=False)]
    )
    turning, speed = np.repeat(rates, counts, axis=0).T
    turn = np.concatenate([[0.0], np.cumsum(turning * np.diff(along))])
    return along, turn, speed


def meets_itself(shape: Shape) -> bool:
    """Whether the bent tube runs into itself."""
    return not shapely.LinearRing(np.concatenate([shape.facing, shape.far[::-1]])).is_simple
