"""The mounting drawing's side view: object, tube, clamp and palm in the object frame."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely

from profiletool.records.frames import Shape
from profiletool.records.profile import Profile
from profiletool.records.units import FloatArray
from profiletool.template.callouts import Callout
from profiletool.template.draughting import (
    CHAIN,
    DASHES,
    dashed,
    dimension,
    geometry_of,
    measure,
    pieces,
    smooth,
)
from profiletool.template.drawing import Box, Line, Text, arrow, circle, extent
from profiletool.template.mounted import PLATE_MM, Mounted, plates_of
from profiletool.template.palm import ClampedTube, Palm

COLUMN_MM = 8.0  # from a view to its dimensions, and from one row of them to the next
_OFF_OUTLINE_MM, _LEAST_OFF_MM = 0.3, 2.0  # the profile is drawn where it is so far off so long
_TICK_MM = 2.0
_PAST_MM = 12.0  # the centre line beyond the clamp
_LENGTH_OFF_MM = PLATE_MM + 4.0  # the clamp's dimension, off the far line
_VIEW_ARROW_MM = (PLATE_MM + 12.0, PLATE_MM + 2.0)  # off the palm's near face, from and to
_VIEW_LETTER_MM = 3.5
_BASE_MM = 0.5  # a base nearer to the datum is lettered only
_LEVEL_DEG = 3.0  # so is a slope below this
_ARC_MM = 15.0


@dataclass(frozen=True)
class View:
    """One view of the drawing, its callouts not lettered yet."""

    lines: tuple[Line, ...]
    texts: tuple[Text, ...]
    callouts: tuple[Callout, ...]


def side_view(mounted: Mounted) -> View:
    """Return the side view in the object frame, with the dimensions around it."""
    shapes = _shapes(mounted)
    lines, texts = _dimensions(mounted, extent(shapes))
    angle, heading = _slope(mounted)
    view_arrow, letter = _view_arrow(mounted.palm)
    return View(
        (*shapes, *_clamp_dimensions(mounted.clamp), *lines, *angle, *view_arrow),
        texts,
        (letter, *_callouts(mounted), heading),
    )


def _shapes(mounted: Mounted) -> tuple[Line, ...]:
    """Return all but dimensions; of lines that run on each other the first one is to stay."""
    clamp, profile = mounted.clamp, mounted.profile
    middle, length = clamp.diameter_mm / 2, clamp.length_mm
    x, y = clamp.edge.tolist()
    axis = np.array([clamp.at(-_PAST_MM, middle), clamp.at(length + _PAST_MM, middle)])
    return (
        Line("MARK", clamp.ring, closed=True),
        circle("MARK", x, y, 1.0),
        *(Line("REF", plate, closed=True) for plate in plates_of(mounted.palm)),
        smooth("REF", mounted.body, closed=profile.outline is not None),
        smooth("REF", _around(mounted.bent)),
        *dashed("REF", _around(mounted.straight), DASHES),
        _profile_end(profile),
        *(smooth("NOTE", piece) for piece in _off_outline(profile)),
        *dashed("MARK", axis, CHAIN),
        *_object_axis(mounted),
    )


def _around(shape: Shape) -> FloatArray:
    """Return a tube's outline from the clamp around its closed end, (N, 2)."""
    return np.concatenate([shape.facing, shape.far[::-1]])


def _profile_end(profile: Profile) -> Line:
    heading = profile.heading[-1]
    across = _TICK_MM * np.array([-np.sin(heading), np.cos(heading)])
    return Line("NOTE", profile.points[-1] + np.array([across, -across]))


def _off_outline(profile: Profile) -> list[FloatArray]:
    """Return the stretches of the profile that do not run along the outline, (N, 2) each."""
    if profile.outline is None:
        return []
    ring = geometry_of(Line("REF", profile.outline, closed=True)).buffer(_OFF_OUTLINE_MM)
    return pieces(shapely.LineString(profile.points).difference(ring), _LEAST_OFF_MM)


def _object_axis(mounted: Mounted) -> tuple[Line, ...]:
    symmetry = mounted.symmetry
    if symmetry is None or not symmetry.of_revolution:
        return ()
    heights = np.concatenate([mounted.body, *plates_of(mounted.palm)])[:, 1]
    ends = [heights.min() - _TICK_MM, heights.max() + _TICK_MM]
    return dashed("REF", np.array([[symmetry.axis_x_mm, y] for y in ends]), CHAIN)


def _clamp_dimensions(clamp: ClampedTube) -> tuple[Line, ...]:
    """Return the dimension lines of clamp and tube, to be lettered by callouts."""
    across = clamp.diameter_mm
    near, end = clamp.at(0.0, across), clamp.at(clamp.length_mm, across)
    return (
        *measure(near, end, _LENGTH_OFF_MM * clamp.outward),
        *measure(clamp.at(0.0, 0.0), near, -COLUMN_MM * clamp.along),
    )


