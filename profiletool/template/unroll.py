"""The gauze on the flat: where a point of the wrapped tube lies on the sheet.

Conventions
-----------
Angles on the tube count counter-clockwise as seen from the closed end, looking to the clamped
end; 270 deg faces the object. The sheet lies face up, x along the tube from the clamped end, y
up from the start edge, which lies on the seam.

A sheet of gauze is rolled: the tube is laid *on* the face with its seam line on the start edge
and rolled toward +y, so the face ends up inside, against the tube, and angles grow with y:
angle = seam + phi. phi 0 .. 360 is the inner turn, 360 .. 720 the second. A sleeve's pattern and
a marking strip go once around what is on the tube already, face outside: angle = seam - phi.

Glossary
--------
phi : roll angle from the start edge, deg; it keeps counting over all turns
r : radius of the sheet's middle surface, mm; gauze: D/2 + t/2 + t phi / (2 pi)
t : thickness of one layer of gauze, the thread's, mm
y : arc length along the roll, the integral of r dphi, mm
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from profiletool.records import TOWARD_DEG, FloatArray, Gauze, Joint, Tube

Variant = Literal["gauze", "sleeve", "strip"]

FULL_CIRCLE = 360.0
PAPER_MM = 0.1  # thickness of a marking strip
# Angles closer than this are the same edge; slivers between them are no place for a seam.
SAME_DEG = 1e-6
SAME_MM = 1e-6


@dataclass(frozen=True)
class Roll:
    """How a sheet lies around the tube.

    Attributes
    ----------
    start_mm : float
        Radius of its middle surface at the start edge.
    rise_mm : float
        By how much that grows with each turn: one layer where it is rolled up, 0 where it closes.
    turns : int
        How many times it goes around.
    outside : bool
        Whether its face lies outside, so that angles fall with y.
    """

    start_mm: float
    rise_mm: float
    turns: int
    outside: bool = False

    @property
    def length_mm(self) -> float:
        """Length of the sheet along the roll, mm."""
        return float(self.y_mm(FULL_CIRCLE * self.turns))

    def y_mm(self, phi_deg: float | FloatArray) -> FloatArray:
        """Arc length along the roll (mm) at the roll angle ``phi_deg``, of the same shape."""
        phi = np.radians(phi_deg)
        return np.asarray(phi * (self.start_mm + self.rise_mm * phi / (4 * np.pi)))

    def phi_deg(self, y_mm: float | FloatArray) -> FloatArray:
        """Roll angle (deg) at the arc length ``y_mm``, of the same shape: the inverse of y."""
        r = np.sqrt(self.start_mm**2 + self.rise_mm * np.asarray(y_mm) / np.pi)
        # The quadratic's root in the form that also holds where the radius does not grow.
        return np.asarray(np.degrees(2 * np.asarray(y_mm) / (self.start_mm + r)))


@dataclass(frozen=True)
class SeamChoice:
    """Where the glue and weld line runs, and what it costs.

    Attributes
    ----------
    seam_deg : float
        Its angle on the tube, 0 <= seam < 360.
    crossed : tuple of int
        Numbers of the joints whose cut sector it runs through.
    margin_deg : float
        Distance to the nearest edge of any joint's sector.
    """

    seam_deg: float
    crossed: tuple[int, ...]
    margin_deg: float


@dataclass(frozen=True)
class Slit:
    """One slit along the hoop threads: from (x, y_start) to (x, y_end), mm."""

    joint: int
    x_mm: float
    y_start_mm: float
    y_end_mm: float


def roll_of(tube: Tube, gauze: Gauze, variant: Variant = "gauze") -> Roll:
    """Return how a sheet lies around ``tube``.

    "gauze" is rolled up around it, "sleeve" closes on it as a single layer, "strip" is paper
    around all turns of the gauze.
    """
    radius, thread = tube.outer_diameter_mm / 2, gauze.thread_mm
    if variant == "strip":
        return Roll(radius + gauze.turns * thread + PAPER_MM / 2, 0.0, 1, outside=True)
    if variant == "sleeve":
        return Roll(radius + thread / 2, 0.0, 1, outside=True)
    return Roll(radius + thread / 2, thread, gauze.turns)


def sheet_size(tube: Tube, gauze: Gauze, variant: Variant = "gauze") -> tuple[float, float]:
    """Return the sheet's size (along the tube, along the roll) in mm."""
    return tube.length_mm, roll_of(tube, gauze, variant).length_mm


