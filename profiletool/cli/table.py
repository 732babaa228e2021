"""The commands of the paper's table procedure: parse, call, print, exit codes; nothing else."""

from __future__ import annotations

from typing import Annotated

import typer

from profiletool.cli.console import Debug, Extrapolate, FormulaFile, Json, exit_codes, numbers
from profiletool.errors import Infeasible, UsageError


def table(
    openF: Annotated[
        str | None, typer.Option("--openF", help="Cuts, mm, with commas (default: 6,8,10).")
    ] = None,
    formula: FormulaFile = None,
    extrapolate: Extrapolate = False,
    as_json: Json = False,
    as_csv: Annotated[bool, typer.Option("--csv", help="Print the table as CSV.")] = False,
    debug: Debug = False,
) -> None:
    """Print the theta table of a formula (the paper's Table 4)."""
    with exit_codes(debug):
        from formula.errors import OutOfRange
        from formula.table import make_table
        from profiletool.files.formula import read_formula
        from profiletool.report.text import theta_csv, theta_json, theta_text

        try:
            cuts = None if openF is None else numbers("--openF", openF)
            made = make_table(read_formula(formula, extrapolate), openF_mm=cuts)
        except OutOfRange as error:
            raise UsageError(str(error)) from error
        if as_json and as_csv:
            raise UsageError("--json and --csv exclude each other")
        layout = theta_json if as_json else theta_csv if as_csv else theta_text
        typer.echo(layout(made), nl=False)


def assign(
    openF: Annotated[str, typer.Option("--openF", help="Cut of every joint, mm, with commas.")],
    theta: Annotated[str, typer.Option("--theta", help="Angle of every joint, deg, with commas.")],
    formula: FormulaFile = None,
    extrapolate: Extrapolate = False,
    as_json: Json = False,
    debug: Debug = False,
) -> None:
    """Choose pressure and alpha for given joints by the paper's table procedure."""
    with exit_codes(debug):
        from formula.errors import OutOfRange
        from formula.table import assign as look_up
        from formula.table import make_table
        from profiletool.files.formula import read_formula
        from profiletool.report.text import assignment_json, assignment_text

        cuts, angles = numbers("--openF", openF), numbers("--theta", theta)
        if len(cuts) != len(angles):
            raise UsageError(
                f"--openF has {len(cuts)} numbers, --theta {len(angles)}: give one each per joint"
            )
        if min(angles) <= 0.0:
            raise UsageError("--theta takes angles above 0; their direction does not matter here")
        try:
            known = make_table(read_formula(formula, extrapolate), openF_mm=cuts)
            found = look_up(known, cuts, angles)
        except OutOfRange as error:
            raise Infeasible(str(error)) from error
        text = assignment_json(found) if as_json else assignment_text(cuts, angles, found)
        typer.echo(text, nl=False)
