"""The mounting drawing: object, tube and clamp from the side, and the palm to be drilled."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely

from profiletool.profile.symmetry import symmetry_of
from profiletool.records.design import Design
from profiletool.records.frames import Shape
from profiletool.records.options import FLAGS
from profiletool.records.profile import Profile
from profiletool.records.units import FloatArray
from profiletool.template.callouts import lettered
from profiletool.template.draughting import no_line_twice
from profiletool.template.drawing import Drawing, extent
from profiletool.template.fingers import LEAST_CLAMP_MM, clamp_of, obstacle, palm_of
from profiletool.template.labels import short
from profiletool.template.notes import scale_bar, title_block, title_lines, title_of
from profiletool.template.plan_view import plan_view
from profiletool.template.side_view import COLUMN_MM, Mounted, plates_of, side_view

TITLE = "Mounting"
LEAST_WIDTH_MM = 150.0
BLOCK_MM = 8.0  # from block to block
_INCLINED_DEG = 0.5  # clamps less inclined than this lie on the palm
_SAME_MM = 1e-6
_OVERLAP_MM2 = 1.0  # what shapes that only touch may share


@dataclass(frozen=True)
class Mounting(Drawing):
    """The mounting drawing, and its two views, for a page each."""

    parts: tuple[Drawing, Drawing]


def mounting_drawing(design: Design, profile: Profile, straight: Shape, bent: Shape) -> Mounting:
    """Return the drawing by which a palm is drilled, at true scale.

    Parameters
    ----------
    design : Design
    profile : Profile
        The target, with the object's outline where there is one.
    straight, bent : Shape
        The tube at rest and under pressure, object frame.

    Returns
    -------
    Mounting
        mm; the side view in the object frame, the palm's plan below it.

    Raises
    ------
    ValueError
        The first joint's cut leaves no root to clamp.
    """
    clamp = clamp_of(design, profile, straight)
    outline = profile.outline
    symmetry = None if outline is None else symmetry_of(outline)
    palm = palm_of(clamp, outline, symmetry)
    mounted = Mounted(design, profile, straight, bent, symmetry, clamp, palm)
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
    facts = [*_facts(mounted), *(f"! {warning}" for warning in _warnings(mounted))]
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


def _facts(mounted: Mounted) -> list[str]:
    tube, clamp = mounted.design.tube, mounted.clamp
    facts = [
        f"Tube D {tube.outer_diameter_mm:g}, wall {tube.wall_mm:g}, length "
        f"{short(tube.length_mm)} mm.  Clamp {short(clamp.length_mm)} of the root's "
        f"{short(tube.root_mm)} mm.  Pressure {mounted.design.pressure_bar:.2f} bar.",
        "All measures in mm, 1:1. Black: cut. Blue: drill. Green: mark. Red and grey: for reading.",
    ]
    if mounted.symmetry is not None:
        taken = "Taken for a" if mounted.symmetry.of_revolution else "Not taken for a"
        facts.append(
            f"{taken} body of revolution: the outline differs from its mirror image by "
            f"{100.0 * mounted.symmetry.mismatch:.1f} % of its area."
        )
    return facts


def _warnings(mounted: Mounted) -> list[str]:
    """Return what needs the bench's attention, a sentence or two each."""
    clamp, palm = mounted.clamp, mounted.palm
    found = []
    outline, symmetry = mounted.profile.outline, mounted.symmetry
    if outline is not None and symmetry is not None and symmetry.of_revolution and palm.fingers < 3:
        found.append(_fewer_fingers(mounted, outline, symmetry.axis_x_mm))
    if palm.cut_off_mm:
        found.append(
            f"Cut each root {short(palm.cut_off_mm)} mm shorter at its clamped end, tube and "
            f"gauze, or the fingers meet: clamp length left {short(palm.held_mm)} mm."
        )
    if palm.held_mm < LEAST_CLAMP_MM:
        found.append(
            f"The clamp is short: {short(palm.held_mm)} mm where a saddle with M3 screws needs "
            f"{LEAST_CLAMP_MM:g} mm."
        )
    if palm.fingers > 1 and abs(clamp.slope_deg) >= _INCLINED_DEG:
        found.append(
            f"The clamps are inclined {abs(clamp.slope_deg):.1f}° to the palm: set each on a wedge "
            "of that angle. The plan shows them projected."
        )
    if _in_the_way(mounted):
        found.append("The tube under pressure runs into the palm: cut the palm away there.")
    return found


def _fewer_fingers(mounted: Mounted, outline: FloatArray, axis: float) -> str:
    """Return why there are no three fingers."""
    why = obstacle(mounted.clamp, axis, 3, outline)
    laid = "One is" if mounted.palm.fingers == 1 else "Two opposite ones are"
    return (
        f"Three fingers cannot share a palm: {why}. {laid} laid out. Fingers that start elsewhere "
        f"({FLAGS['start_pct']}) may find room."
    )


def _in_the_way(mounted: Mounted) -> bool:
    """Tell whether the tube under pressure needs room where the palm is."""
    bent = mounted.bent
    tube = shapely.Polygon(np.concatenate([bent.facing, bent.far[::-1]])).buffer(0.0)
    plates = map(shapely.Polygon, plates_of(mounted.palm))
    return any(tube.intersection(plate).area > _OVERLAP_MM2 for plate in plates)
