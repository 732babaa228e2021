"""Options as the page sends them, and as a TOML file of the command `design` holds them."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from profiletool.errors import UsageError
from profiletool.records.built import BuildErrors, build_errors
from profiletool.records.making import check_request, request_of
from profiletool.records.option import Option
from profiletool.records.options import DESIGN
from profiletool.records.request import Request

Values = Mapping[str, Any]

_ROWS = {row.field: row for row in DESIGN}
_NAMES = {"formula": re.compile(r"(paper|fe)?"), "mask": re.compile(r"(mask_\d+\.png)?")}
# Words for fields of a change by hand.
_BY_HAND = {
    "move_mm": "move", "openF_mm": "the cut", "alpha_deg": "the uncut sector", "joint": "the joint",
    "alpha_center_deg": "the sense",
}  # fmt: skip
_LONGEST = 200  # letters of a text


def checked(tree: Any) -> dict[str, Any]:
    """Take options by field name from a page; what is None or "" has its default.

    Raises
    ------
    UsageError
        A name is no option, or a value is none of its kind.
    """
    if not isinstance(tree, dict):
        raise UsageError("options come by name")
    values = {}
    for name, value in tree.items():
        if name not in _ROWS:
            raise UsageError(f"{name[:_LONGEST]!r} is no option of a design")
        if value is not None and value != "":
            values[name] = _value(_ROWS[name], value)
    check_request(request_of(Path("picture.png"), values))
    return values


def to_toml(values: Values) -> str:
    """Write options as the file that ``design --config`` reads."""
    lines = [
        f"{row.flag.removeprefix('--')} = {_literal(row, values[row.field])}\n"
        for row in DESIGN
        if row.field in values
    ]
    return "".join(lines)


def fields() -> list[dict[str, Any]]:
    """Describe every option for the page's form."""
    usual = Request(Path())
    return [
        {
            "name": row.field,
            "label": label(row),
            "help": row.help,
            "kind": row.kind.type.__name__,
            "choices": row.kind.choices,
            "default": _plain(row.value(usual)),
        }
        for row in DESIGN
    ]


def label(row: Option) -> str:
    """Give an option's name on the page."""
    name = row.flag.removeprefix("--").removeprefix("no-").replace("-", " ").capitalize()
    return f"{name}, N" if row.field.endswith("_N") else name


def in_words(text: str) -> str:
    """Name the fields of a message by their labels on the page."""

    def named(found: re.Match[str]) -> str:
        row = _ROWS.get(found[1])
        return _BY_HAND.get(found[1], found[1]) if row is None else f"\u201c{label(row)}\u201d"

    return re.sub(r"`(\w+)`", named, text)


def _value(row: Option, value: Any) -> Any:
    kind = row.kind
    said = f"`{row.field}` cannot be {json.dumps(value)[:_LONGEST]}"
    if kind.type is bool:
        if not isinstance(value, bool):
            raise UsageError(said)
        return value
    if kind.count == 1 and value == "auto":
        return value
    if kind.type in (float, int) or kind.count == 1:
        number = _number(value, said)
        if kind.type is int and not number.is_integer():
            raise UsageError(f"{said}: it is a whole number")
        return int(number) if kind.type is int else number
    if kind.type is tuple:
        if not isinstance(value, list | tuple) or len(value) != kind.count:
            raise UsageError(f"{said}: it has {kind.count} numbers")
        return tuple(_number(part, said) for part in value)
    if not isinstance(value, str) or len(value) > _LONGEST or not value.isprintable():
        raise UsageError(said)
    if kind.choices and value not in kind.choices:
        raise UsageError(f"{said}: it is one of {', '.join(kind.choices)}")
    if row.field in _NAMES and not _NAMES[row.field].fullmatch(value):
        raise UsageError(said)
    return str(build_errors(value)) if kind.type is BuildErrors else value


def _number(value: Any, said: str) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise UsageError(f"{said}: it is a number")
    number = float(value)
    if not math.isfinite(number) or abs(number) >= 1e6:
        raise UsageError(f"{said}: it is a number of usual size")
    return number


def _literal(row: Option, value: Any) -> str:
    if row.kind.count == 1:
        return json.dumps(str(value))
    if row.flag.startswith("--no-"):
        return json.dumps(not value)
    if isinstance(value, tuple):
        return json.dumps(list(value))
    return json.dumps(value, ensure_ascii=False)


def _plain(value: Any) -> Any:
    return str(value) if isinstance(value, BuildErrors | Path) else value
