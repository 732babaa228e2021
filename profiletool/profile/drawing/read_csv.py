"""Profiles as text: x and y in mm, y up, one point a line."""

from __future__ import annotations

import re

import numpy as np

from profiletool.errors import UnreadableInput
from profiletool.files.columns import NUMBER, read_lines, shown
from profiletool.profile.drawing.chain import MAX_POINTS, Polyline, clean

_NOT_FINITE = re.compile(r"[+-]?(?:nan|inf|infinity)", re.IGNORECASE)


def read_csv(data: bytes) -> Polyline:
    """Read points from text.

    Parameters
    ----------
    data : bytes
        Text as `profiletool.files.columns.read_lines` takes it; one header line of words is
        skipped.

    Returns
    -------
    Polyline
        In mm, y up; closed where the last point meets the first.

    Raises
    ------
    UnreadableInput
        A line does not hold two finite numbers, or there are too few or too many points.
    """
    if data.count(b"\n") + data.count(b"\r") > 2 * MAX_POINTS:
        raise UnreadableInput(f"more than {MAX_POINTS} lines; thin the points out")
    rows: list[tuple[float, float]] = []
    header_allowed = True
    for number, fields in read_lines(data):
        if header_allowed and not any(_is_number(field) for field in fields):
            header_allowed = False
            continue
        header_allowed = False
        rows.append(_point(fields, number))
        if len(rows) > MAX_POINTS:
            raise UnreadableInput(f"more than {MAX_POINTS} points; thin them out")
    if len(rows) < 3:
        raise UnreadableInput(f"only {len(rows)} points; a profile needs 3 at least")
    return clean(np.array(rows), closed=False)


def _is_number(field: str) -> bool:
    return bool(NUMBER.fullmatch(field) or _NOT_FINITE.fullmatch(field))


def _point(fields: list[str], number: int) -> tuple[float, float]:
    if len(fields) != 2:
        raise UnreadableInput(f"line {number} holds {len(fields)} fields; give x and y in mm")
    for field in fields:
        if not NUMBER.fullmatch(field):
            kind = "is not finite" if _NOT_FINITE.fullmatch(field) else "is no number"
            raise UnreadableInput(f"line {number}: {shown(field)} {kind}; give x and y in mm")
    return float(fields[0]), float(fields[1])
