"""The mounting drawing: object, tube and clamp from the side, and the palm to be drilled."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from profiletool.records.design import Design
from profiletool.records.frames import Shape
from profiletool.records.options import in_flags
from profiletool.records.profile import Profile
from profiletool.template.callouts import lettered
from profiletool.template.draughting import no_line_twice
from profiletool.template.drawing import Drawing, extent
from profiletool.template.labels import short
from profiletool.template.mounted import Mounted, mounted_of, mounting_warnings
from profiletool.template.notes import scale_bar, title_block, title_lines, title_of
from profiletool.template.plan_view import plan_view
from profiletool.template.side_view import COLUMN_MM, side_view

TITLE = "Mounting"
LEAST_WIDTH_MM = 150.0
BLOCK_MM = 8.0  # from block to block
_SAME_MM = 1e-6


@dataclass(frozen=True)
class Mounting(Drawing):
    """The mounting drawing, and its two views, for a page each."""

    parts: tuple[Drawing, Drawing]


def mounting_drawing(
    design: Design,
    profile: Profile,
    straight: Shape,
    bent: Shape,
    stretch_pct: tuple[float, float] = (0.0, 100.0),
) -> Mounting:
    """Return the drawing by which a palm is drilled, at true scale.

    Parameters
    ----------
    design : Design
    profile : Profile
        The target, with the object's outline where there is one.
    straight, bent : Shape
        The tube at rest and under pressure, object frame.
    stretch_pct : (float, float)
        Where the profile starts and ends on its side, %.

    Returns
    -------
    Mounting
        mm; the side view in the object frame, the palm's plan below it.
    """
    mounted = mounted_of(design, profile, straight, bent, stretch_pct)
    clamp, palm = mounted.clamp, mounted.palm
    side = side_view(mounted)
    _, bottom, _, _ = extent(side.lines)
    x = palm.origin[0] if palm.on_axis else clamp.start[0]
    place = np.array([x, bottom - BLOCK_MM - COLUMN_MM - palm.half_width_mm])
    plan = plan_view(mounted, place)
    lines = no_line_twice((*plan.lines, *side.lines))
    texts = (*plan.texts, *side.texts)
    called, words = lettered(side.callouts, lines, texts)
    palm_called, palm_words = lettered(plan.callouts, (*lines, *called), (*texts, *words))
    everything = Drawing("", (*lines, *called, *palm_called), (*texts, *words, *palm_words))
    left, low, _, _ = everything.bounds
    bar, name = scale_bar(left, low - BLOCK_MM)
    facts = [*_facts(mounted), *map(_alarm, mounting_warnings(mounted))]
    title = title_of(design, TITLE)
    beside = tuple(line for line in lines if line.points[:, 1].min() >= bottom - _SAME_MM)
    below = tuple(line for line in lines if line.points[:, 1].min() < bottom - _SAME_MM)
    seen = Drawing(title, (*beside, *called), (*side.texts, *words))
    palmed = Drawing(title, (*below, *palm_called, *bar), (*plan.texts, *palm_words, name))

    def headed(*views: Drawing) -> Drawing:
        """Put the views together, under the title block."""
        drawn = tuple(line for view in views for line in view.drawn)
        texts = tuple(text for view in views for text in view.texts)
        left, _, right, high = Drawing(title, drawn, texts).bounds
        frame = left, max(right, left + LEAST_WIDTH_MM), high + BLOCK_MM
        return Drawing(
            title, drawn, (*texts, *title_block(title_lines(design, TITLE), facts, frame))
        )

    whole = headed(seen, palmed)
    # The title stands with the palm: the side view takes a page as it is.
    return Mounting(title, whole.drawn, whole.texts, (seen, headed(palmed)))


def _alarm(warning: str) -> str:
    return f"! {warning[0].upper()}{in_flags(warning[1:])}."


def _facts(mounted: Mounted) -> list[str]:
    tube, clamp = mounted.design.tube, mounted.clamp
    facts = [
        f"Tube D {tube.outer_diameter_mm:g}, wall {tube.wall_mm:g}, length "
        f"{short(tube.length_mm)} mm from x = 0, and {short(clamp.length_mm)} mm in the clamp "
        f"behind it.  Pressure {mounted.design.pressure_bar:.2f} bar.",
        "All measures in mm, 1:1. Black: cut. Blue: drill. Green: mark. Red and grey: for reading.",
    ]
    if mounted.symmetry is not None:
        taken = "Taken for a" if mounted.symmetry.of_revolution else "Not taken for a"
        facts.append(
            f"{taken} body of revolution: the outline differs from its mirror image by "
            f"{100.0 * mounted.symmetry.mismatch:.1f} % of its area."
        )
    return facts
