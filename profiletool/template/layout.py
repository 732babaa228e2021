"""A design to its cut template: the piece of gauze in the middle, its labels in the margins."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from profiletool.records import Design, FloatArray, Joint
from profiletool.template.drawing import Box, Drawing, Line, Text, arrow, polyline
from profiletool.template.labels import joint_labels, margin_numbers
from profiletool.template.notes import (
    LEGEND_GAP_MM,
    end_view,
    legend,
    reference,
    title_block,
    title_of,
)
from profiletool.template.unroll import (
    FULL_CIRCLE,
    SeamChoice,
    Slit,
    roll_of,
    seam_at,
    sheet_size,
    slits,
)

NOTCH_MM = 3.0
LEAST_NOTCH_MM = 0.5
# The weld line keeps off the outline and off the slits by this much.
OFF_MM = 0.6
LEFT_MM, RIGHT_MM = 30.0, 44.0
LEAST_WIDTH_MM = 181.0
EDGE_TEXT_MM = 3.5
# Distances from row to row above and below the sheet.
STEP_MM = 2.5
BLOCK_MM = 6.0
THREADS_MM = 2.5
Drawn = tuple[Sequence[Line], Sequence[Text]]


@dataclass(frozen=True)
class Sheet:
    """A cut template: x along the tube, y up along the roll.

    Attributes
    ----------
    drawing : Drawing
        All of it; its CUT_INNER lines are the slits, joint by joint, row by row, along the roll.
    size_mm : (float, float)
        The piece of gauze: along the tube, along the roll.
    outline : (N, 2) float
        Its closed outline, first point not repeated, counter-clockwise.
    slits : tuple of Slit
    seam : SeamChoice
        The weld line and what it crosses.
    """

    drawing: Drawing
    size_mm: tuple[float, float]
    outline: FloatArray
    slits: tuple[Slit, ...]
    seam: SeamChoice


def build_sheet(design: Design) -> Sheet:
    """Return the cut template of ``design``, its gauze seam where the design puts it.

    Raises
    ------
    ValueError
        The gauze makes no turn, the mesh has no pitch, the tube no length, or an alpha is
        outside 0..360 deg.
    """
    if design.gauze.turns < 1 or design.tube.length_mm <= 0:
        raise ValueError("a template needs a tube of some length and at least one turn of gauze")
    size = sheet_size(design.tube, design.gauze)
    cuts = slits(design.joints, design.tube, design.gauze)
    seam = seam_at(design.joints, design.gauze.seam_deg)
    notch = _notch(design.joints, size[0])
    right = max(size[0] + RIGHT_MM, LEAST_WIDTH_MM - LEFT_MM)
    ticks, numbers, reach = margin_numbers(design.joints, size[1])
    edge = reach + STEP_MM + EDGE_TEXT_MM
    threads = edge + STEP_MM + THREADS_MM
    parts: tuple[Drawn, ...] = (
        _weld_line(design, size),
        (ticks, numbers),
        _edge_labels(size, reach + STEP_MM),
        _thread_arrows(size[0] / 2, -threads),
        _side_labels(design, size),
        end_view(design.gauze.seam_deg, size[0] + 28.0, size[1] / 4 + 5.0),
        _below(design, right, -threads - BLOCK_MM),
    )
    texts = (
        *joint_labels(design, cuts, _barred(size, notch)),
        *(text for _, some in parts for text in some),
        *title_block(design, size, seam, (-LEFT_MM, right, size[1] + edge + BLOCK_MM)),
    )
    outline = _outline(size, notch)
    drawn = (
        Line("CUT_OUTER", outline, closed=True),
        *(polyline("CUT_INNER", (s.x_mm, s.y_start_mm), (s.x_mm, s.y_end_mm)) for s in cuts),
        *(line for some, _ in parts for line in some),
    )
    return Sheet(Drawing(title_of(design), drawn, texts), size, outline, cuts, seam)


def _notch(joints: Sequence[Joint], length: float) -> Box | None:
    """Return the box of the notch in the start edge: in the root, else in the widest gap."""
    gaps = [gap for gap in _gaps(joints, length, 0.0) if _notch_width(gap) >= LEAST_NOTCH_MM]
    if not gaps:
        return None
    a, b = gaps[0] if gaps[0][0] == 0 else max(gaps, key=lambda gap: gap[1] - gap[0])
    half = _notch_width((a, b)) / 2
    return (a + b) / 2 - half, 0.0, (a + b) / 2 + half, 2 * half


def _barred(size: tuple[float, float], notch: Box | None) -> list[Box]:
    """Return where no label may stand: beyond the ends of the tube, and the notch."""
    length, roll = size
    beyond = [(-math.inf, 0.0, 0.0, roll), (length, 0.0, math.inf, roll)]
    return [*beyond, notch] if notch else beyond


def _notch_width(gap: tuple[float, float]) -> float:
    return min(NOTCH_MM, (gap[1] - gap[0]) / 2)


def _gaps(joints: Sequence[Joint], length: float, clearance: float) -> list[tuple[float, float]]:
    """Return the stretches of the tube (from, to), mm, that ``joints`` leave uncut."""
    gaps = []
    x = 0.0
    for joint in sorted(joints, key=lambda j: j.centre_mm - j.openF_mm / 2):
        half = joint.openF_mm / 2 + clearance
        if joint.centre_mm - half > x:
            gaps.append((x, min(joint.centre_mm - half, length)))
        x = max(x, joint.centre_mm + half)
    return [*gaps, (x, length)] if x < length else gaps


def _outline(size: tuple[float, float], notch: Box | None) -> FloatArray:
    """Return the outline (N, 2) mm, counter-clockwise, with the notch in its start edge."""
    length, roll = size
    corners = [[0.0, 0.0], [length, 0.0], [length, roll], [0.0, roll]]
    if notch:
        x0, _, x1, depth = notch
        corners[1:1] = [[x0, 0.0], [(x0 + x1) / 2, depth], [x1, 0.0]]
    return np.array(corners)


def _weld_line(design: Design, size: tuple[float, float]) -> Drawn:
    """Return the register line, one turn before the end edge, open where cuts cross it."""
    y = _weld_y(design)
    if y <= 0:
        return (), ()
    numbers = seam_at(design.joints, design.gauze.seam_deg).crossed
    crossing = [joint for joint in design.joints if joint.number in numbers]
    lines = tuple(
        Line("MARK", np.array([[max(a, OFF_MM), y], [min(b, size[0] - OFF_MM), y]]))
        for a, b in _gaps(crossing, size[0], OFF_MM)
        if min(b, size[0] - OFF_MM) > max(a, OFF_MM)
    )
    x = size[0]
    pointer = arrow("MARK", np.array([x + 11.0, y]), np.array([x + 1.0, y]))
    texts = (
        Text("MARK", "Register line", x + 13.0, y + 0.7, EDGE_TEXT_MM),
        Text("MARK", "weld end edge here", x + 13.0, y - 3.2, 2.5),
    )
    return lines + pointer, texts


def _weld_y(design: Design) -> float:
    roll = roll_of(design.tube, design.gauze)
    return float(roll.y_mm(FULL_CIRCLE * (design.gauze.turns - 1)))


def _edge_labels(size: tuple[float, float], away: float) -> Drawn:
    """Return what stands ``away`` above the end edge and below the start edge."""
    x, height = size[0] / 2, EDGE_TEXT_MM
    above = Text("MARK", "End edge: weld on register line", x, size[1] + away, height, "centre")
    below = Text("MARK", "Start edge: glue to tube", x, -away - height, height, "centre")
    return (), (above, below)


def _thread_arrows(x: float, y: float) -> Drawn:
    """Return the direction of the axial threads, lettered around (x, y)."""
    text = Text("MARK", "Axial threads", x, y, THREADS_MM, "centre")
    x0, _, x1, _ = text.box
    lines = [
        line
        for start, way in ((x0 - 2.0, -1), (x1 + 2.0, 1))
        for line in arrow(
            "MARK",
            np.array([start, y + THREADS_MM / 2]),
            np.array([start + way * 10.0, y + THREADS_MM / 2]),
        )
    ]
    return tuple(lines), (text,)


def _side_labels(design: Design, size: tuple[float, float]) -> Drawn:
    """Return what stands beside the ends of the tube: their names, the turns, the roll arrow."""
    length, height = size
    roll = roll_of(design.tube, design.gauze)
    texts = [
        Text("MARK", "Clamped end", -3.0, height / 4, EDGE_TEXT_MM, "centre", upward=True),
        Text("MARK", "Closed end", length + 6.5, height / 4, EDGE_TEXT_MM, "centre", upward=True),
        Text("MARK", "Roll this way", -24.0, height / 2, EDGE_TEXT_MM, "centre", upward=True),
    ]
    lines = list(
        arrow("MARK", np.array([-20.5, 0.2 * height]), np.array([-20.5, 0.8 * height]), head=5.0)
    )
    ends = [float(roll.y_mm(FULL_CIRCLE * k)) for k in range(design.gauze.turns + 1)]
    for turn, (a, b) in enumerate(pairwise(ends), start=1):
        x, y0, y1 = -10.5, a + OFF_MM, b - OFF_MM
        bracket = np.array([[x + 1.5, y0], [x, y0], [x, y1], [x + 1.5, y1]])
        lines.append(Line("MARK", bracket))
        middle = (a + b) / 2
        texts.append(Text("MARK", f"Turn {turn}", -12.0, middle, 2.5, "centre", upward=True))
    return tuple(lines), tuple(texts)


def _below(design: Design, right: float, top: float) -> Drawn:
    """Return what stands below the sheet: bar, check box, legend."""
    lines, texts, box = reference(-LEFT_MM, top)
    return lines, texts + legend(design, box[2] + LEGEND_GAP_MM, right, top)
