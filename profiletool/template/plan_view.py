"""The mounting drawing's plan: the palm with what is drilled into it, true size."""

from __future__ import annotations

import numpy as np
import shapely

from profiletool.records.units import FloatArray
from profiletool.template.callouts import Callout
from profiletool.template.draughting import CHAIN, LETTER_MM, dashed, dimension
from profiletool.template.drawing import Line, Text, circle, polyline, wrapped
from profiletool.template.mounted import Mounted
from profiletool.template.palm import HOLE_MM, Palm
from profiletool.template.side_view import COLUMN_MM, View

WORDS_MM = 84.0  # width of the column beside the plan
_HEAD_MM = 3.5
_LEADING_MM = 4.4
_HOLE_ARM_MM, _ORIGIN_ARM_MM = 2.8, 4.0  # of crosses
_PAST_MM = 5.0  # centre lines beyond clamps and palm


def plan_view(mounted: Mounted, place: FloatArray) -> View:
    """Return the plan with its origin at ``place``, (2,) mm, its dimensions and its words."""
    palm = mounted.palm
    out = 1.0 if palm.turns_deg[0] == 0.0 else -1.0
    hole, twin = sorted((palm.holes[:2] + place).tolist(), key=lambda point: point[1])
    beyond = float(place[0]) + out * (_reach(palm) + COLUMN_MM)
    below = float(place[1]) - palm.half_width_mm - COLUMN_MM
    spread = dimension(np.array(hole), np.array(twin), beyond, upright=True)
    away = dimension(place, np.array(hole), below, what="0 to screws ", backward=out > 0.0)
    column = beyond + out * COLUMN_MM
    words = _words(mounted, column if out > 0 else column - WORDS_MM, place)
    return View(
        (*_cuts(palm, place), *_marks(palm, place), *spread[0], *away[0]),
        (*spread[1], *away[1], *words),
        _callouts(palm, place),
    )


def _reach(palm: Palm) -> float:
    """Return the r at which finger 1's centre line ends: beyond palm, clamp and origin."""
    return max(palm.reach_mm[1], palm.span_mm[1], 0.0) + _PAST_MM


def _cuts(palm: Palm, place: FloatArray) -> tuple[Line, ...]:
    """Return the palm's outline, its holes, and its opening."""
    x, y = place.tolist()
    if palm.fingers > 1:
        outline = circle("CUT_OUTER", x, y, palm.radius_mm)
    else:
        (low, high), half = palm.reach_mm, palm.half_width_mm
        ring = palm.in_plan(0, (low, -half), (high, -half), (high, half), (low, half))
        outline = Line("CUT_OUTER", place + ring, closed=True)
    holes = [circle("CUT_INNER", x + dx, y + dy, HOLE_MM / 2) for dx, dy in palm.holes.tolist()]
    opening = [circle("CUT_INNER", x, y, palm.opening_mm)] if palm.opening_mm else []
    return (outline, *holes, *opening)


def _marks(palm: Palm, place: FloatArray) -> tuple[Line, ...]:
    """Return clamps, crosses and the tubes' middles."""
    ends = (palm.span_mm[0] - _PAST_MM, 0.0), (_reach(palm), 0.0)
    middles = (palm.in_plan(k, *ends) + place for k in range(palm.fingers))
    return (
        *(Line("MARK", ring + place, closed=True) for ring in palm.clamps),
        *_cross(place, _ORIGIN_ARM_MM),
        *(line for hole in palm.holes + place for line in _cross(hole, _HOLE_ARM_MM)),
        *(line for at in _fittings(palm) + place for line in _cross(at, _HOLE_ARM_MM)),
        *(line for middle in middles for line in dashed("MARK", middle, CHAIN)),
    )


def _fittings(palm: Palm) -> FloatArray:
    """Return where air fittings run into the palm, (N, 2) mm in the plan."""
    r = palm.fitting_mm
    found = [palm.in_plan(k, (r, 0.0))[0] for k in range(palm.fingers) if r is not None]
    return np.array(found).reshape(-1, 2)


