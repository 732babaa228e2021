"""What the sheet tells the person at the bench: title, warnings, legend, check measures."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import PurePath

import numpy as np

from profiletool.records import TOWARD_DEG, Design
from profiletool.template.drawing import Box, Line, Text, arrow, circle, polyline, wrapped
from profiletool.template.labels import short
from profiletool.template.strokes import text_width
from profiletool.template.unroll import SeamChoice, off_mesh, slit_rows

TITLE_MM, ALARM_MM, BODY_MM, SMALL_MM = 5.0, 6.0, 3.0, 2.5
LINE_SPACING = 1.7
BAR_MM = 100.0
CHECK_BOX_MM = (100.0, 50.0)
END_VIEW_RADIUS_MM = 11.0
LEGEND_GAP_MM = 6.0
LEGEND_MM = 130.0
NAME_MM = 100.0

STEPS = (
    "1 Plot at 100 %. Measure bar and box.",
    "2 Cut the black outline with its notch.",
    "3 Cut the blue lines only: they sever the axial threads. Do not remove the windows. "
    "The hoop threads stay whole.",
    "4 Lay the sheet this face up, the tube on top. Glue the start edge on the "
    "tube's {seam}° line.",
    "5 Roll {times}, tight: the cuts of all turns must lie over each other.",
    "6 Weld the end edge on the register line.",
)
KEY = (
    "Labels: joint, openF in mm / alpha in °.",
    "Green: mark. Red and grey: for reading.",
)


def title_of(design: Design) -> str:
    """Return the sheet's title: the object's file, and what is wrong with the design."""
    return " - ".join(_title_lines(design))


def title_block(
    design: Design, size: tuple[float, float], seam: SeamChoice, frame: tuple[float, float, float]
) -> tuple[Text, ...]:
    """Return title, data and warnings, stacked upward.

    ``frame`` is (left, right, bottom) of the room they have, mm; there is no top.
    """
    left, right, bottom = frame
    name, *alarms = _title_lines(design)
    rows = [(name, TITLE_MM), *((text, ALARM_MM) for text in alarms)]
    facts = [text for text in _facts(design, size) for text in wrapped(text, BODY_MM, right - left)]
    rows += [(text, BODY_MM) for text in facts]
    for warning in _warnings(design, seam):
        rows += [(text, BODY_MM) for text in wrapped(warning, BODY_MM, right - left)]
    texts: list[Text] = []
    y, below = bottom, 0.0
    for text, height in reversed(rows):
        y += max(height, below) * (LINE_SPACING - 1) if texts else 0.0
        texts.append(Text("NOTE", text, left, y, height))
        y, below = y + height, height
    return tuple(reversed(texts))


def reference(left: float, top: float) -> tuple[tuple[Line, ...], tuple[Text, ...], Box]:
    """Return the 100 mm bar and the 50 x 100 mm check box below ``top``, and the box's place."""
    y = top - 3.0
    lines = [polyline("REF", (left, y), (left + BAR_MM, y))]
    for k in range(11):
        length = 3.0 if k % 5 == 0 else 1.5
        lines.append(polyline("REF", (left + 10 * k, y + length), (left + 10 * k, y)))
    texts = [Text("REF", "100 mm", left + BAR_MM / 2, y - 4.5, BODY_MM, "centre")]
    width, height = CHECK_BOX_MM
    box = (left, y - 8.0 - height, left + width, y - 8.0)
    x0, y0, x1, y1 = box
    lines.append(Line("REF", np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]]), closed=True))
    middle = (x0 + x1) / 2, (y0 + y1) / 2
    texts.append(Text("REF", "check box 50 x 100 mm", middle[0], middle[1], BODY_MM, "centre"))
    texts.append(
        Text("REF", "measure before cutting", middle[0], middle[1] - 5.5, SMALL_MM, "centre")
    )
    return tuple(lines), tuple(texts), box


def legend(design: Design, left: float, right: float, top: float) -> tuple[Text, ...]:
    """Return the working steps, from ``top`` downward between ``left`` and ``right``."""
    turns = design.gauze.turns
    times = {1: "once", 2: "twice"}.get(turns, f"{turns} times")
    seam = short(design.gauze.seam_deg)
    width = min(right - left, LEGEND_MM)
    hang = text_width("1 ", SMALL_MM) + SMALL_MM / 4
    texts: list[Text] = []
    y = top
    for step in (*STEPS, *KEY):
        indent = 0.0 if step in KEY else hang
        rows = wrapped(step.format(seam=seam, times=times), SMALL_MM, width - indent)
        for k, row in enumerate(rows):
            y -= SMALL_MM * LINE_SPACING if texts else SMALL_MM
            texts.append(Text("NOTE", row, left + (indent if k else 0.0), y, SMALL_MM))
        y -= SMALL_MM / 4
    return tuple(texts)


