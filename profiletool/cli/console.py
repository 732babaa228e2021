"""Shared parts of the commands: options, one-line errors with exit codes, progress on stderr."""

from __future__ import annotations

import os
import sys
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from profiletool.errors import ProfiletoolError, UsageError
from profiletool.records.built import BuildErrors, build_errors
from profiletool.records.edit import Edit, edit_of
from profiletool.records.options import in_flags

if TYPE_CHECKING:
    from profiletool.records.design import Design

OUTPUT = "Output"  # panel of the help
KEPT = "stopped: nothing was written"

Debug = Annotated[
    bool,
    typer.Option("--debug", help="Show the full traceback of an error.", rich_help_panel=OUTPUT),
]
Json = Annotated[
    bool, typer.Option("--json", help="Print the result as JSON.", rich_help_panel=OUTPUT)
]
Quiet = Annotated[
    bool, typer.Option("--quiet", help="No progress on stderr.", rich_help_panel=OUTPUT)
]
Force = Annotated[
    bool, typer.Option("--force", help="Replace an earlier result.", rich_help_panel=OUTPUT)
]
DesignFile = Annotated[
    Path, typer.Argument(metavar="DESIGN.json", help="A design.json, or the folder that holds one.")
]
TubeFile = Annotated[
    Path | None,
    typer.Option(
        "--tube", metavar="TUBE.json", help="The tube as it is: a file that calibrate wrote."
    ),
]


@dataclass(frozen=True)
class TubeOptions:
    """The tube as it is, in place of the design's."""

    tube: TubeFile = None


FormulaFile = Annotated[
    Path | None, typer.Option("--formula", help="A formula file, or by name paper (default) or fe.")
]

Extrapolate = Annotated[
    bool,
    typer.Option(
        "--extrapolate",
        help="Let the formula be used some way beyond what it was fitted on, with a warning.",
    ),
]


@contextmanager
def exit_codes(debug: bool, kept: str = KEPT) -> Iterator[None]:
    """Turn our errors into one line on stderr and their exit code; ``kept`` is for Ctrl-C."""
    try:
        yield
    except KeyboardInterrupt:
        typer.echo(kept, err=True)
        raise typer.Exit(130) from None
    except ProfiletoolError as error:
        if debug:
            traceback.print_exc()
        typer.echo(f"error: {in_flags(str(error))}", err=True)
        raise typer.Exit(error.exit_code) from error
    except (typer.Exit, typer.Abort):
        raise
    except Exception as error:  # the last resort: a fault of ours, never a traceback unasked
        if debug:
            traceback.print_exc()
        what = " ".join(f"{type(error).__name__}: {error}".split())
        typer.echo(f"error: a fault in profiletool ({what}); run again with --debug", err=True)
        raise typer.Exit(1) from error


def design_file(given: Path) -> Path:
    """Give the design.json that is meant: the file, or that of a folder."""
    return given / "design.json" if given.is_dir() else given


def changed_notes(design: Design) -> list[str]:
    """Give the notes of a design that was changed since finite elements verified it."""
    return [text for text in design.warnings[:1] if text.startswith("NOT VERIFIED: it was changed")]


def speaker(quiet: bool) -> Callable[[str], None]:
    """Give what puts a line on stderr, or swallows it."""
    return _silence if quiet else _say


def _say(line: str) -> None:
    typer.echo(in_flags(line), err=True)


def _silence(line: str) -> None:
    del line


@contextmanager
def progress_bar(
    what: str, quiet: bool, *, left: bool = False
) -> Iterator[Callable[[float], None] | None]:
    """Show a bar on a terminal from the first share (0 to 1) that it is told; else nothing.

    ``left``: with the time left in place of the time taken.
    """
    if quiet or not sys.stderr.isatty():
        yield None
        return
    from rich.console import Console  # slow to load, and only a terminal needs it
    from rich.progress import (
        BarColumn,
        Progress,
        TaskProgressColumn,
        TextColumn,
        TimeElapsedColumn,
        TimeRemainingColumn,
    )  # fmt: skip

    bar = Progress(
        TextColumn("{task.description}"), BarColumn(), TaskProgressColumn(),
        TimeRemainingColumn() if left else TimeElapsedColumn(),
        console=Console(stderr=True), transient=True,
    )  # fmt: skip
    task = bar.add_task(what, total=1.0)

    def show(share: float) -> None:
        bar.start()
        bar.update(task, completed=share)

    try:
        yield show
    finally:
        bar.stop()


def cores() -> int:
    """How many cores this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


class Numbers(tuple[float, ...]):
    """Numbers with commas between, as an option takes them."""


def numbers(text: str) -> Numbers:
    """Read numbers with commas between.

    Raises
    ------
    typer.BadParameter
    """
    try:
        values = [float(part) for part in text.split(",")]
    except ValueError as error:
        raise typer.BadParameter(f"expected numbers with commas between, not {text!r}") from error
    if not all(abs(value) < 1e6 for value in values):
        raise typer.BadParameter(f"expected finite numbers, not {text!r}")
    return Numbers(values)


def two(text: str) -> Numbers:
    """Read two numbers; as `numbers`."""
    return _so_many(text, 2)


def four(text: str) -> Numbers:
    """Read four numbers; as `numbers`."""
    return _so_many(text, 4)


def ascending(text: str) -> Numbers:
    """Read numbers above 0, in rising order and each once; as `numbers`."""
    values = Numbers(sorted(set(numbers(text))))
    if values[0] <= 0.0:
        raise typer.BadParameter(f"expected numbers above 0, not {values[0]:g}")
    return values


def build(text: str) -> BuildErrors:
    """Read the errors of a build; as `numbers`."""
    try:
        return build_errors(text)
    except UsageError as error:
        raise typer.BadParameter(in_flags(str(error))) from error


def changed(text: str) -> Edit:
    """Read the change of a joint; as `numbers`."""
    try:
        return edit_of(text)
    except UsageError as error:
        raise typer.BadParameter(str(error)) from error


def turn(text: str) -> float | str:
    """Read "auto", or an angle within one turn; as `numbers`."""
    if text == "auto":
        return text
    (angle,) = _so_many(text, 1)
    if abs(angle) > 360.0:
        raise typer.BadParameter(f"expected at most 360 degrees, not {text}")
    return angle


def _so_many(text: str, count: int) -> Numbers:
    values = numbers(text)
    if len(values) != count:
        many = "one number" if count == 1 else f"{count} numbers with commas between"
        raise typer.BadParameter(f"expected {many}, not {text!r}")
    return values
