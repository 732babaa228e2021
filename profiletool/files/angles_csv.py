"""Measured joint angles as CSV: angles.csv."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

from profiletool.errors import UnreadableInput
from profiletool.files.columns import NUMBER, read_lines, shown
from profiletool.files.read import read_file
from profiletool.records.bench import Seen
from profiletool.records.setting import AngleReading

COLUMNS = ("picture", "pressure_bar", "joint", "theta_deg", "sigma_deg", "state")
TIME = "time_s"  # after them, where the times of the pictures are known
_NEEDED = COLUMNS[1:4]
_LOST = "lost"
_MOST_BYTES = 20_000_000
_MOST_JOINTS = 1000


def read_angles(path: Path | str) -> tuple[AngleReading, ...]:
    """Read measured joint angles.

    Parameters
    ----------
    path : Path or str
        CSV with a head of names, of which ``pressure_bar``, ``joint`` and ``theta_deg`` must be
        there; ``sigma_deg`` is 1 where it is missing. Rows whose ``state`` is lost do not count.
        ``time_s`` says when each was read.

    Raises
    ------
    UnreadableInput
        Naming the file and the line.
    """
    try:
        data = read_file(Path(path), _MOST_BYTES, "a CSV file of angles")
        readings = _readings(data)
    except UnreadableInput as error:
        raise UnreadableInput(f"cannot read {path}: {error}") from None
    return readings


def write_angles(seen: Sequence[Seen]) -> bytes:
    """Write the angles that pictures show; a joint that is lost has none."""
    timed = all(one.time_s is not None for one in seen)
    lines = [",".join([*COLUMNS, TIME] if timed else COLUMNS)]
    for one in seen:
        time = f",{one.time_s:g}" if timed else ""
        for joint, angle in enumerate(one.angles, start=1):
            lost = angle.state == _LOST
            value = "," if lost else f"{angle.theta_deg:.4f},{angle.sigma_deg:.4f}"
            picture = one.picture.replace('"', "'")
            name = f'"{picture}"' if "," in picture else picture
            lines.append(f"{name},{one.pressure_bar:g},{joint},{value},{angle.state}{time}")
    return ("\n".join(lines) + "\n").encode()


def _readings(data: bytes) -> tuple[AngleReading, ...]:
    lines = read_lines(data)
    _, head = next(lines, (0, []))
    names = [name.strip().strip('"').lower() for name in head]
    missing = [name for name in _NEEDED if name not in names]
    if missing:
        raise UnreadableInput(
            f"no column {missing[0]} in its first line; give pressure_bar,joint,theta_deg"
        )
    readings = []
    for number, fields in lines:
        if len(fields) != len(names):
            raise UnreadableInput(
                f"line {number} has {len(fields)} fields where the first has {len(names)}"
            )
        row = dict(zip(names, (field.strip('"') for field in fields), strict=True))
        if row.get("state", "").strip().lower() != _LOST:
            readings.append(_reading(row, number))
    if not readings:
        raise UnreadableInput("no angle in it that was measured")
    return tuple(readings)


def _reading(row: dict[str, str], line: int) -> AngleReading:
    def number(name: str) -> float:
        field = row[name]
        if not NUMBER.fullmatch(field) or not math.isfinite(float(field)):
            raise UnreadableInput(f"line {line}: {name} {shown(field)} is no number")
        return float(field)

    joint = number("joint")
    if not (joint.is_integer() and 1 <= joint <= _MOST_JOINTS):
        raise UnreadableInput(f"line {line}: joints are counted from 1, not {joint:g}")
    pressure = number("pressure_bar")
    if pressure < 0.0:
        raise UnreadableInput(f"line {line}: a pressure of {pressure:g} bar")
    sigma = number("sigma_deg") if row.get("sigma_deg") else 1.0
    if sigma <= 0.0:
        raise UnreadableInput(f"line {line}: sigma_deg must be above 0, not {sigma:g}")
    time = number(TIME) if TIME in row else None
    return AngleReading(pressure, int(joint), number("theta_deg"), sigma, time)
