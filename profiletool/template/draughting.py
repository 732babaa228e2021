"""Elements of a technical drawing: dashes, chain lines, dimensions; no line drawn twice."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import cycle

import numpy as np
import shapely
from shapely.ops import linemerge, substring

from profiletool.records.units import FloatArray
from profiletool.template.drawing import FLATTENING_MM, Anchor, LayerName, Line, Text, arrow

DASHES = (3.0, 1.5)
CHAIN = (8.0, 1.5, 1.5, 1.5)
LETTER_MM = 2.5
ON_EACH_OTHER_MM = 2e-5  # lines that differ by rounding only
_CROSSING_MM = 1e-3  # lines that merely cross share less, but for angles below 2 deg
_DOT_MM = 0.05  # shorter strokes are left out
_GAP_MM, _BEYOND_MM = 1.0, 1.5  # of extension lines: after the point, beyond the dimension line
_OUTSIDE_MM = 6.0  # shafts of arrows that find no room between the extension lines
_HEADS_MM = 8.0  # room for both heads
_OFF_LINE_MM = 1.4  # lettering off its line


def dashed(layer: LayerName, points: FloatArray, pattern: Sequence[float]) -> tuple[Line, ...]:
    """Return a line through ``points`` (N, 2) as strokes: lengths on, off, on, ... in mm."""
    whole = shapely.LineString(points)
    strokes: list[Line] = []
    at = 0.0
    for k, length in enumerate(cycle(pattern)):
        end = min(at + length, whole.length)
        if k % 2 == 0 and end - at > _DOT_MM:
            strokes.append(Line(layer, _thinned(substring(whole, at, end))))
        if end >= whole.length:
            break
        at = end
    return tuple(strokes)


def smooth(layer: LayerName, points: FloatArray, closed: bool = False) -> Line:
    """Return a line with no more points than its flatness asks for."""
    found = _thinned(geometry_of(Line(layer, points, closed)))
    return Line(layer, found[:-1] if closed else found, closed)


def measure(a: FloatArray, b: FloatArray, away: FloatArray) -> tuple[Line, ...]:
    """Return a dimension line from ``a`` to ``b``, moved ``away`` from them, (2,) mm each.

    It runs square to ``away``; the extension lines bridge what ``b`` lies farther off than ``a``.
    """
    out = away / np.hypot(*away)
    start, end = a + away, b + away
    end = end - out * ((end - start) @ out)
    lines = [
        Line("NOTE", np.array([point + _GAP_MM * way, foot + _BEYOND_MM * way]))
        for point, foot in ((a, start), (b, end))
        for way in (np.sign((foot - point) @ out) * out,)
        if np.hypot(*(foot - point)) > _GAP_MM
    ]
    length = float(np.hypot(*(end - start)))
    if length >= _HEADS_MM:
        return (*lines, *arrow("NOTE", start, end, both=True))
    shaft = (end - start) / length * _OUTSIDE_MM
    outside = (*arrow("NOTE", start - shaft, start), *arrow("NOTE", end + shaft, end))
    return (*lines, Line("NOTE", np.array([start, end])), *outside)


def dimension(
    a: FloatArray,
    b: FloatArray,
    at: float,
    upright: bool = False,
    what: str = "",
    backward: bool = False,
) -> tuple[tuple[Line, ...], tuple[Text, ...]]:
    """Return a lettered dimension along x, or along y where ``upright``.

    Parameters
    ----------
    a, b : (2,) array, mm
    at : float, mm
        Where the dimension line runs, on the other axis.
    upright : bool
    what : str
        Goes before the number.
    backward : bool
        Lettering that finds no room on the line stands before it instead of after it.

    Returns
    -------
    lines, texts
        None where the two are not apart by a tenth of a millimetre.
    """
    u, v = (1, 0) if upright else (0, 1)
    low, high = sorted((a, b), key=lambda point: float(point[u]))
    length = float(high[u] - low[u])
    if round(length, 1) == 0.0:
        return (), ()
    away = np.zeros(2)
    away[v] = at - low[v]
    lines = measure(low, high, away)
    text = f"{what}{length:.1f}"
    along, lift = float(low[u] + high[u]) / 2, _OFF_LINE_MM
    anchor: Anchor = "centre"
    if Text("NOTE", text, 0.0, 0.0, LETTER_MM).width + 2 * _OFF_LINE_MM > length:
        # Beyond the line's end, held at its middle.
        off = _OFF_LINE_MM + (_OUTSIDE_MM if length < _HEADS_MM else 0.0)
        along, anchor = (low[u] - off, "right") if backward else (high[u] + off, "left")
        lift = -LETTER_MM / 2
    if upright:
        return lines, (Text("NOTE", text, at - lift, along, LETTER_MM, anchor, upward=True),)
    return lines, (Text("NOTE", text, along, at + lift, LETTER_MM, anchor),)


def no_line_twice(lines: Iterable[Line]) -> tuple[Line, ...]:
    """Return ``lines`` without what runs on a line before it.

    A closed line of which a part is taken becomes open ones.
    """
    kept: list[tuple[Line, shapely.LineString]] = []
    for line in lines:
        whole = left = geometry_of(line)
        for _, other in kept:
            if runs_on(left, other):
                left = left.difference(_cover(other))
        found = [line] if left is whole else [Line(line.layer, part) for part in pieces(left)]
        kept += [(part, geometry_of(part)) for part in found]
    return tuple(line for line, _ in kept)


def runs_on(
    line: shapely.Geometry,
    other: shapely.Geometry,
    within: float = ON_EACH_OTHER_MM,
    least: float = _CROSSING_MM,
) -> bool:
    """Tell whether a line keeps ``within`` another one for longer than ``least``, mm.

    As given, for longer than where they merely cross.
    """
    if line.distance(other) > within:
        return False
    return bool(line.intersection(_cover(other, within)).length > least)


def geometry_of(line: Line) -> shapely.LineString:
    """Return a line as shapely knows it, a closed one as a ring."""
    return shapely.LinearRing(line.points) if line.closed else shapely.LineString(line.points)


def pieces(found: shapely.Geometry, least: float = _DOT_MM) -> list[FloatArray]:
    """Return the lines of a geometry, (N, 2) each, joined end to end; none up to ``least`` mm."""
    lines = shapely.get_parts(found)
    joined = linemerge(list(lines)) if len(lines) > 1 else found
    parts = [part for part in shapely.get_parts(joined) if part.length > least]
    return [np.asarray(shapely.get_coordinates(part)) for part in parts]


def _cover(line: shapely.Geometry, within: float = ON_EACH_OTHER_MM) -> shapely.Geometry:
    return line.buffer(within, cap_style="flat")


def _thinned(line: shapely.LineString) -> FloatArray:
    return np.asarray(shapely.get_coordinates(line.simplify(FLATTENING_MM)))