def _dimensions(mounted: Mounted, box: Box) -> tuple[tuple[Line, ...], tuple[Text, ...]]:
    """Return the object's size and the base's place, outside ``box``."""
    x0, y0, x1, y1 = box
    body, base, datum = mounted.body, mounted.clamp.edge, mounted.datum
    left, low = (body[k] for k in body.argmin(axis=0))
    right, high = (body[k] for k in body.argmax(axis=0))
    # Upright ones stand where no tube is.
    free, way = (x1, 1.0) if mounted.clamp.side < 0 else (x0, -1.0)
    parts = [
        dimension(left, right, y0 - COLUMN_MM, what="width "),
        dimension(low, high, free + 2 * way * COLUMN_MM, upright=True, what="height "),
    ]
    dx, dy = np.abs(base - datum)
    if dx >= _BASE_MM:
        top = y1 + 2 * COLUMN_MM
        parts.append(dimension(datum, base, top, what="base x ", backward=way < 0.0))
    if dy >= _BASE_MM:
        parts.append(dimension(datum, base, free + way * COLUMN_MM, upright=True, what="base y "))
    return (
        tuple(line for lines, _ in parts for line in lines),
        tuple(text for _, texts in parts for text in texts),
    )


def _slope(mounted: Mounted) -> tuple[tuple[Line, ...], Callout]:
    """Return the angle between the clamped tube and the horizontal, drawn where it is one."""
    clamp, slope = mounted.clamp, mounted.clamp.slope_deg
    heading = f"heading {mounted.design.base_pose.heading_deg:.1f}°"
    middle = clamp.diameter_mm / 2
    if abs(slope) < _LEVEL_DEG:
        way = "below" if slope > 0 else "above"
        level = "horizontal" if round(slope, 1) == 0.0 else f"{abs(slope):.1f}° {way} horizontal"
        return (), Callout(f"{heading}: {level}", clamp.at(-_PAST_MM, middle), _deg(-clamp.along))
    vertex = clamp.at(0.0, middle)
    turns = np.radians(np.linspace(0.0, slope, 2 + int(abs(slope) / 2.0)))
    arc = vertex + _ARC_MM * np.column_stack([clamp.side * np.cos(turns), -np.sin(turns)])
    level = vertex + np.array([clamp.side * (_ARC_MM + _TICK_MM), 0.0])
    words = f"{abs(slope):.1f}° to the horizontal ({heading})"
    lines = Line("NOTE", arc), Line("NOTE", np.array([vertex, level]))
    return lines, Callout(words, arc[len(arc) // 2], _deg(clamp.outward))


def _view_arrow(palm: Palm) -> tuple[tuple[Line, ...], Callout]:
    """Return the arrow along which the plan is seen."""
    # Beside the palm, where no dimension runs.
    tail, tip = (palm.at(palm.reach_mm[1] + 2 * _TICK_MM, off) for off in _VIEW_ARROW_MM)
    letter = Callout("A", tail, _deg(palm.normal), leader=False, height=_VIEW_LETTER_MM)
    return arrow("NOTE", tail, tip), letter


def _callouts(mounted: Mounted) -> tuple[Callout, ...]:
    clamp, bent = mounted.clamp, mounted.bent
    across, base = clamp.diameter_mm, clamp.edge
    free, outward, backward = (
        _deg(way) for way in ([-clamp.side, 0.0], clamp.outward, -clamp.along)
    )
    at_rest = mounted.straight.far[-len(mounted.straight.far) // 4]
    found = [
        Callout(
            f"clamp {clamp.length_mm:.1f}",
            clamp.at(clamp.length_mm / 2, across + _LENGTH_OFF_MM),
            outward,
        ),
        Callout(f"tube D {across:.1f}", clamp.at(-COLUMN_MM, 0.7 * across), backward),
        Callout(
            f"base point: x {_number(base[0])}, y {_number(base[1])}",
            base,
            free + 20.0 * clamp.side,
        ),
        Callout("x = 0: edge of the clamp", clamp.at(clamp.length_mm, 0.8 * across), outward),
        Callout("air fitting here: keep clear", clamp.at(0.0, 0.3 * across), backward),
        Callout(
            f"tube at {mounted.design.pressure_bar:.2f} bar",
            bent.far[len(bent.far) // 2],
            180.0 - free,
        ),
        Callout("tube at rest", at_rest, outward),
        Callout("profile ends", mounted.profile.points[-1], 180.0 - free),
    ]
    beside = max(_off_outline(mounted.profile), key=len, default=None)
    if beside is not None:
        found.append(Callout("profile", beside[len(beside) // 2], 180.0 - free))
    return tuple(found)


def _deg(way: FloatArray | list[float]) -> float:
    """Return the direction of a vector (2,), counter-clockwise from x."""
    return float(np.degrees(np.arctan2(way[1], way[0])))


def _number(value: float) -> str:
    return f"{round(float(value), 1) + 0.0:.1f}"
