"""The axial threads of a sheet of gauze: where they lie on the tube, and which stay whole.

The sheet's start edge is cut half-way between two axial threads, so thread k lies at
y = (k + 1/2) pitch along the roll. Both turns lie at their own radius: from one thread to the next
it is less of an angle in the outer turn than in the inner one, and in both less than
pitch / (D/2), the angle of a thread on the tube itself.
"""

from __future__ import annotations

import numpy as np

from profiletool.joints.roll import roll_of, window_intervals
from profiletool.joints.windows import FULL_CIRCLE, SAME_DEG
from profiletool.records.built import SectorThreads
from profiletool.records.design import Design, Gauze, Joint, Tube
from profiletool.records.units import FloatArray

_DECIMALS = 4  # deg


def thread_rolls(tube: Tube, gauze: Gauze) -> FloatArray:
    """Roll angles of all axial threads of the sheet, ascending over all turns, (N,) deg."""
    roll = roll_of(tube, gauze)
    count = int(np.floor(roll.length_mm / gauze.pitch_mm + 0.5))
    return roll.phi_deg(gauze.pitch_mm * np.arange(0.5, count))


def whole_rolls(joint: Joint, tube: Tube, gauze: Gauze) -> FloatArray:
    """Roll angles of the axial threads that a joint's slits leave whole, (n,) deg."""
    rolls = thread_rolls(tube, gauze)
    cut = np.zeros(len(rolls), dtype=bool)
    for start, end in window_intervals(joint, gauze.seam_deg, roll_of(tube, gauze)):
        cut |= (rolls >= start - SAME_DEG) & (rolls <= end + SAME_DEG)
    return np.asarray(rolls[~cut])


def whole_angles(design: Design) -> tuple[FloatArray, ...]:
    """Angles on the tube of the axial threads that each joint leaves whole, all turns, deg."""
    gauze = design.gauze
    return tuple(
        np.asarray((gauze.seam_deg + whole_rolls(joint, design.tube, gauze)) % FULL_CIRCLE)
        for joint in design.joints
    )


def threads_of(design: Design) -> tuple[SectorThreads, ...]:
    """Count the axial threads that stay whole at every joint, turn by turn."""
    gauze, found = design.gauze, []
    for joint in design.joints:
        rolls = whole_rolls(joint, design.tube, gauze)
        start = joint.alpha_center_deg - 0.5 * joint.alpha_closed_deg
        for turn in range(gauze.turns):
            own = rolls[(rolls // FULL_CIRCLE).astype(int) == turn]
            into = (gauze.seam_deg + own - start) % FULL_CIRCLE
            phase = round(float(into.min()), _DECIMALS) if len(own) else 0.0
            found.append(SectorThreads(joint.number, turn + 1, len(own), phase))
    return tuple(found)
