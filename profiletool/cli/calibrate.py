"""The command that calibrates a tube: parse, call, print, exit codes; nothing else."""

from __future__ import annotations

import datetime
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import typer

from profiletool.cli.console import (
    Debug,
    DesignFile,
    Force,
    Json,
    Quiet,
    design_file,
    exit_codes,
    progress_bar,
    speaker,
)
from profiletool.cli.rows import parameters_of, with_signature
from profiletool.errors import UnreadableInput, UsageError
from profiletool.records.options import in_flags

_MOST_CYCLES = 10_000_000


@dataclass(frozen=True)
class Occasion:
    """When the angles were measured."""

    cycles: Annotated[
        int | None, typer.Option(help="How often the tube had been inflated before.")
    ] = None
    date: Annotated[
        str | None, typer.Option(metavar="YYYY-MM-DD", help="Of the measurement (default: today).")
    ] = None


def calibrate(
    file: DesignFile,
    angles: Annotated[
        Path,
        typer.Argument(
            metavar="ANGLES.csv",
            help="Measured angles, as measure writes them.",
        ),
    ],
    out: Annotated[Path, typer.Option(help="The tube file to write (JSON).")],
    force: Force = False,
    as_json: Json = False,
    quiet: Quiet = False,
    debug: Debug = False,
    **options: Any,
) -> None:
    """Find what a prototype's rubber, gauge, threads and wall are, from its measured angles."""
    with exit_codes(debug):
        from profiletool.files import write
        from profiletool.files.angles_csv import read_angles
        from profiletool.files.design_json import load_design
        from profiletool.files.tube_json import tube_json
        from profiletool.report.calibrated import tube_text
        from profiletool.verify.calibration import calibrate as fit

        write.check_file(out, force)
        asked = Occasion(**options)
        cycles = asked.cycles
        if cycles is not None and not 0 <= cycles <= _MOST_CYCLES:
            raise UsageError(f"--cycles must be 0 to {_MOST_CYCLES}, not {cycles}")
        day = _day(asked.date)
        file = design_file(file)
        design, readings = load_design(file), read_angles(angles)
        try:
            with progress_bar("finite elements", quiet, left=True) as progress:
                tube = fit(design, readings, date=day, cycles=cycles, progress=progress)
        except UnreadableInput as error:
            raise UnreadableInput(f"{angles}: {error}") from error
        data = tube_json(tube)
        write.write_file(out, data, force)
        typer.echo(data.decode() if as_json else in_flags(tube_text(tube)), nl=False)
        speaker(quiet)(f"written: {out}")


with_signature(calibrate, parameters_of(calibrate), parameters_of(Occasion))


def _day(date: str | None) -> str:
    """Check a date, or give today's.

    Raises
    ------
    UsageError
    """
    if date is None:
        return datetime.date.today().isoformat()
    try:
        return datetime.date.fromisoformat(date).isoformat()
    except ValueError:
        raise UsageError(f"--date takes a day like 2026-03-01, not {date!r}") from None