def _cross(at: FloatArray, arm: float) -> tuple[Line, Line]:
    x, y = at.tolist()
    return (
        polyline("MARK", (x - arm, y), (x + arm, y)),
        polyline("MARK", (x, y - arm), (x, y + arm)),
    )


def _callouts(palm: Palm, place: FloatArray) -> tuple[Callout, ...]:
    back = 180.0 - palm.turns_deg[0]
    numbers = []
    for k, hole in enumerate(palm.holes):
        x, y = hole - palm.in_plan(k // 2, (palm.saddle_mm, 0.0))[0]
        away = float(np.degrees(np.arctan2(y, x)))
        numbers.append(Callout(str(k + 1), hole + place, away, leader=False))
    end = palm.in_plan(0, (palm.span_mm[0], -0.3 * palm.diameter_mm))[0] + place
    zero = "0: object's axis" if palm.on_axis else "0: middle of the tube's open end"
    return (
        *numbers,
        Callout(zero, place, back - 30.0),
        Callout("open end, air fitting", end, back + 30.0),
    )


def _words(mounted: Mounted, left: float, place: FloatArray) -> tuple[Text, ...]:
    """Return what is to be known of the palm, in a column from ``left`` on."""
    palm = mounted.palm
    y = float(place[1]) + palm.half_width_mm - _HEAD_MM
    texts = [Text("NOTE", "View A: palm, true size", left, y, _HEAD_MM)]
    for fact in (*_facts(mounted), *_table(palm)):
        for row in wrapped(fact, LETTER_MM, WORDS_MM):
            y -= _LEADING_MM
            texts.append(Text("NOTE", row, left, y - 1.0, LETTER_MM))
    return tuple(texts)


def _facts(mounted: Mounted) -> list[str]:
    palm, design = mounted.palm, mounted.design
    bore = design.tube.outer_diameter_mm + 2 * design.gauze.turns * design.gauze.thread_mm
    facts = ["Tubes lie behind the plate. Its lower edge is the near one in the side view."]
    if palm.fingers > 1:
        low, high = palm.span_mm
        facts += [
            f"{palm.fingers} fingers, {360 // palm.fingers}° apart, clamped from r = {low:.1f} to "
            f"{high:.1f}. Base points (x = 0): r = {palm.base_mm:.1f}.",
            f"Palm: disc of diameter {2 * palm.radius_mm:.0f}.",
        ]
        if palm.opening_mm:
            facts.append(f"The object reaches through: opening of {2 * palm.opening_mm:.1f}.")
    else:
        end = "right" if palm.turns_deg[0] == 0.0 else "left"
        edges = palm.in_plan(0, *((r, 0.0) for r in palm.reach_mm))[:, 0]
        facts.append(
            f"Palm: x from {edges.min():.1f} to {edges.max():.1f}, {2 * palm.half_width_mm:.0f} "
            f"across. The tube's closed end lies to the {end}."
        )
    return [
        *facts,
        f"Saddle over each clamp: bore {bore:g} (tube and gauze), two M3 screws. Between "
        f"clamp and object {_strap_room(mounted):.1f} mm are free for its strap.",
        f"{len(palm.holes)} holes of diameter {HOLE_MM:g}, from 0 to the right and up:",
    ]


def _strap_room(mounted: Mounted) -> float:
    """Return how far the object is from the middle of the clamp, mm."""
    clamp = mounted.clamp
    under = shapely.Point(clamp.at(clamp.length_mm / 2, 0.0))
    outline = mounted.profile.outline
    body = shapely.LineString(mounted.body) if outline is None else shapely.Polygon(outline)
    return float(under.distance(body))


def _table(palm: Palm) -> list[str]:
    places = (np.round(palm.holes, 1) + 0.0).tolist()
    return [f"{k}:  x {x:.1f},  y {y:.1f}" for k, (x, y) in enumerate(places, start=1)]
