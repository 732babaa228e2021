"""Marks around the piece on its sheet: register line, names of edges and ends, arrows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from profiletool.joints.roll import Roll
from profiletool.joints.windows import FULL_CIRCLE, SeamChoice
from profiletool.records.design import Joint
from profiletool.template.drawing import Line, Text, arrow, polyline
from profiletool.template.kinds import TemplateKind
from profiletool.template.labels import margin_numbers

# How far the marks beside the piece reach: with a tube of 230 mm they fill a landscape A4 page.
LEFT_MM, RIGHT_MM = 14.5, 21.5
NOTCH_MM = 3.0  # of the notch in the start edge, beside x = 0
# Lines on the piece keep off its outline and off the slits by this much.
OFF_MM = 0.6
EDGE_TEXT_MM, SMALL_MM = 3.5, 2.5
STEP_MM = 2.5  # from row to row above and below the piece
CLAMP_WORDS = ("x = 0: edge of the clamp", "x = 0")  # the first for which there is room
Drawn = tuple[Sequence[Line], Sequence[Text]]


@dataclass(frozen=True)
class Margins:
    """What is drawn around the piece, and how far that reaches above and below it, mm."""

    lines: tuple[Line, ...]
    texts: tuple[Text, ...]
    above_mm: float
    below_mm: float


def margins(
    joints: Sequence[Joint],
    ends_mm: tuple[float, float],
    roll: Roll,
    kind: TemplateKind,
    seam: SeamChoice,
) -> Margins:
    """Return all marks around a piece, and its line x = 0; ``ends_mm`` are its open and closed."""
    size = ends_mm[1], roll.length_mm + kind.tab_mm
    ticks, numbers, reach = margin_numbers(joints, size[1])
    edge = reach + STEP_MM
    below = edge + EDGE_TEXT_MM + STEP_MM + SMALL_MM
    parts: tuple[Drawn, ...] = (
        (ticks, numbers),
        _register_line(joints, ends_mm, roll, kind, seam),
        _clamp_line(roll, kind),
        _edge_names(size, edge, kind),
        _thread_arrows(size[0] / 2, -below),
        _side_names(ends_mm, size[1], roll),
    )
    return Margins(
        tuple(line for lines, _ in parts for line in lines),
        tuple(text for _, texts in parts for text in texts),
        above_mm=edge + EDGE_TEXT_MM,
        below_mm=below,
    )


def gaps(
    joints: Sequence[Joint], ends: tuple[float, float], clearance: float
) -> list[tuple[float, float]]:
    """Return the stretches of the tube (from, to) between ``ends``, mm, that joints leave uncut."""
    found = []
    x, length = ends
    for joint in sorted(joints, key=lambda j: j.centre_mm - j.openF_mm / 2):
        half = joint.openF_mm / 2 + clearance
        if joint.centre_mm - half > x:
            found.append((x, min(joint.centre_mm - half, length)))
        x = max(x, joint.centre_mm + half)
    return [*found, (x, length)] if x < length else found


def _register_line(
    joints: Sequence[Joint],
    ends: tuple[float, float],
    roll: Roll,
    kind: TemplateKind,
    seam: SeamChoice,
) -> Drawn:
    """Return the line that an edge comes to lie on, open where cuts cross it."""
    turns = roll.turns if kind.tab_mm else roll.turns - 1
    y, (start, length) = float(roll.y_mm(FULL_CIRCLE * turns)), ends
    if y <= 0 or not kind.register:
        return (), ()
    crossing = [joint for joint in joints if joint.number in seam.crossed]
    lines = [
        polyline("MARK", (max(a, start + OFF_MM), y), (min(b, length - OFF_MM), y))
        for a, b in gaps(crossing, ends, OFF_MM)
        if min(b, length - OFF_MM) > max(a, start + OFF_MM)
    ]
    lines += arrow("MARK", np.array([length + 9.0, y]), np.array([length + 1.0, y]))
    name = Text("MARK", kind.register, length + 13.0, y, SMALL_MM, "centre", upward=True)
    # Its text stays beside the piece.
    least = min(y, roll.length_mm + kind.tab_mm - name.width / 2)
    return lines, (replace(name, y=least),)


def _clamp_line(roll: Roll, kind: TemplateKind) -> Drawn:
    """Return the line x = 0 from the notch on, open where the register line crosses it."""
    top = roll.length_mm + kind.tab_mm
    turns = roll.turns if kind.tab_mm else roll.turns - 1
    crossing = [float(roll.y_mm(FULL_CIRCLE * turns))] if kind.register and turns else []
    edges = [NOTCH_MM, *(y + way * OFF_MM for y in crossing for way in (-1, 1)), top]
    spans = [(a + OFF_MM, b - OFF_MM) for a, b in zip(edges[::2], edges[1::2], strict=True)]
    lines = [polyline("MARK", (0.0, a), (0.0, b)) for a, b in spans if b > a]
    low, high = spans[0]
    texts = (
        Text("MARK", words, -1.2, (low + high) / 2, SMALL_MM, "centre", upward=True)
        for words in CLAMP_WORDS
    )
    fitting = (text for text in texts if text.width < high - low - 2 * SMALL_MM)
    return lines, [text for text in [next(fitting, None)] if text is not None]


def _edge_names(size: tuple[float, float], away: float, kind: TemplateKind) -> Drawn:
    """Return what stands ``away`` above the end edge and below the start edge."""
    x, height = size[0] / 2, EDGE_TEXT_MM
    above = Text("MARK", kind.end, x, size[1] + away, height, "centre")
    below = Text("MARK", kind.start, x, -away - height, height, "centre")
    return (), (above, below)


def _thread_arrows(x: float, y: float) -> Drawn:
    """Return the direction of the axial threads, lettered around (x, y)."""
    text = Text("MARK", "Axial threads", x, y, SMALL_MM, "centre")
    x0, _, x1, _ = text.box
    lines: list[Line] = []
    for start, way in ((x0 - 2.0, -1), (x1 + 2.0, 1)):
        ends = np.array([[start, y + SMALL_MM / 2], [start + way * 10.0, y + SMALL_MM / 2]])
        lines += arrow("MARK", *ends)
    return lines, (text,)


def _side_names(ends: tuple[float, float], height: float, roll: Roll) -> Drawn:
    """Return what stands beside the ends of the tube: their names, the turns, the roll arrow."""
    start, length = ends
    x = length + 16.2
    way = "Wrap this way" if roll.outside else "Roll this way"
    texts = [
        Text("MARK", "Open end", start - 3.0, height / 4, EDGE_TEXT_MM, "centre", upward=True),
        Text("MARK", "Closed end", length + 6.5, height / 4, EDGE_TEXT_MM, "centre", upward=True),
        Text("MARK", way, length + RIGHT_MM, height / 2, EDGE_TEXT_MM, "centre", upward=True),
    ]
    lines = list(arrow("MARK", np.array([x, 0.2 * height]), np.array([x, 0.8 * height]), head=3.5))
    edges = [float(roll.y_mm(FULL_CIRCLE * k)) for k in range(roll.turns + 1)]
    for turn, (a, b) in enumerate(pairwise(edges) if roll.turns > 1 else (), start=1):
        x, y0, y1 = start - 10.5, a + OFF_MM, b - OFF_MM
        lines.append(polyline("MARK", (x + 1.5, y0), (x, y0), (x, y1), (x + 1.5, y1)))
        texts.append(
            Text("MARK", f"Turn {turn}", start - 12.0, (a + b) / 2, SMALL_MM, "centre", True)
        )
    return lines, texts