def cut_sector(joint: Joint) -> tuple[float, float]:
    """Return the cut sector of a joint as (start angle in 0..360, extent), deg.

    Raises
    ------
    ValueError
        ``alpha_closed_deg`` is not within 0..360.
    """
    if not 0 <= joint.alpha_closed_deg <= FULL_CIRCLE:
        raise ValueError(f"joint {joint.number}: alpha_closed_deg must lie within 0..360")
    start = (joint.alpha_center_deg + joint.alpha_closed_deg / 2) % FULL_CIRCLE
    return start, FULL_CIRCLE - joint.alpha_closed_deg


def window_intervals(joint: Joint, seam_deg: float, roll: Roll) -> FloatArray:
    """Return the cut sector of a joint as intervals of the roll angle.

    A cut that runs through the seam is one interval from one turn into the next; its first
    piece starts at the start edge and its last one stops at the end edge.

    Returns
    -------
    (N, 2) float
        phi from and to, deg, ascending; empty where nothing is cut.
    """
    start, extent = cut_sector(joint)
    end = FULL_CIRCLE * roll.turns
    if extent >= FULL_CIRCLE:
        return np.array([[0.0, end]])
    ahead = seam_deg - (start + extent) if roll.outside else start - seam_deg
    begins = ahead % FULL_CIRCLE + FULL_CIRCLE * np.arange(-1, roll.turns)
    pieces = np.stack([begins, begins + extent], axis=1).clip(0.0, end)
    return np.asarray(pieces[pieces[:, 1] - pieces[:, 0] > SAME_DEG])


def slit_rows(joint: Joint, pitch_mm: float) -> FloatArray:
    """Return the places along the tube of a joint's slits, (N,) mm: one per cell of the mesh.

    Raises
    ------
    ValueError
        The mesh pitch is not positive.
    """
    if pitch_mm <= 0:
        raise ValueError("the mesh pitch must be positive")
    n = max(1, round(joint.openF_mm / pitch_mm))
    return np.asarray(joint.centre_mm + (np.arange(n) - (n - 1) / 2) * pitch_mm)


def slits(
    joints: Sequence[Joint], tube: Tube, gauze: Gauze, variant: Variant = "gauze"
) -> tuple[Slit, ...]:
    """Return all slits of a sheet, joint by joint, row by row, along the roll.

    Rows beyond the tube's ends are left out. Slits of different joints that lie on one row and
    touch or overlap become one, which counts to the joint that comes first.
    """
    roll = roll_of(tube, gauze, variant)
    rows: dict[float, list[tuple[float, float, int]]] = {}
    for order, joint in enumerate(joints):
        windows = window_intervals(joint, gauze.seam_deg, roll).tolist()
        for x in slit_rows(joint, gauze.pitch_mm).tolist():
            if SAME_MM < x < tube.length_mm - SAME_MM:
                rows.setdefault(round(x, 6), []).extend((a, b, order) for a, b in windows)
    cuts = sorted((order, x, a, b) for x, row in rows.items() for a, b, order in _merged(row))
    return tuple(
        Slit(joints[order].number, x, float(roll.y_mm(a)), float(roll.y_mm(b)))
        for order, x, a, b in cuts
    )


def _merged(row: list[tuple[float, float, int]]) -> list[tuple[float, float, int]]:
    """Unite the intervals (from, to, order) that touch or overlap; the lowest order stays."""
    united: list[tuple[float, float, int]] = []
    for a, b, order in sorted(row):
        if united and a <= united[-1][1] + SAME_DEG:
            a0, b0, order0 = united[-1]
            united[-1] = (a0, max(b0, b), min(order0, order))
        else:
            united.append((a, b, order))
    return united


