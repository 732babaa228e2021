"""Profiles as text: x and y in mm, y up, one point a line."""

from __future__ import annotations

import re

import numpy as np

from profiletool.errors import UnreadableInput
from profiletool.profile.vector_chain import MAX_POINTS, Chain, clean

_NUMBER = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")
_NOT_FINITE = re.compile(r"[+-]?(?:nan|inf|infinity)", re.IGNORECASE)
_SHOWN = 20  # characters of a bad field in the message


def read_csv(data: bytes) -> Chain:
    """Read points from text.

    Parameters
    ----------
    data : bytes
        UTF-8 or Latin-1 text. Fields are separated by semicolons (then commas may be decimal),
        tabs, commas or spaces. Blank lines, lines that start with ``#`` and one header line of
        words are skipped.

    Returns
    -------
    Chain
        In mm, y up; closed where the last point meets the first.

    Raises
    ------
    UnreadableInput
        A line does not hold two finite numbers, or there are too few or too many points.
    """
    if b"\0" in data:
        raise UnreadableInput("not plain text; save it as CSV in UTF-8")
    if data.count(b"\n") + data.count(b"\r") > 2 * MAX_POINTS:
        raise UnreadableInput(f"more than {MAX_POINTS} lines; thin the points out")
    rows: list[tuple[float, float]] = []
    header_allowed = True
    for number, line in enumerate(_text(data).splitlines(), start=1):
        text = line.partition("#")[0].strip()
        if not text:
            continue
        fields = _fields(text)
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


def _text(data: bytes) -> str:
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return data.decode("latin-1")  # for words in the header: numbers are ASCII anyway


def _fields(text: str) -> list[str]:
    """Split a line; a decimal comma is turned into a point where semicolons separate."""
    if ";" in text:
        return [field.strip().replace(",", ".") for field in text.split(";")]
    for separator in ("\t", ","):
        if separator in text:
            return [field.strip() for field in text.split(separator)]
    return text.split()


def _is_number(field: str) -> bool:
    return bool(_NUMBER.fullmatch(field) or _NOT_FINITE.fullmatch(field))


def _point(fields: list[str], number: int) -> tuple[float, float]:
    if len(fields) != 2:
        raise UnreadableInput(f"line {number} holds {len(fields)} fields; give x and y in mm")
    for field in fields:
        if not _NUMBER.fullmatch(field):
            kind = "is not finite" if _NOT_FINITE.fullmatch(field) else "is no number"
            raise UnreadableInput(f"line {number}: {field[:_SHOWN]!a} {kind}; give x and y in mm")
    return float(fields[0]), float(fields[1])
