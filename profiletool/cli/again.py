"""The commands that take a design.json up again: parse, call, print, exit codes; nothing else."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from profiletool.cli.console import (
    Debug,
    DesignFile,
    Force,
    FormulaFile,
    Quiet,
    design_file,
    exit_codes,
    progress_bar,
    speaker,
)
from profiletool.cli.design import conclude
from profiletool.cli.rows import parameters_of, with_signature
from profiletool.cli.template import Paper

if TYPE_CHECKING:
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
    pressure: Annotated[float | None, typer.Option(help="The operating pressure, bar.")] = None,
    **options: Any,
) -> None:
    """Change a design by hand; finite elements verify it anew, and every file is written."""
    asked = Again(**options)
    with exit_codes(asked.debug):
        from profiletool.records.edit import Edit

        change = Edit(joint, alpha, openF, move, pressure)
        _again(file, asked, "edited", change=change)


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
    change: Edit | None = None,
    refined: bool = False,
    pressure_bar: float | None = None,
) -> None:
    """Take a design up again, write its folder, and end with the exit code of its verdict."""
    from profiletool import outputs, pipeline
    from profiletool.files import write
    from profiletool.files.design_json import load_design
    from profiletool.files.formula import named_formula, read_formula
    from profiletool.subject.recall import profile_of
    from profiletool.verdict.summary import joint_table

    file, say = design_file(given), speaker(asked.quiet)
    design = load_design(file)
    folder = asked.out or Path(f"{Path(design.source.file).stem}_{name}")
    write.check_free(folder, asked.force)
    profile = profile_of(design, file)
    other = asked.formula
    formula = named_formula(design.formula.name) if other is None else read_formula(other)
    with progress_bar("finite elements", asked.quiet) as progress:
        result = pipeline.run_again(
            design, profile, formula, say, progress, edit=change, refine=refined,
            pressure_bar=pressure_bar,
        )  # fmt: skip
    files = outputs.files_of(result, paper=asked.paper)
    write.write_folder(folder, files, asked.force)
    text = files["design.json"].decode() if asked.as_json else joint_table(result.design)
    typer.echo(text, nl=False)
    conclude(result, folder, say, name)
