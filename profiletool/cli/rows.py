"""Signatures of commands, made from rows of options and from records of words."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Annotated, Any, Literal, get_type_hints

import typer

from profiletool.cli.console import Numbers, build, four, numbers, turn, two
from profiletool.records.built import BuildErrors
from profiletool.records.grip_request import GripRequest
from profiletool.records.option import ANY, Option
from profiletool.records.request import Request

_WORD = inspect.Parameter.KEYWORD_ONLY
_USUAL = Request(Path())


def with_signature(command: Callable[..., None], *parts: Iterable[inspect.Parameter]) -> None:
    """Give a command that takes any words the signature that typer reads."""
    parameters = [parameter for part in parts for parameter in part]
    command.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
    command.__annotations__ = {row.name: row.annotation for row in parameters}


def parameters_of(source: Callable[..., Any]) -> list[inspect.Parameter]:
    """Parameters of a function, or of a record's fields, with their annotations resolved."""
    hints = get_type_hints(source, include_extras=True)
    named = inspect.signature(source).parameters.values()
    return [
        row.replace(annotation=hints[row.name], kind=_WORD)
        for row in named
        if row.kind is not inspect.Parameter.VAR_KEYWORD
    ]


_HOLDERS = {
    "scale": "Size of the object",
    "look": "Finding the object",
    "tube": "Tube",
    "model": "Finite elements",
}
_OFF = "--no-"
_FIELDS = {
    **dict.fromkeys(("side", "start_pct", "end_pct", "clearance_mm"), "What to follow"),
    **dict.fromkeys(("formula", "extrapolate"), "Tube"),
    **dict.fromkeys(("verify", "refine", "grip", "grip_N", "solid"), "Finite elements"),
}


def panel_of(row: Option) -> str:
    """Name the panel of the help that an option stands in."""
    holder, _, field = row.path.rpartition(".")
    return _HOLDERS.get(holder) or _FIELDS.get(field, "Method")


def parameters_of_rows(
    rows: Iterable[Option], usual: Request | GripRequest = _USUAL
) -> list[inspect.Parameter]:
    """Parameters for rows of options; each is named by its row's field, ``usual`` has defaults."""
    return [
        inspect.Parameter(
            row.field, _WORD, default=_default(row, usual), annotation=_annotation(row)
        )
        for row in rows
    ]


def _default(row: Option, usual: Request | GripRequest) -> Any:
    """Default that the help shows; None where the formula or the method decides."""
    value = row.value(usual)
    if "default:" in row.help:
        return None
    if row.kind.type is BuildErrors:
        return str(value)
    return f"{value:g}" if row.kind.count == 1 else value


def _annotation(row: Option) -> Any:
    """Annotation as typer reads it."""
    kind = row.kind
    words: dict[str, Any] = {
        "help": row.help, "metavar": row.metavar, "rich_help_panel": panel_of(row),
    }  # fmt: skip
    if kind.count:
        parse = {ANY: numbers, 1: turn, 2: two, 4: four}[kind.count]
        return Annotated[Numbers | None, typer.Option(row.flag, parser=parse, **words)]
    if kind.type is BuildErrors:
        return Annotated[BuildErrors, typer.Option(row.flag, parser=build, **words)]
    if kind.type is bool:
        on = " " if row.flag.startswith(_OFF) else row.flag  # a blank: off alone
        flags = f"{on}/{_OFF}{row.flag.removeprefix(_OFF).lstrip('-')}" if row.off else row.flag
        return Annotated[bool, typer.Option(flags, show_default=bool(on.strip()), **words)]
    least = row.least if kind.type is int else None
    value: Any = Literal[kind.choices] if kind.choices else kind.type
    return Annotated[value | None, typer.Option(row.flag, min=least, **words)]
