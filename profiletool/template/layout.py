"""A design to its cut template: the piece in the middle, its marks around it, then the notes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from profiletool.joints.roll import roll_of
from profiletool.joints.windows import SeamChoice, seam_at
from profiletool.records.design import Design, Joint
from profiletool.records.units import FloatArray
from profiletool.template.drawing import Box, Drawing, Line
from profiletool.template.kerf import check_kerf, outline_path, slit_paths
from profiletool.template.kinds import KINDS, PLAIN, Wish
from profiletool.template.labels import joint_labels
from profiletool.template.margins import LEFT_MM, RIGHT_MM, gaps, margins
from profiletool.template.notes import notes, title_of
from profiletool.template.unroll import Slit, slits

NOTCH_MM = 3.0
LEAST_NOTCH_MM = 0.5
PAGE_MM = 196.0  # width of the notes: with margins that of a page
BLOCK_MM = 6.0  # from the marks to the notes


@dataclass(frozen=True)
class Sheet:
    """A cut template: x along the tube, y up along the roll.

    Attributes
    ----------
    drawing : Drawing
        All of it; its CUT_INNER lines are the slits, joint by joint, row by row, along the roll.
    parts : (Drawing, Drawing)
        The piece with its marks, and the notes, for a page each.
    size_mm : (float, float)
        The piece: along the tube, along the roll.
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
    size = tube.length_mm, roll.length_mm
    seam = seam_at(design.joints, gauze.seam_deg)
    cuts = slits(design.joints, tube, gauze, wish.variant)
    notch = _notch(design.joints, size[0])
    outline = _outline((size[0], size[1] + kind.tab_mm), notch)
    around = margins(design.joints, size[0], roll, kind, seam)
    title = title_of(design, kind.title)
    paths = slit_paths(cuts, size[1], wish.kerf_mm)
    piece = Drawing(
        title,
        (
            Line("CUT_OUTER", outline_path(outline, wish.kerf_mm), closed=True),
            *paths,
            *around.lines,
        ),
        (*joint_labels(design, roll, cuts, _barred(size, notch)), *around.texts),
    )
    right = max(size[0] + RIGHT_MM, PAGE_MM - LEFT_MM)
    top = size[1] + kind.tab_mm + around.above_mm + BLOCK_MM
    told = design, size, seam, wish, len(cuts) - len(paths)
    beside = notes(*told, (-LEFT_MM, right, top, -around.below_mm - BLOCK_MM))
    alone = notes(*told, (0.0, PAGE_MM, 0.0, -BLOCK_MM))
    return Sheet(
        Drawing(title, piece.drawn + beside.drawn, piece.texts + beside.texts),
        (piece, alone),
        size,
        outline,
        cuts,
        seam,
    )


def _notch(joints: Sequence[Joint], length: float) -> Box | None:
    """Return the box of the notch in the start edge: in the root, else in the widest gap."""
    room = [gap for gap in gaps(joints, length, 0.0) if _notch_width(gap) >= LEAST_NOTCH_MM]
    if not room:
        return None
    a, b = room[0] if room[0][0] == 0 else max(room, key=lambda gap: gap[1] - gap[0])
    half = _notch_width((a, b)) / 2
    return (a + b) / 2 - half, 0.0, (a + b) / 2 + half, 2 * half


def _barred(size: tuple[float, float], notch: Box | None) -> list[Box]:
    """Return where no label may stand: beyond the ends of the tube, and the notch."""
    length, roll = size
    beyond = [(-math.inf, 0.0, 0.0, roll), (length, 0.0, math.inf, roll)]
    return [*beyond, notch] if notch else beyond


def _notch_width(gap: tuple[float, float]) -> float:
    return min(NOTCH_MM, (gap[1] - gap[0]) / 2)


def _outline(size: tuple[float, float], notch: Box | None) -> FloatArray:
    """Return the outline (N, 2) mm, counter-clockwise, with the notch in its start edge."""
    length, roll = size
    corners = [[0.0, 0.0], [length, 0.0], [length, roll], [0.0, roll]]
    if notch:
        x0, _, x1, depth = notch
        corners[1:1] = [[x0, 0.0], [(x0 + x1) / 2, depth], [x1, 0.0]]
    return np.array(corners)
