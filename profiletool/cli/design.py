"""The command `design`: parse, call, print, exit codes; nothing else."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from profiletool.cli.console import (
    OUTPUT,
    Debug,
    Force,
    Quiet,
    TubeFile,
    exit_codes,
    progress_bar,
    speaker,
)
from profiletool.cli.rows import parameters_of, parameters_of_rows, with_signature
from profiletool.cli.template import Date, Kerf, Paper
from profiletool.errors import Infeasible, NoObject, NotVerified, Unsure, UsageError
from profiletool.records.making import check_request, request_of
from profiletool.records.options import DESIGN

if TYPE_CHECKING:
    from profiletool.pipeline import Result
    from profiletool.records.request import Request


@dataclass(frozen=True)
class Delivery:
    """Where the results go, and what the drawings shall be."""

    kerf: Kerf = 0.0
    date: Date = ""
    paper: Paper = "a4"
    tube: TubeFile = None
    out: Annotated[
        Path | None,
        typer.Option(
            help="Output folder (default: PICTURE's name + _design).", rich_help_panel=OUTPUT
        ),
    ] = None
    force: Force = False
    as_json: Annotated[
        bool, typer.Option("--json", help="Print design.json on stdout.", rich_help_panel=OUTPUT)
    ] = False
    quiet: Quiet = False
    debug: Debug = False


def design(
    picture: Annotated[
        Path,
        typer.Argument(
            metavar="PICTURE",
            help="PNG, JPEG, TIFF, BMP or WebP of one object; or a profile as DXF, SVG or CSV.",
        ),
    ],
    **options: Any,
) -> None:
    """Design an actuator that mirrors the side of an object, and its cut template."""
    delivery = Delivery(**{row.name: options.pop(row.name) for row in fields(Delivery)})
    with exit_codes(delivery.debug):
        from profiletool import pipeline
        from profiletool.files import write
        from profiletool.files.formula import read_formula
        from profiletool.template.kerf import check_kerf
        from profiletool.template.kinds import Wish

        folder = delivery.out or Path(f"{picture.stem}_design")
        write.check_free(folder, delivery.force)
        known = read_formula(options["formula"], options["extrapolate"])
        request = _in_tube(request_of(picture, options, known), delivery.tube, options)
        check_request(request)
        wish = Wish(kerf_mm=delivery.kerf, date=delivery.date)
        check_kerf(wish.kerf_mm, request.tube.pitch_mm, request.tube.thread_mm)
        say = speaker(delivery.quiet)
        try:
            with progress_bar("design", delivery.quiet, left=True) as progress:
                result = pipeline.run(request, say, progress)
        except Unsure as unsure:
            name = f"{delivery.out or picture.stem}_candidates"
            raise _doubted(unsure, name) from unsure
        # Heavy: a picture that is refused is refused sooner without it.
        from profiletool.report import outputs
        from profiletool.verdict.summary import joint_table

        files = outputs.files_of(result, wish, delivery.paper)
        write.write_folder(folder, files, delivery.force)
        as_json = delivery.as_json
        text = files["design.json"].decode() if as_json else joint_table(result.design)
        typer.echo(text, nl=False)
        conclude(result, folder, say)


def _in_tube(request: Request, file: Path | None, options: Mapping[str, Any]) -> Request:
    """Ask for the same in a calibrated tube.

    Raises
    ------
    UnreadableInput, UsageError
    """
    if file is None:
        return request
    from profiletool.files.tube_json import load_tube
    from profiletool.records.calibrated import request_with

    for field in ("outer_diameter_mm", "wall_mm", "nu", "sector_extra_deg"):
        if options.get(field) is not None:
            raise UsageError(f"{file} tells `{field}`: leave one of them away")
    return request_with(request, load_tube(file))


with_signature(design, parameters_of(design), parameters_of_rows(DESIGN), parameters_of(Delivery))


_AS = {"edited": " as it was changed", "report": "", "refined": " as it was refined"}
_CHOOSE = "design chooses joints anew"
_ADVICE = {
    "edited": f"refine lets finite elements correct it, and {_CHOOSE}",
    "report": f"refine lets finite elements correct it, and {_CHOOSE}",
    "refined": f"its number of joints and their cuts stay as they are: {_CHOOSE}",
}


def conclude(result: Result, folder: Path, say: Callable[[str], None], again: str = "") -> None:
    """Print the notes, and end with the exit code of what is wrong with the design.

    ``again`` is the command that took a design up again: it looked for no better one.

    Raises
    ------
    Infeasible, NotVerified
    """
    for warning in result.design.warnings:
        say(f"note: {warning}")
    say(f"written: {folder}")
    if result.reasons:
        if again:
            raise Infeasible(
                f"the design{_AS[again]} is beyond the limits ({'; '.join(result.reasons[:2])}); "
                f"it is in {folder}, marked infeasible; {_ADVICE[again]}"
            )
        way = "" if result.ways is None else f"; {result.ways}"
        raise Infeasible(
            f"no design within the limits ({'; '.join(result.reasons[:2])}); "
            f"the best attempt is in {folder}, marked infeasible{way}"
        )
    if result.check is not None and result.check.failure is not None:
        raise NotVerified(
            f"finite elements: {result.check.failure}; the design is in {folder}, marked NOT "
            f"VERIFIED; try a lower {'`pressure_bar`' if again else '`max_pressure_bar`'}"
        )


def _doubted(unsure: Unsure, name: str) -> NoObject:
    """Draw what the object could be, and say where: never over another file."""
    from profiletool.files import write
    from profiletool.report.candidates import draw_candidates

    names = itertools.chain([name], (f"{name}_{k}" for k in itertools.count(2)))
    file = next(file for one in names if not (file := Path(f"{one}.png")).exists())
    write.write_file(file, draw_candidates(unsure.rgb, unsure.candidates), force=False)
    return NoObject(f"{unsure}; {file} shows what it could be")
