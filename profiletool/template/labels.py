"""The joints' numbers on the sheet: where there is room that no slit and no text runs through."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from typing import Literal

import numpy as np

from profiletool.joints.roll import Roll, window_intervals
from profiletool.joints.windows import FULL_CIRCLE
from profiletool.records.design import Design, Joint
from profiletool.records.units import FloatArray
from profiletool.template.drawing import Box, Line, Text
from profiletool.template.unroll import Slit

# Ways to write a label: height of the number, of openF/alpha, and where the latter stands. The
# first that fits is taken.
STYLES: tuple[tuple[float, float, Literal["below", "beside", ""]], ...] = (
    (5.0, 2.5, "below"),
    (4.0, 2.5, "below"),
    (3.5, 2.5, "below"),
    (4.0, 2.5, "beside"),
    (3.0, 2.5, "beside"),
    (5.0, 0.0, ""),
    (3.5, 0.0, ""),
    (2.5, 0.0, ""),
    (1.8, 0.0, ""),
)
LEADING_MM = 1.1
BESIDE_MM = 2.5
CLEAR_MM = 0.8
# Places tried along the roll, as shares of the free stretch: its middle first.
SHARES = (0.5, 0.35, 0.65, 0.2, 0.8, 0.05, 0.95)
TICK_MM = (0.8, 3.3)
NUMBER_MM = 3.5
NUMBER_ROWS = 3


def joint_labels(
    design: Design, roll: Roll, cuts: Sequence[Slit], taken: Sequence[Box]
) -> tuple[Text, ...]:
    """Return each joint's number, openF and alpha, once per turn, in its uncut sector.

    Parameters
    ----------
    design : Design
        The actuator.
    roll : Roll
        How the sheet lies around it.
    cuts : sequence of Slit
        All slits of the sheet.
    taken : sequence of Box
        Where nothing may be written, mm.

    Returns
    -------
    tuple of Text
        A joint is left out of a turn in which nothing fits; its number is in the margin too.
    """
    slit_boxes = ((s.x_mm, s.y_start_mm, s.x_mm, s.y_end_mm) for s in cuts)
    barred = np.array([*taken, *slit_boxes]).reshape(-1, 4)
    turns = range(roll.turns)
    texts: list[Text] = []
    for joint in design.joints:
        # The same place on all turns where possible, so that the labels register when rolled.
        label = _first_clear(_options(design, joint, roll, turns), barred)
        for turn in turns if not label else ():
            label += _first_clear(_options(design, joint, roll, [turn]), barred)
        texts += label
        barred = np.array([*barred, *(text.box for text in label)]).reshape(-1, 4)
    return tuple(texts)


def margin_numbers(
    joints: Sequence[Joint], roll_mm: float
) -> tuple[tuple[Line, ...], tuple[Text, ...], float]:
    """Return centre ticks and joint numbers beyond both edges of a sheet ``roll_mm`` high.

    Numbers that would run into each other stand in up to three rows. The last value is how far
    from the edges they reach, mm.
    """
    lines: list[Line] = []
    texts: list[Text] = []
    reach = [-np.inf] * NUMBER_ROWS
    deepest = TICK_MM[1]
    for joint in sorted(joints, key=lambda j: j.centre_mm):
        x = joint.centre_mm
        text = Text("MARK", str(joint.number), x, 0.0, NUMBER_MM, "centre")
        row = next((k for k in range(NUMBER_ROWS) if reach[k] < text.box[0]), 0)
        reach[row] = text.box[2] + CLEAR_MM
        away = TICK_MM[1] + 1.0 + row * (NUMBER_MM + 1.0)
        deepest = max(deepest, away + NUMBER_MM)
        for edge, sign in ((0.0, -1), (roll_mm, 1)):
            lines.append(Line("MARK", np.array([[x, edge + sign * end] for end in TICK_MM])))
            y = edge + away if sign > 0 else edge - away - NUMBER_MM
            texts.append(Text("MARK", text.text, x, y, NUMBER_MM, "centre"))
    return tuple(lines), tuple(texts), deepest


def short(value: float) -> str:
    """Return a number with at most one decimal."""
    return f"{round(value, 1):g}"


def times(turns: int) -> str:
    """Say how often."""
    return {1: "once", 2: "twice"}.get(turns, f"{turns} times")


def _options(
    design: Design, joint: Joint, roll: Roll, turns: Sequence[int]
) -> Iterator[tuple[Text, ...]]:
    """Yield the ways to label a joint at one place of each of ``turns``, the best first."""
    free = [_free_stretches(joint, design.gauze.seam_deg, roll, turn) for turn in turns]
    for style in STYLES:
        for places in zip(*free, strict=False):
            spans = [roll.y_mm(phi) + np.array([CLEAR_MM, -CLEAR_MM]) for phi in places]
            room = min(float(y1 - y0) for y0, y1 in spans) - _height(style)
            for share in SHARES if room >= 0 else ():
                yield tuple(
                    text
                    for y0, _ in spans
                    for text in _label(joint, float(y0) + share * room, style)
                )


def _height(style: tuple[float, float, str]) -> float:
    number, small, where = style
    return number + small + LEADING_MM if where == "below" else number


def _label(joint: Joint, y: float, style: tuple[float, float, str]) -> tuple[Text, ...]:
    """Return one label with its lower edge at ``y``, in the middle of the joint."""
    number, small, where = style
    x = joint.centre_mm
    head = Text("MARK", str(joint.number), x, y + _height(style) - number, number, "centre")
    if not where:
        return (head,)
    foot = Text("MARK", f"{short(joint.openF_mm)}/{short(joint.alpha_closed_deg)}°", x, y, small)
    if where == "below":
        return head, replace(foot, anchor="centre")
    left = x - (head.width + BESIDE_MM + foot.width) / 2
    return (
        replace(head, x=left, anchor="left"),
        replace(foot, x=left + head.width + BESIDE_MM),
    )


def _first_clear(options: Iterable[tuple[Text, ...]], barred: FloatArray) -> tuple[Text, ...]:
    """Return the first of ``options`` that meets nothing barred (N, 4), or none at all."""
    return next(
        (texts for texts in options if not any(_meets(text.box, barred) for text in texts)), ()
    )


def _free_stretches(joint: Joint, seam_deg: float, roll: Roll, turn: int) -> list[FloatArray]:
    """Return the uncut stretches (phi from, to) of a joint in a turn, the longest first."""
    ends = np.array([turn, turn + 1]) * FULL_CIRCLE
    cut = window_intervals(joint, seam_deg, roll).clip(*ends)
    edges = np.concatenate([ends[:1], cut.ravel(), ends[1:]]).reshape(-1, 2)
    return sorted(edges, key=lambda stretch: round(float(stretch[0] - stretch[1]), 6))


def _meets(box: Box, barred: FloatArray) -> bool:
    """Tell whether a box comes closer than ``CLEAR_MM`` to any of the barred ones (N, 4)."""
    x0, y0, x1, y1 = box
    apart = (
        (barred[:, 2] < x0 - CLEAR_MM)
        | (barred[:, 0] > x1 + CLEAR_MM)
        | (barred[:, 3] < y0 - CLEAR_MM)
        | (barred[:, 1] > y1 + CLEAR_MM)
    )
    return bool((~apart).any())
