"""The command that measures an actuator on the bench: parse, call, print, exit codes."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from profiletool.cli.console import (
    Debug,
    DesignFile,
    Force,
    FormulaFile,
    Json,
    Numbers,
    Quiet,
    changed_notes,
    design_file,
    exit_codes,
    four,
    progress_bar,
    speaker,
    two,
)
from profiletool.cli.fe import bar, failures
from profiletool.cli.rows import parameters_of, with_signature
from profiletool.errors import UnreadableInput, UsageError

if TYPE_CHECKING:
    from profiletool.records.bench import Predicted
    from profiletool.records.design import Design
    from profiletool.records.picture import Picture
    from profiletool.subject.tube.views import Looked

_MOST_BAR, _MOST_PICTURES = 20.0, 200


@dataclass(frozen=True)
class MeasureOptions:
    """Where the pressures are, and how to look at the pictures."""

    pressures: Annotated[
        str,
        typer.Option(
            metavar="BAR,...|FILE.csv",
            help="Pressure of each picture, bar, rising; or over time, of a video or pictures: a "
            "CSV with time_s and pressure_bar.",
        ),
    ]
    out: Annotated[
        Path | None, typer.Option(help="Output folder (default: the design's name + _measured).")
    ] = None
    mm_per_px: Annotated[
        float | None,
        typer.Option(
            "--mm-per-px",
            help="Millimetres per pixel, seen squarely (default: by the printed sheet).",
        ),
    ] = None
    box: Annotated[
        Numbers | None,
        typer.Option(parser=four, metavar="X,Y,W,H", help="The actuator lies in this box, px."),
    ] = None
    point: Annotated[
        Numbers | None,
        typer.Option(parser=two, metavar="X,Y", help="A point on the actuator, px."),
    ] = None
    marks: Annotated[
        bool,
        typer.Option(
            "--marks", help="Two coloured dots, or a ring, are painted on the wrapped sectors."
        ),
    ] = False
    lines: Annotated[
        Path | None,
        typer.Option(
            metavar="LINES.csv",
            help="Lines along wrapped sectors, drawn by hand: picture, sector, x1_px, y1_px, "
            "x2_px, y2_px.",
        ),
    ] = None
    fe: Annotated[
        bool,
        typer.Option(
            "--fe/--no-fe", help="Predict by finite elements, or by the joint response: quicker."
        ),
    ] = True


def measure(
    file: DesignFile,
    pictures: Annotated[
        list[Path], typer.Argument(metavar="PICTURE...", help="Pictures, or one video.")
    ],
    formula: FormulaFile = None,
    force: Force = False,
    as_json: Json = False,
    quiet: Quiet = False,
    debug: Debug = False,
    **options: Any,
) -> None:
    """Measure the joints' angles of an inflated actuator in pictures, and compare them."""
    with exit_codes(debug):
        asked = MeasureOptions(
            **{row.name: options.pop(row.name) for row in fields(MeasureOptions)}
        )
        file = design_file(file)
        folder = asked.out or Path(f"{file.absolute().parent.name}_measured")
        from profiletool.files import write
        from profiletool.files.design_json import load_design
        from profiletool.files.formula import named_formula, read_formula

        write.check_free(folder, force)
        design = load_design(file)
        names, bars, times, load = _pictures(pictures, asked.pressures)
        looked = _looked(asked)
        chosen = named_formula(design.formula.name) if formula is None else read_formula(formula)
        say = speaker(quiet)
        for note in changed_notes(design):
            say(f"note: {note}")
        predicted = _predicted(design, file, max(bars), asked.fe, quiet)
        from profiletool.report import outputs
        from profiletool.report.bench import bench_output, bench_text, compare_json
        from profiletool.subject.tube.family import family_of
        from profiletool.subject.tube.series import measure_series, timed

        with progress_bar("pictures", quiet) as show:
            seen = measure_series(family_of(predicted), names, bars, load, looked, show)
        if times is not None:
            seen = timed(seen, times)
        output = bench_output(
            design, seen, predicted, "fe" if asked.fe else "response", chosen, load
        )
        write.write_folder(folder, outputs.bench_files(output), force)
        typer.echo(compare_json(output) if as_json else bench_text(output), nl=False)
        for note in output.notes:
            say(f"note: {note}")
        say(f"written: {folder}")