def end_view(seam_deg: float, x: float, y: float) -> tuple[tuple[Line, ...], tuple[Text, ...]]:
    """Return the tube's end view, centred on (x, y): seam, gauze before rolling, object side."""
    r = END_VIEW_RADIUS_MM
    radial = np.array([np.cos(np.radians(seam_deg)), np.sin(np.radians(seam_deg))])
    along = np.array([-radial[1], radial[0]])
    foot = np.array([x, y]) + r * radial
    lines = [
        circle("NOTE", x, y, r),
        Line("NOTE", np.array([foot - 2.5 * radial, foot])),
        *arrow("NOTE", foot, foot + 9.0 * along),
    ]
    texts = (
        Text("NOTE", f"seam {short(seam_deg)}°", x, y - SMALL_MM / 2, SMALL_MM, "centre"),
        Text("NOTE", f"object side {short(TOWARD_DEG)}°", x, y - r - 7.5, SMALL_MM, "centre"),
        Text("NOTE", "seen from closed end", x, y - r - 13.0, SMALL_MM, "centre"),
    )
    return tuple(lines), texts


def _title_lines(design: Design) -> list[str]:
    """Return the file's name, without characters that no file format takes, and the alarms."""
    name = "".join(char for char in PurePath(design.source.file).name if char.isprintable())
    lines = [f"Cut template: {_shortened(name, TITLE_MM, NAME_MM)}"]
    if not design.feasible:
        lines.append("INFEASIBLE")
    if not design.verified:
        lines.append("NOT VERIFIED")
    return lines


def _facts(design: Design, size: tuple[float, float]) -> list[str]:
    tube, gauze = design.tube, design.gauze
    return [
        f"Tube D {tube.outer_diameter_mm:g}, wall {tube.wall_mm:g}, length "
        f"{short(tube.length_mm)} mm.  Pressure {design.pressure_bar:.2f} bar.  "
        f"Joints: {len(design.joints)}.",
        f"Gauze {short(size[0])} x {short(size[1])} mm, mesh {gauze.pitch_mm:g} mm, thread "
        f"{gauze.thread_mm:g} mm, turns: {gauze.turns}, seam {short(gauze.seam_deg)}°.  Kerf 0.",
    ]


def _warnings(design: Design, seam: SeamChoice) -> list[str]:
    """Return what needs the bench's attention, a sentence each."""
    warnings = []
    if seam.crossed:
        warnings.append(
            f"! {_named(seam.crossed)}: cut crosses the weld line. Its slits run out of the start "
            "and the end edge. Keep glue and weld off the slits."
        )
    thread_deg = 360.0 * design.gauze.pitch_mm / (np.pi * design.tube.outer_diameter_mm)
    if seam.margin_deg < thread_deg:
        gap = seam.margin_deg / thread_deg * design.gauze.pitch_mm
        warnings.append(f"! A cut ends only {short(gap)} mm from the weld line.")
    stray = off_mesh(design.joints, design.gauze)
    if stray:
        warnings.append(
            f"! {_named(stray)}: rows lie off the mesh of the other joints. Cut between the hoop "
            "threads nearest to each line, never along a thread."
        )
    beyond = tuple(
        joint.number
        for joint in design.joints
        if slit_rows(joint, design.gauze.pitch_mm)[0] <= 0
        or slit_rows(joint, design.gauze.pitch_mm)[-1] >= design.tube.length_mm
    )
    if beyond:
        warnings.append(f"! {_named(beyond)}: rows beyond the tube's end are left out.")
    return warnings


def _named(numbers: Sequence[int]) -> str:
    return f"Joint{'s' if len(numbers) > 1 else ''} {', '.join(map(str, numbers))}"


def _shortened(text: str, height: float, width: float) -> str:
    """Cut ``text`` down to ``width``, with dots in place of its middle."""
    keep = len(text)
    fitting = text
    while text_width(fitting, height) > width:
        keep -= 1
        fitting = f"{text[: keep - keep // 2]}...{text[len(text) - keep // 2 :]}"
    return fitting
