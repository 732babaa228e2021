"""Columns of numbers in text files, as people's spreadsheets and instruments write them."""

from __future__ import annotations

import re
from collections.abc import Iterator

from profiletool.errors import UnreadableInput

NUMBER = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")
MAX_LINE = 10_000  # characters
_SHOWN = 20  # characters of a bad field in a message


def read_lines(data: bytes) -> Iterator[tuple[int, list[str]]]:
    """Split the lines that hold something into fields; each with its number, from 1.

    Parameters
    ----------
    data : bytes
        UTF-8 or Latin-1 text. Fields are separated by semicolons (then commas may be decimal),
        tabs, commas or spaces; ``#`` starts a comment.

    Raises
    ------
    UnreadableInput
        When it is not text, or a line of it never ends.
    """
    if b"\0" in data:
        raise UnreadableInput("not plain text; save it as CSV in UTF-8")
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = data.decode("latin-1")  # for words in the header: numbers are ASCII anyway
    for number, line in enumerate(text.splitlines(), start=1):
        if len(line) > MAX_LINE:
            raise UnreadableInput(f"line {number} never ends; give one point a line")
        content = line.partition("#")[0].strip()
        if content:
            yield number, _fields(content)


def shown(field: str) -> str:
    """Quote a field that makes no sense, in ASCII and not for ever."""
    return ascii(field[:_SHOWN])


def _fields(text: str) -> list[str]:
    """Split a line; a decimal comma is turned into a point where semicolons separate."""
    if ";" in text:
        return [field.strip().replace(",", ".") for field in text.split(";")]
    for separator in ("\t", ","):
        if separator in text:
            return [field.strip() for field in text.split(separator)]
    return text.split()
