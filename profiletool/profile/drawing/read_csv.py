"""Profiles as text: x and y, y up, one point a line."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from profiletool.errors import UnreadableInput
from profiletool.files.columns import NUMBER, comments, read_lines, shown
from profiletool.profile.drawing.chain import MAX_POINTS, clean
from profiletool.profile.drawing.drawn import Drawn, placed
from profiletool.records.profile import DrawnUnit
from profiletool.records.units import MM_PER

_NOT_FINITE = re.compile(r"[+-]?(?:nan|inf|infinity)", re.IGNORECASE)
_WORDS = re.compile(r"[a-zµμ]+|[\"″]")
_BRACKETS = re.compile(r"[\[(](.*?)[\])]|/\s*([a-zµμ]+)\s*$")
_NAMES = re.compile(r"[^\s,;\[(]+(?:\s*[\[(][^\])]*[\])])?")  # in a comment
_UNITS = re.compile(r"\bunits?\b\W*(?:in|are|is|of)?\W*([a-zµμ]+)")  # anywhere before the points
_PIXELS = ("px", "pixel", "pixels")
MAX_HEADER = 20  # lines of words before the first point


def read_csv(data: bytes) -> Drawn:
    """Read points from text.

    Parameters
    ----------
    data : bytes
        Text as `profiletool.files.columns.read_lines` takes it. Lines of words before the first
        point are a header: it may name the columns x and y, in any order and among others, and
        their unit, in the names or in a line of its own.

    Returns
    -------
    Drawn
        One chain, y up, closed where the last point meets the first; in mm where the header
        names no unit.

    Raises
    ------
    UnreadableInput
        A line does not hold two finite numbers, or there are too few or too many points.
    """
    if data.count(b"\n") + data.count(b"\r") > 2 * MAX_POINTS:
        raise UnreadableInput(f"more than {MAX_POINTS} lines; thin the points out")
    told = list(comments(data))[-MAX_HEADER:]
    header = [_NAMES.findall(text) for text in told]
    words, columns = 0, None
    rows: list[tuple[float, ...]] = []
    for number, fields in read_lines(data):
        if columns is None:
            if not any(_is_number(field) for field in fields) and words < MAX_HEADER:
                words += 1
                header.append(fields)
                continue
            columns = _columns(header, len(fields))
        rows.append(columns.point(fields, number))
        if len(rows) > MAX_POINTS:
            raise UnreadableInput(f"more than {MAX_POINTS} points; thin them out")
    if columns is None or len(rows) < 3:
        raise UnreadableInput(f"only {len(rows)} points; a profile needs 3 at least")
    points = np.array(rows)
    if points.shape[1] > 2 and np.ptp(points[:, 2]) > 0.0:
        raise UnreadableInput("a curve in space: z changes; give x and y alone")
    scaled, notes = placed([points[:, :2] * columns.unit.mm])
    return Drawn([clean(scaled[0], closed=False)], columns.unit, notes)


def _is_number(field: str) -> bool:
    return bool(NUMBER.fullmatch(field) or _NOT_FINITE.fullmatch(field))


@dataclass(frozen=True)
class _Columns:
    """Which fields of a line are x, y and, where there is one, z; ``fields`` is 0 for any count."""

    places: tuple[int, ...]
    fields: int
    unit: DrawnUnit

    def point(self, fields: list[str], number: int) -> tuple[float, ...]:
        if len(fields) <= max(self.places) or (self.fields and len(fields) != self.fields):
            raise UnreadableInput(
                f"line {number} holds {len(fields)} fields; give x and y in mm, or name the "
                "columns x and y in a header line"
            )
        for field in (fields[place] for place in self.places):
            if not NUMBER.fullmatch(field):
                kind = "is not finite" if _NOT_FINITE.fullmatch(field) else "is no number"
                raise UnreadableInput(f"line {number}: {shown(field)} {kind}; give x and y in mm")
        return tuple(float(fields[place]) for place in self.places)


def _columns(header: Sequence[list[str]], count: int) -> _Columns:
    """Find x and y by the header's names, and their unit."""
    named: dict[str, int] = {}
    rows: list[list[str]] = []
    for line in header:
        names = [field.strip().lower() for field in line]
        axes = {axis: place for place, name in enumerate(names) if (axis := _axis(name))}
        if {"x", "y"} <= axes.keys() and max(axes.values()) < count:
            named, rows = axes, [names]
        elif len(names) == count and all(_unit(name) or not name for name in names):
            rows.append(names)
        elif len(names) == count and not named:
            rows = [names]
    told = [found[1] for line in header if (found := _UNITS.search(" ".join(line).lower()))][:1]
    places = tuple(named[axis] for axis in ("x", "y", "z") if axis in named) or (0, 1)
    units = [[row[n] for n in places[:2]] for row in rows if len(row) > max(places)]
    in_names = any(_unit(name) for row in units for name in row)
    return _Columns(places, 0 if named else 2, _common(units if in_names else [told]))


def _axis(name: str) -> str:
    found = set(_WORDS.findall(name)) & {"x", "y", "z"}
    return found.pop() if len(found) == 1 else ""


def _unit(name: str) -> str:
    """Give the unit that a name ends in or holds in brackets; "" where it holds none."""
    words: list[str] = _WORDS.findall(name)
    known: list[str] = [word for word in words if word in MM_PER or word in _PIXELS]
    if known:
        return known[-1]
    inside = _BRACKETS.search(name)
    text = "" if inside is None else (inside[1] or inside[2] or "").strip()
    return text if text and not NUMBER.fullmatch(text) and _axis(text) == "" else ""


def _common(rows: Sequence[Sequence[str]]) -> DrawnUnit:
    """Give the one unit of x and y."""
    units = {unit for row in rows for name in row if (unit := _unit(name))}
    mms = {MM_PER.get(unit) for unit in units}
    if not units:
        return DrawnUnit()
    if len(mms) > 1:
        raise UnreadableInput("the header gives two units; write x and y in one")
    (mm,), unit = mms, sorted(units)[0]
    if mm is not None:
        return DrawnUnit(mm, f"the header gives {shown(unit)[1:-1]}")
    return DrawnUnit(1.0, f"the header gives {shown(unit)}, which is no length", sized=False)