with_signature(measure, parameters_of(measure), parameters_of(MeasureOptions))


def _predicted(design: Design, file: Path, most: float, fe: bool, quiet: bool) -> Predicted:
    from profiletool.verify.predicted import BEYOND, predicted_by_fe, predicted_by_response

    if not fe:
        return predicted_by_response(design, most)
    with failures(UnreadableInput, f"{file}: "), bar(BEYOND * most, quiet) as progress:
        return predicted_by_fe(design, most, progress)


def _looked(asked: MeasureOptions) -> Looked:
    from profiletool.files.bench_csv import read_hand_lines
    from profiletool.subject.tube.values import Line
    from profiletool.subject.tube.views import Looked

    scale = asked.mm_per_px
    if scale is not None and not (math.isfinite(scale) and scale > 0.0):
        raise UsageError(f"`mm_per_px` must be a number above 0, not {scale:g}")
    drawn = {} if asked.lines is None else read_hand_lines(asked.lines)
    box, point = asked.box, asked.point
    return Looked(
        scale,
        None if box is None else (box[0], box[1], box[2], box[3]),
        None if point is None else (point[0], point[1]),
        asked.marks,
        {key: Line(ends) for key, ends in drawn.items()},
    )


Load = Callable[[int], "Picture"]


Taken = tuple[list[str], list[float], list[float] | None, Load]


def _pictures(files: Sequence[Path], pressures: str) -> Taken:
    """Give names, pressures, times and a loader of the pictures, or of a video's frames.

    Raises
    ------
    UsageError, UnreadableInput
    """
    from profiletool.files.bench_csv import read_times
    from profiletool.subject.tube.frames import frames_at, is_video
    from profiletool.subject.tube.views import picture_of

    video = any(is_video(file) for file in files)
    if video and len(files) > 1:
        raise UsageError("give one video, or pictures, not both")
    times = None
    if pressures.lower().endswith(".csv"):
        times, bars = (list(column) for column in zip(*read_times(Path(pressures)), strict=True))
    elif video:
        raise UsageError("a video needs `pressures` FILE.csv, with time_s and pressure_bar")
    else:
        bars = _listed(pressures)
    _check_bars(bars)
    if video and times is not None:
        frames = frames_at(files[0], times)
        return [f"{files[0].name} {time:g} s" for time in times], bars, times, frames.__getitem__
    if len(bars) != len(files):
        raise UsageError(
            f"{len(files)} pictures and {len(bars)} pressures: give `pressures` one for each"
        )
    if times is None and any(b <= a for a, b in pairwise(bars)):
        raise UsageError("`pressures` must rise from picture to picture: put both in that order")
    if len(files) > _MOST_PICTURES:
        raise UsageError(f"{len(files)} pictures: give {_MOST_PICTURES} at most")
    return [file.name for file in files], bars, times, lambda k: picture_of(files[k])


def _listed(pressures: str) -> list[float]:
    try:
        return [float(part) for part in pressures.split(",")]
    except ValueError:
        raise UsageError(
            f"`pressures` takes numbers with commas between, one a picture, or a CSV, "
            f"not {pressures!r}"
        ) from None


def _check_bars(bars: Sequence[float]) -> None:
    for pressure in bars:
        if not 0.0 <= pressure <= _MOST_BAR:
            raise UsageError(f"`pressures` must be 0 to {_MOST_BAR:g} bar, not {pressure:g}")
    if max(bars) <= 0.0:
        raise UsageError("all `pressures` are 0: an actuator at rest tells nothing; inflate it")
