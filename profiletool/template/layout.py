"""A design to its cut template: the piece in the middle, its marks around it, then the notes."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from profiletool.joints.roll import roll_of
from profiletool.joints.windows import SeamChoice, seam_at
from profiletool.records.design import Design
from profiletool.records.units import FloatArray
from profiletool.template.drawing import Box, Drawing, Line
from profiletool.template.kerf import check_kerf, outline_path, slit_paths
from profiletool.template.kinds import KINDS, PLAIN, Wish
from profiletool.template.labels import joint_labels
from profiletool.template.margins import LEFT_MM, NOTCH_MM, RIGHT_MM, margins
from profiletool.template.notes import notes, title_of
from profiletool.template.unroll import Slit, sheet_size, slits

PAGE_MM = 196.0  # width of the notes: with margins that of a page
BLOCK_MM = 6.0  # from the marks to the notes


@dataclass(frozen=True)
class Sheet:
    """A cut template: x along the tube from the clamp's edge, y up along the roll.

    Attributes
    ----------
    drawing : Drawing
        All of it; its CUT_INNER lines are the slits, joint by joint, row by row, along the roll.
    parts : (Drawing, Drawing)
        The piece with its marks, and the notes, for a page each.
    size_mm : (float, float)
        The piece: along the tube from the open end to the closed one, along the roll.
    outline : (N, 2) float
        Its closed outline, first point not repeated, counter-clockwise.
    slits : tuple of Slit
    seam : SeamChoice
        The weld line and what it crosses.
    """

    drawing: Drawing
    parts: tuple[Drawing, Drawing]
    size_mm: tuple[float, float]
    outline: FloatArray
    slits: tuple[Slit, ...]
    seam: SeamChoice


def build_sheet(design: Design, wish: Wish = PLAIN) -> Sheet:
    """Return a template of ``design``, its seam where the design puts it.

    Raises
    ------
    ValueError
        The gauze makes no turn, the mesh has no pitch, the tube no length, an alpha is outside
        0..360 deg, or the kerf would burn into the hoop threads.
    """
    tube, gauze = design.tube, design.gauze
    if gauze.turns < 1 or tube.length_mm <= 0:
        raise ValueError("a template needs a tube of some length and at least one turn of gauze")
    check_kerf(wish.kerf_mm, gauze.pitch_mm, gauze.thread_mm)
    kind, roll = KINDS[wish.variant], roll_of(tube, gauze, wish.variant)
    size = sheet_size(design, wish.variant)
    ends = design.clamp.open_end_mm, tube.length_mm
    seam = seam_at(design.joints, gauze.seam_deg)
    cuts = slits(design.joints, tube, gauze, wish.variant)
    outline = _outline(ends, size[1] + kind.tab_mm)
    around = margins(design.joints, ends, roll, kind, seam)
    title = title_of(design, kind.title)
    paths = slit_paths(cuts, size[1], wish.kerf_mm)
    piece = Drawing(
        title,
        (
            Line("CUT_OUTER", outline_path(outline, wish.kerf_mm), closed=True),
            *paths,
            *around.lines,
        ),
        (*joint_labels(design, roll, cuts, _barred(tube.length_mm, size[1])), *around.texts),
    )
    left = ends[0] - LEFT_MM
    right = max(ends[1] + RIGHT_MM, left + PAGE_MM)
    top = size[1] + kind.tab_mm + around.above_mm + BLOCK_MM
    told = design, size, seam, wish, len(cuts) - len(paths)
    beside = notes(*told, (left, right, top, -around.below_mm - BLOCK_MM))
    alone = notes(*told, (0.0, PAGE_MM, 0.0, -BLOCK_MM))
    return Sheet(
        Drawing(title, piece.drawn + beside.drawn, piece.texts + beside.texts),
        (piece, alone),
        size,
        outline,
        cuts,
        seam,
    )


def _barred(length: float, roll: float) -> list[Box]:
    """Return where no label may stand: in the clamp, and beyond the closed end."""
    return [(-math.inf, 0.0, 0.0, roll), (length, 0.0, math.inf, roll)]


def _outline(ends: tuple[float, float], roll: float) -> FloatArray:
    """Return the outline (N, 2) mm, counter-clockwise, with a notch in its start edge.

    The notch lies in the clamp, where it weakens nothing; its straight side is x = 0.
    """
    (open_end, closed), n = ends, NOTCH_MM
    notch = [[-n, 0.0], [0.0, n], [0.0, 0.0]]
    return np.array([[open_end, 0.0], *notch, [closed, 0.0], [closed, roll], [open_end, roll]])
