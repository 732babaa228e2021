"""Tables for the bench as CSV: pressures over time, and lines drawn by hand."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from profiletool.errors import UnreadableInput
from profiletool.files.columns import NUMBER, read_lines, shown
from profiletool.files.read import read_file
from profiletool.records.units import FloatArray

_MOST_BYTES = 1_000_000
TIMES = ("time_s", "pressure_bar")
LINES = ("picture", "sector", "x1_px", "y1_px", "x2_px", "y2_px")


def read_times(path: Path) -> tuple[tuple[float, float], ...]:
    """Read times, s, and pressures, bar; times rise.

    Raises
    ------
    UnreadableInput
    """
    found: list[tuple[float, float]] = []
    for n, row in _table(path, TIMES):
        time, bar = (_number(path, n, row, name) for name in TIMES)
        if found and time <= found[-1][0]:
            raise UnreadableInput(f"cannot read {path}: line {n}: times must rise")
        if bar < 0.0:
            raise UnreadableInput(f"cannot read {path}: line {n}: a pressure of {bar:g} bar")
        found.append((time, bar))
    return tuple(found)


def read_hand_lines(path: Path) -> dict[tuple[str, int], FloatArray]:
    """Read lines along wrapped sectors: (picture, sector from 0) to their ends, (2, 2) px.

    Raises
    ------
    UnreadableInput
    """
    found: dict[tuple[str, int], FloatArray] = {}
    for n, row in _table(path, LINES):
        sector = _number(path, n, row, "sector")
        if not (sector.is_integer() and sector >= 1):
            raise UnreadableInput(
                f"cannot read {path}: line {n}: sectors are counted from 1, the clamped one, not "
                f"{sector:g}"
            )
        ends = np.array([_number(path, n, row, name) for name in LINES[2:]]).reshape(2, 2)
        if np.linalg.norm(ends[1] - ends[0]) < 2.0:
            raise UnreadableInput(f"cannot read {path}: line {n}: its two ends are one point")
        found[row["picture"], int(sector) - 1] = ends
    return found


def _table(path: Path, names: tuple[str, ...]) -> list[tuple[int, dict[str, str]]]:
    """Rows with their numbers, by the names of the first line."""
    try:
        lines = read_lines(read_file(path, _MOST_BYTES, "a CSV file"))
        _, head = next(lines, (0, []))
        heads = [name.strip().strip('"').lower() for name in head]
        missing = [name for name in names if name not in heads]
        if missing:
            raise UnreadableInput(
                f"no column {missing[0]} in its first line; give {','.join(names)}"
            )
        rows = []
        for number, fields in lines:
            if len(fields) != len(heads):
                raise UnreadableInput(
                    f"line {number} has {len(fields)} fields where the first has {len(heads)}"
                )
            rows.append((number, dict(zip(heads, fields, strict=True))))
        if not rows:
            raise UnreadableInput("nothing in it but its first line")
    except UnreadableInput as error:
        raise UnreadableInput(f"cannot read {path}: {error}") from None
    return rows


def _number(path: Path, line: int, row: dict[str, str], name: str) -> float:
    field = row[name]
    if not NUMBER.fullmatch(field) or not math.isfinite(float(field)):
        raise UnreadableInput(
            f"cannot read {path}: line {line}: {name} {shown(field)} is no number"
        )
    return float(field)
