"""The gauze on the flat: its size and its slits; conventions as in `profiletool.joints.roll`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from profiletool.joints.roll import Variant, roll_of, window_intervals
from profiletool.joints.windows import SAME_DEG, slit_rows
from profiletool.records.design import Design, Gauze, Joint, Tube

SAME_MM = 1e-6


@dataclass(frozen=True)
class Slit:
    """One slit along the hoop threads: from (x, y_start) to (x, y_end), mm."""

    joint: int
    x_mm: float
    y_start_mm: float
    y_end_mm: float


def sheet_size(design: Design, variant: Variant = "gauze") -> tuple[float, float]:
    """Return the sheet's size (along the tube from open to closed end, along the roll) in mm."""
    along = design.clamp.length_mm + design.tube.length_mm
    return along, roll_of(design.tube, design.gauze, variant).length_mm


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
