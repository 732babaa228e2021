"""The commands that take a design.json up again: parse, call, print, exit codes; nothing else."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import typer

from profiletool.cli.console import (
    Debug,
    DesignFile,
    Force,
    FormulaFile,
    Quiet,
    changed,
    design_file,
    exit_codes,
    progress_bar,
    speaker,
)
from profiletool.cli.design import conclude
from profiletool.cli.rows import parameters_of, with_signature
from profiletool.cli.template import Paper
from profiletool.records.edit import Edit


@dataclass(frozen=True)
class Again:
    """The options that these commands share."""

    formula: FormulaFile = None
    paper: Paper = "a4"
    out: Annotated[
        Path | None, typer.Option(help="Output folder (default: the object's name + the command).")
    ] = None
    force: Force = False
    as_json: Annotated[bool, typer.Option("--json", help="Print design.json on stdout.")] = False
    quiet: Quiet = False
    debug: Debug = False


def edit(
    file: DesignFile,
    joint: Annotated[int | None, typer.Option(help="Number of the joint to change.")] = None,
    alpha: Annotated[float | None, typer.Option(help="Its uncut sector, deg.")] = None,
    openF: Annotated[float | None, typer.Option("--openF", help="Its cut, mm.")] = None,
    move: Annotated[
        float | None, typer.Option(help="Its move along the tube, toward the closed end, mm.")
    ] = None,
    center: Annotated[
        float | None,
        typer.Option(
            "--alpha-center",
            help="Where its uncut sector is, deg: 270 bends toward the object, 90 away.",
        ),
    ] = None,
    change: Annotated[
        list[Edit] | None,
        typer.Option(
            parser=changed,
            metavar="JOINT:NAME=VALUE,...",
            help="As often as need be, of any joint: 2:alpha=103,openF=8,move=-2,center=90.",
        ),
    ] = None,
    pressure: Annotated[float | None, typer.Option(help="The operating pressure, bar.")] = None,
    **options: Any,
) -> None:
    """Change a design by hand; finite elements verify it anew, and every file is written."""
    asked = Again(**options)
    with exit_codes(asked.debug):
        one = Edit(joint, alpha, openF, move, pressure, center)
        edits = [*(change or [])] if one == Edit() and change else [*(change or []), one]
        _again(file, asked, "edited", edits=edits)


def report(file: DesignFile, **options: Any) -> None:
    """Verify a design as it is, such as one changed in its file, and write every file anew."""
    asked = Again(**options)
    with exit_codes(asked.debug):
        _again(file, asked, "report")


def refine(
    file: DesignFile,
    pressure: Annotated[
        float | None, typer.Option(help="The operating pressure, bar (default: what suits best).")
    ] = None,
    **options: Any,
) -> None:
    """Let finite elements correct the joints of a design, and write every file anew."""
    asked = Again(**options)
    with exit_codes(asked.debug):
        _again(file, asked, "refined", refined=True, pressure_bar=pressure)


for _command in (edit, report, refine):
    with_signature(_command, parameters_of(_command), parameters_of(Again))


def _again(
    given: Path,
    asked: Again,
    name: str,
    *,
    edits: Sequence[Edit] = (),
    refined: bool = False,
    pressure_bar: float | None = None,
) -> None:
    """Take a design up again, write its folder, and end with the exit code of its verdict."""
    from profiletool import api
    from profiletool.files import write
    from profiletool.files.design_json import load_design
    from profiletool.report import outputs
    from profiletool.verdict.summary import joint_table

    file, say = design_file(given), speaker(asked.quiet)
    folder = asked.out or Path(f"{Path(load_design(file).source.file).stem}_{name}")
    write.check_free(folder, asked.force)
    with progress_bar("finite elements", asked.quiet) as progress:
        result = api.design_again(
            file, say=say, progress=progress, formula=asked.formula, edits=edits, refine=refined,
            pressure_bar=pressure_bar,
        )  # fmt: skip
    files = outputs.files_of(result, paper=asked.paper)
    write.write_folder(folder, files, asked.force)
    text = files["design.json"].decode() if asked.as_json else joint_table(result.design)
    typer.echo(text, nl=False)
    conclude(result, folder, say, name)