def off_mesh(joints: Sequence[Joint], gauze: Gauze) -> tuple[int, ...]:
    """Return the numbers of the joints whose rows do not fall into the others' mesh cells.

    The hoop threads lie ``pitch_mm`` apart all along the tube; the longest total cut that
    agrees on where they lie decides, and a joint that differs by more than a thread is named.
    """
    pitch = gauze.pitch_mm
    if not joints:
        return ()
    phase = np.array([slit_rows(joint, pitch)[0] for joint in joints])
    shift = np.abs((phase[:, None] - phase[None, :] + pitch / 2) % pitch - pitch / 2)
    agree = shift <= gauze.thread_mm
    cut = np.array([joint.openF_mm for joint in joints])
    leader = int(np.argmax(agree @ cut))
    return tuple(j.number for j, same in zip(joints, agree[leader], strict=True) if not same)


def seam_at(joints: Sequence[Joint], seam_deg: float) -> SeamChoice:
    """Return what a seam at ``seam_deg`` crosses, and how far it is from any sector's edge."""
    seam = seam_deg % FULL_CIRCLE
    start, extent = _sectors(joints)
    inside = _strictly_inside(np.array([seam]), start, extent)[0]
    edges = _edges(start, extent)
    margin = FULL_CIRCLE / 2
    if edges.size:
        away = np.abs((edges - seam + FULL_CIRCLE / 2) % FULL_CIRCLE - FULL_CIRCLE / 2)
        margin = float(away.min())
    crossed = tuple(j.number for j, cut in zip(joints, inside, strict=True) if cut)
    return SeamChoice(seam, crossed, margin)


def best_seam(joints: Sequence[Joint]) -> SeamChoice:
    """Return the best place for the glue and weld line.

    The edges of all cut sectors part the circle into arcs; within one, the same joints are
    crossed. Of the arcs on which the crossed joints' ``openF`` sums to the least, the widest
    one is taken, and its middle: the point with the greatest margin. Among equals the nearest
    to the first joint's ``alpha_center`` wins, then the counter-clockwise one, so that turning
    all joints turns the seam with them.
    """
    start, extent = _sectors(joints)
    edges = _edges(start, extent)
    home = joints[0].alpha_center_deg if joints else TOWARD_DEG
    if not edges.size:
        return seam_at(joints, home)
    width = np.diff(edges, append=edges[0] + FULL_CIRCLE)
    middle = edges + width / 2
    crossed = _strictly_inside(middle, start, extent)
    cost = crossed @ np.array([joint.openF_mm for joint in joints])
    away = (middle - home + FULL_CIRCLE / 2) % FULL_CIRCLE - FULL_CIRCLE / 2
    keys = (away < 0, *(np.round(key, 6) for key in (np.abs(away), -width, cost)))
    return seam_at(joints, float(middle[np.lexsort(keys)[0]]))


def _sectors(joints: Sequence[Joint]) -> tuple[FloatArray, FloatArray]:
    """Return the cut sectors' starts and extents, (N,) deg each."""
    pairs = np.array([cut_sector(joint) for joint in joints]).reshape(-1, 2)
    return pairs[:, 0], pairs[:, 1]


def _strictly_inside(
    angles: FloatArray, start: FloatArray, extent: FloatArray
) -> NDArray[np.bool_]:
    """Tell which angles (M,) lie inside which sectors (N,), edges left out; (M, N)."""
    into = (angles[:, None] - start) % FULL_CIRCLE
    within = (into > SAME_DEG) & (into < extent - SAME_DEG)
    return np.asarray(within | (extent >= FULL_CIRCLE))


def _edges(start: FloatArray, extent: FloatArray) -> FloatArray:
    """Return the sectors' edges, (K,) deg, ascending, each once; none for 0 and 360 deg."""
    real = (extent > SAME_DEG) & (extent < FULL_CIRCLE - SAME_DEG)
    edges = np.sort(np.concatenate([start[real], start[real] + extent[real]]) % FULL_CIRCLE)
    if not edges.size:
        return edges
    gap = np.diff(edges, prepend=edges[-1] - FULL_CIRCLE)
    return edges[gap > SAME_DEG]
