"""Notes on the sheet for the bench: title, warnings, legend, check measures."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import PurePath

import numpy as np

from profiletool.joints.windows import SeamChoice, off_mesh, slit_rows
from profiletool.records.design import TOWARD_DEG, Design
from profiletool.records.seal import proven
from profiletool.template.drawing import (
    RULER_MM,
    Box,
    Drawing,
    Line,
    Text,
    arrow,
    circle,
    ruler,
    wrapped,
)
from profiletool.template.kinds import KINDS, Wish
from profiletool.template.labels import short, times
from profiletool.template.strokes import text_width
from profiletool.template.unroll import sheet_size

TITLE_MM, ALARM_MM, BODY_MM, SMALL_MM = 5.0, 6.0, 3.0, 2.5
LINE_SPACING = 1.7
CHECK_BOX_MM = (100.0, 50.0)
END_VIEW_RADIUS_MM = 11.0
LEGEND_GAP_MM = 6.0
LEGEND_MM = 130.0
NAME_MM = 100.0
DATE_CHARS = 30
CYCLES = 5  # in which silicone gets as soft as it stays

KEY = (
    "Labels: joint, openF in mm / alpha in °.",
    "Green: mark. Red and grey: for reading.",
)


def title_of(design: Design, what: str) -> str:
    """Return a drawing's title: what it is, the object's file, what is wrong with the design."""
    return " - ".join(title_lines(design, what))


def notes(
    design: Design,
    size: tuple[float, float],
    seam: SeamChoice,
    wish: Wish,
    left_out: int,
    frame: tuple[float, float, float, float],
) -> Drawing:
    """Return all that is to be read, not made.

    ``left_out`` is the number of slits that are no longer than the kerf. ``frame`` is (left,
    right, bottom of the title block, top of what stands below the piece), mm.
    """
    left, right, bottom, top = frame
    kind = KINDS[wish.variant]
    facts = [*_facts(design, size, wish), *_setting(design), *_warnings(design, seam, wish)]
    if left_out:
        facts.append(f"! {left_out} slits no longer than the kerf are left out.")
    titles = title_block(title_lines(design, kind.title), facts, (left, right, bottom))
    lines, texts, box = reference(left, top)
    seen, said = end_view(
        design.gauze.seam_deg, box[2] - 21.0, (box[1] + box[3]) / 2 + 8.0, wish.variant != "gauze"
    )
    steps = legend(design, kind.steps, (box[2] + LEGEND_GAP_MM, right, top))
    return Drawing(title_of(design, kind.title), lines + seen, titles + texts + said + steps)


def title_block(
    titles: Sequence[str], facts: Sequence[str], frame: tuple[float, float, float]
) -> tuple[Text, ...]:
    """Return title, alarms and facts, stacked upward.

    ``frame`` is (left, right, bottom) of the room they have, mm; there is no top.
    """
    left, right, bottom = frame
    name, *alarms = titles
    rows = [(name, TITLE_MM), *((text, ALARM_MM) for text in alarms)]
    rows += [(row, BODY_MM) for text in facts for row in wrapped(text, BODY_MM, right - left)]
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
    bar, name = scale_bar(left, y)
    lines, texts = [*bar], [name]
    width, height = CHECK_BOX_MM
    box = (left, y - 8.0 - height, left + width, y - 8.0)
    x0, y0, x1, y1 = box
    lines.append(Line("REF", np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]]), closed=True))
    x, y = x0 + 29.0, (y0 + y1) / 2  # the other half is left to the end view
    texts.append(Text("REF", "check box 50 x 100 mm", x, y, BODY_MM, "centre"))
    texts.append(Text("REF", "measure before cutting", x, y - 5.5, SMALL_MM, "centre"))
    return tuple(lines), tuple(texts), box


def scale_bar(left: float, y: float) -> tuple[tuple[Line, ...], Text]:
    """Return the 100 mm bar from (``left``, ``y``) on: its ticks above, its name below."""
    name = Text("REF", "100 mm", left + RULER_MM / 2, y - 4.5, BODY_MM, "centre")
    return ruler(left, y), name


def legend(
    design: Design,
    steps: Sequence[str],
    frame: tuple[float, float, float],
) -> tuple[Text, ...]:
    """Return the numbered working steps and the key within ``frame`` (left, right, top), mm."""
    left, right, top = frame
    filled = {
        "seam": short(design.gauze.seam_deg),
        "times": times(design.gauze.turns),
        "diameter": f"{design.tube.outer_diameter_mm:g}",
        "size": " x ".join(short(side) for side in sheet_size(design)),
    }
    width = min(right - left, LEGEND_MM)
    hang = text_width("1 ", SMALL_MM) + SMALL_MM / 4
    numbered = [f"{n} {step.format(**filled)}" for n, step in enumerate(steps, start=1)]
    texts: list[Text] = []
    y = top
    for step in (*numbered, *KEY):
        indent = 0.0 if step in KEY else hang
        for k, row in enumerate(wrapped(step, SMALL_MM, width - indent)):
            y -= SMALL_MM * LINE_SPACING if texts else SMALL_MM
            texts.append(Text("NOTE", row, left + (indent if k else 0.0), y, SMALL_MM))
        y -= SMALL_MM / 4
    return tuple(texts)


def end_view(
    seam_deg: float, x: float, y: float, outside: bool
) -> tuple[tuple[Line, ...], tuple[Text, ...]]:
    """Return the tube's end view, centred on (x, y): seam, which way the sheet goes, object side.

    A sheet with its face ``outside`` goes around clockwise.
    """
    r = END_VIEW_RADIUS_MM
    radial = np.array([np.cos(np.radians(seam_deg)), np.sin(np.radians(seam_deg))])
    along = np.array([-radial[1], radial[0]]) * (-1.0 if outside else 1.0)
    foot = np.array([x, y]) + r * radial
    lines = [
        circle("NOTE", x, y, r),
        Line("NOTE", np.array([foot - 2.5 * radial, foot])),
        *arrow("NOTE", foot, foot + 9.0 * along),
    ]
    texts = (
        Text("NOTE", f"seam {short(seam_deg)}°", x, y - SMALL_MM / 2, SMALL_MM, "centre"),
        Text("NOTE", f"object side {short(TOWARD_DEG)}°", x, y - r - 7.0, SMALL_MM, "centre"),
        Text("NOTE", "seen from closed end", x, y - r - 11.5, SMALL_MM, "centre"),
    )
    return tuple(lines), texts


def title_lines(design: Design, what: str) -> list[str]:
    """Return the file's name, without characters that no file format takes, and the alarms."""
    name = "".join(char for char in PurePath(design.source.file).name if char.isprintable())
    lines = [f"{what}: {_shortened(name, TITLE_MM, NAME_MM)}"]
    if not design.feasible:
        lines.append("INFEASIBLE")
    if not proven(design):
        lines.append("NOT VERIFIED")
    return lines


