"""Columns of numbers in text files, as people's spreadsheets and instruments write them."""

from __future__ import annotations

import csv
import re
from collections.abc import Iterator

from profiletool.errors import UnreadableInput

NUMBER = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")
MAX_LINE = 10_000  # characters
_SHOWN = 20  # characters of a bad field in a message
_SEEN_LINES = 50  # that tell what separates the fields
_BARE = str.maketrans({"\u2212": "-", "\u2013": "-", "\u00a0": "", "\u202f": "", "'": ""})
_LIKE_NUMBER = re.compile(r"[+-]?[0-9.,]*[0-9][0-9.,]*(?:[eE][+-]?[0-9]+)?")
_SPACED_COMMAS = re.compile(
    r"(?:[+-]?[0-9]+(?:,[0-9]+)?(?:[eE][+-]?[0-9]+)?\s+)+[+-]?[0-9]+,?[0-9]*"
)


def read_lines(data: bytes) -> Iterator[tuple[int, list[str]]]:
    """Split the lines that hold something into fields; each with its number, from 1.

    Parameters
    ----------
    data : bytes
        Text in UTF-8, UTF-16 with its mark, or Latin-1. Fields, quoted or not, are separated by
        what a first line ``sep=;`` says, else by semicolons, tabs, commas or spaces; where commas
        do not separate, they are decimal. ``#`` starts a comment. Lines of separators alone hold
        nothing, and neither do empty fields at the end of a line.

    Raises
    ------
    UnreadableInput
        When it is not text, or a line of it never ends.
    """
    separator, first = None, True
    lines = _lines(data)
    for number, line in lines:
        content = _content(line)
        if first and content.strip():
            first = False
            if content.strip()[:4].lower() == "sep=":
                separator = content.strip()[4:5] or "\t"
                continue
        if not content.strip():
            continue
        if separator is None:
            following = (_content(text) for _, text in lines[number - 1 : number + _SEEN_LINES])
            separator = _separator([text for text in following if text.strip()])
        fields = _fields(content, separator)
        if fields:
            yield number, fields


def comments(data: bytes) -> Iterator[str]:
    """Yield the comments before the first line that holds something."""
    for _, line in _lines(data):
        content, mark, comment = line.partition("#")
        if content.strip():
            return
        if mark:
            yield comment.strip()


def shown(field: str) -> str:
    """Quote a field that makes no sense, in ASCII and not for ever."""
    return ascii(field[:_SHOWN])


def _lines(data: bytes) -> list[tuple[int, str]]:
    lines = _text(data).splitlines()
    for number, line in enumerate(lines, start=1):
        if len(line) > MAX_LINE:
            raise UnreadableInput(f"line {number} never ends; give one point a line")
    return list(enumerate(lines, start=1))


def _text(data: bytes) -> str:
    wide = data.startswith((b"\xff\xfe", b"\xfe\xff"))  # as Excel's "Unicode text"
    if not wide and b"\0" in data:
        raise UnreadableInput("not plain text; save it as CSV in UTF-8")
    try:
        text = data.decode("utf-16" if wide else "utf-8-sig")
    except UnicodeDecodeError:
        if wide:
            raise UnreadableInput("not plain text; save it as CSV in UTF-8") from None
        return data.decode("latin-1")  # for words in the header: numbers are ASCII anyway
    if "\0" in text:
        raise UnreadableInput("not plain text; save it as CSV in UTF-8")
    return text


def _content(line: str) -> str:
    return line.partition("#")[0].strip(" \r\f\v").rstrip()


def _separator(lines: list[str]) -> str:
    """Tell what separates the fields of a file from its first lines; " " is any blank space."""
    bare = [re.sub(r'"[^"]*"', '""', line) for line in lines]
    if any(";" in line for line in bare):
        return ";"
    if any(re.search(r"[^,\s]\s*\t|^\t", line) for line in bare):
        return "\t"
    if not any("," in line for line in bare):
        return " "
    numeric = [line for line in bare if re.match(r"[+-]?[0-9]", line)]
    decimal = bool(numeric) and all(_SPACED_COMMAS.fullmatch(line) for line in numeric)
    return " " if decimal else ","


def _fields(text: str, separator: str) -> list[str]:
    if separator == " ":
        fields = text.split()
    elif '"' in text:
        fields = next(csv.reader([text], delimiter=separator, skipinitialspace=True))
    else:
        fields = text.split(separator)
    plain = [_plain(field.strip().strip('"').strip(), '"' in text or separator != ",")
             for field in fields]  # fmt: skip
    while plain and not plain[-1]:
        plain.pop()
    return plain


def _plain(field: str, commas: bool) -> str:
    """Write a number with a decimal point and nothing else in it; words stay as they are.

    ``commas``: whether a comma may belong to it.
    """
    if NUMBER.fullmatch(field):
        return field
    number = field.translate(_BARE)
    if not _LIKE_NUMBER.fullmatch(number):
        return field
    if "," not in number or not commas:
        return number
    if number.rfind(".") > number.rfind(",") or number.count(",") > 1:  # they part thousands
        return number.replace(",", "")
    return number.replace(".", "").replace(",", ".")
