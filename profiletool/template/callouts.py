"""Words that point at something, lettered where nothing runs through them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely
from shapely import STRtree

from profiletool.records.units import FloatArray
from profiletool.template.draughting import LETTER_MM, geometry_of, runs_on
from profiletool.template.drawing import Line, Text, arrow

# Where the words may stand, seen from what they point at: mm away, deg off the wanted direction.
_AWAY = (7.0, 10.0, 14.0, 19.0, 25.0, 32.0, 40.0, 50.0, 65.0, 85.0, 110.0, 150.0, 250.0, 500.0)
_CLOSE = (3.5, 4.5, 5.5)
_TURNS = (0, 10, -10, 20, -20, 35, -35, 50, -50, 70, -70, 90, -90, 120, -120, 150, -150, 180)
_DEGREE_MM = 0.1  # a degree off the wanted direction weighs as much as this distance
_CROSSED_MM = 4.0  # so does a line that the leader crosses
_LAST_RESORT_MM = 1e3  # and so does a leader through lettering, or along a line
_BESIDE_MM, _ALONG_MM = 0.3, 3.0  # a leader is along a line that it is so close to for so long
_CLEAR_MM, _APART_MM = 0.8, 2.0  # lettering from lines, and from other lettering
_HEAD_MM = 1.5


@dataclass(frozen=True)
class Callout:
    """A few words that point at something.

    Attributes
    ----------
    text : str
    at : (2,) mm
        What they point at.
    toward_deg : float
        Where they had best stand, seen from there, counter-clockwise from x.
    leader : bool
        Whether an arrow leads there; without one they stand close by.
    height : float
        Of the lettering, mm.
    """

    text: str
    at: FloatArray
    toward_deg: float
    leader: bool = True
    height: float = LETTER_MM


@dataclass(frozen=True)
class _Place:
    """One place for a callout's words: its leader runs from ``end``; the least ``cost`` wins."""

    text: Text
    end: FloatArray
    cost: float


def lettered(
    callouts: Iterable[Callout], lines: Sequence[Line], texts: Sequence[Text]
) -> tuple[tuple[Line, ...], tuple[Text, ...]]:
    """Letter callouts where they meet neither ``lines`` nor ``texts`` nor each other."""
    callouts = tuple(callouts)
    paths = [geometry_of(line) for line in lines]
    paths += [shapely.Point(callout.at) for callout in callouts]  # not to be lettered over
    boxes = [shapely.box(*text.box) for text in texts]
    drawn: list[Line] = []
    words: list[Text] = []
    for callout in callouts:
        place = _best(callout, STRtree(paths), STRtree(boxes))
        words.append(place.text)
        boxes.append(shapely.box(*place.text.box))
        if callout.leader:
            drawn += arrow("NOTE", place.end, callout.at, head=_HEAD_MM)
            paths.append(shapely.LineString([place.end, callout.at]))
    return tuple(drawn), tuple(words)


def _best(callout: Callout, paths: STRtree, boxes: STRtree) -> _Place:
    """Return the cheapest clear place; where there is none, the nearest to what is wanted."""
    options = sorted(
        (away + _DEGREE_MM * abs(turn), away, turn)
        for away in (_AWAY if callout.leader else (*_CLOSE, *_AWAY))
        for turn in _TURNS
    )
    best: _Place | None = None
    for cost, away, turn in options:
        if best is not None and best.cost <= cost:
            break  # even with a leader that crosses nothing
        place = _place(callout, away, turn, paths, boxes)
        if place is not None and (best is None or place.cost < best.cost):
            best = place
    if best is None:
        _, away, turn = options[0]
        return _at(callout, away, turn)
    return best


def _place(
    callout: Callout, away: float, turn: float, paths: STRtree, boxes: STRtree
) -> _Place | None:
    """Return a place at some distance and direction, None where the words would not be clear."""
    place = _at(callout, away, turn)
    end, cost = place.end, place.cost
    box = shapely.box(*place.text.box)
    if _near(box, boxes, _APART_MM) or _near(box, paths, _CLEAR_MM):
        return None
    if callout.leader:
        shaft = shapely.LineString([end, callout.at])
        near = paths.geometries.take(paths.query(shaft, "dwithin", distance=_BESIDE_MM))
        cost += _CROSSED_MM * len(near)
        along = any(
            runs_on(shaft, path) or runs_on(shaft, path, _BESIDE_MM, _ALONG_MM) for path in near
        )
        if along or _near(shaft, boxes, _CLEAR_MM):
            cost += _LAST_RESORT_MM
    return replace(place, cost=cost)


def _at(callout: Callout, away: float, turn: float) -> _Place:
    angle = np.radians(callout.toward_deg + turn)
    end = callout.at + away * np.array([np.cos(angle), np.sin(angle)])
    return _Place(_words(callout, end), end, away + _DEGREE_MM * abs(turn))


def _near(what: shapely.Geometry, others: STRtree, within: float) -> bool:
    return bool(others.query(what, "dwithin", distance=within).size)


def _words(callout: Callout, end: FloatArray) -> Text:
    """Return the lettering at a leader's ``end``, on the side away from what it points at."""
    x, y = float(end[0]), float(end[1]) - callout.height / 2
    if not callout.leader:
        return Text("NOTE", callout.text, x, y, callout.height, "centre")
    right = round(x - float(callout.at[0]), 6) >= 0.0
    x += 1.0 if right else -1.0
    return Text("NOTE", callout.text, x, y, callout.height, "left" if right else "right")