def _facts(design: Design, size: tuple[float, float], wish: Wish) -> list[str]:
    tube, gauze = design.tube, design.gauze
    turns = f", turns: {gauze.turns}" if wish.variant == "gauze" else ""
    date = "".join(char for char in wish.date if char.isprintable())
    at = design.operate_bar
    held = "" if at is None else f", on object {at:.2f}"
    return [
        f"Tube D {tube.outer_diameter_mm:g}, wall {tube.wall_mm:g}, length "
        f"{short(tube.length_mm)}, clamp {short(design.clamp.length_mm)} mm.  "
        f"Pressure {design.pressure_bar:.2f}{held} bar.  "
        f"Joints: {len(design.joints)}." + (f"  {date[:DATE_CHARS]}" if date else ""),
        f"{KINDS[wish.variant].piece} {short(size[0])} x {short(size[1])} mm, mesh "
        f"{gauze.pitch_mm:g} mm, thread {gauze.thread_mm:g} mm{turns}, seam "
        f"{short(gauze.seam_deg)}°.  Kerf {wish.kerf_mm:g}.",
    ]


def alone(design: Design) -> str:
    """Say that a highest pressure holds for the finger alone, where it works above it."""
    top = design.trim[-1].pressure_bar if design.trim else design.pressure_bar
    at = design.operate_bar
    return "" if at is None or at <= top else " in free air"


def _setting(design: Design) -> Iterator[str]:
    """Return how to set the pressure on the finished actuator, where the design says that."""
    if not design.trim:
        return
    x, y = design.planned.tip_mm
    bar, top = design.pressure_bar, design.trim[-1].pressure_bar
    yield (
        f"Before use: inflate {CYCLES} times to {top:.2f} bar, never more{alone(design)}. Hold "
        f"{bar:.2f} bar for a minute, then set the pressure by the tip (planned: x {x:.1f}, "
        f"y {y:.1f} mm) or the angles: see the report."
    )


def _warnings(design: Design, seam: SeamChoice, wish: Wish) -> list[str]:
    """Return what needs the bench's attention, a sentence each."""
    warnings = []
    if seam.crossed:
        crossing = f"! {_named(seam.crossed)}: cut crosses the"
        if wish.variant == "sleeve":
            warnings.append(f"{crossing} seam line. Its slits go on from edge to edge.")
        else:
            warnings.append(
                f"{crossing} weld line. Its slits run out of the start and the end edge. Keep "
                "glue and weld off the slits."
            )
    if wish.variant == "sleeve" and design.gauze.turns > 1:
        warnings.append(
            f"! One layer where the design has {design.gauze.turns}: half the stiffness lets a "
            "joint bend some 2 % more."
        )
    thread_deg = 360.0 * design.gauze.pitch_mm / (np.pi * design.tube.outer_diameter_mm)
    if seam.margin_deg < thread_deg and wish.variant != "sleeve":
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
