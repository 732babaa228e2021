"""The commands of the paper's table procedure: parse, call, print, exit codes; nothing else."""

from __future__ import annotations

from typing import Annotated

import typer

from profiletool.cli.console import (
    Debug,
    Extrapolate,
    FormulaFile,
    Json,
    Numbers,
    exit_codes,
    numbers,
)
from profiletool.errors import Infeasible, UsageError


def table(
    openF: Annotated[
        Numbers | None,
        typer.Option("--openF", parser=numbers, metavar="MM,...", help="Cuts (default: 6,8,10)."),
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
            made = make_table(read_formula(formula, extrapolate), openF_mm=openF)
        except OutOfRange as error:
            raise UsageError(str(error)) from error
        if as_json and as_csv:
            raise UsageError("--json and --csv exclude each other")
        layout = theta_json if as_json else theta_csv if as_csv else theta_text
        typer.echo(layout(made), nl=False)


def assign(
    openF: Annotated[
        Numbers,
        typer.Option("--openF", parser=numbers, metavar="MM,...", help="Cut of every joint, mm."),
    ],
    theta: Annotated[
        Numbers, typer.Option(parser=numbers, metavar="DEG,...", help="Angle of every joint, deg.")
    ],
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

        if len(openF) != len(theta):
            raise UsageError(
                f"--openF has {len(openF)} numbers, --theta {len(theta)}: give one each per joint"
            )
        if min(theta) <= 0.0:
            raise UsageError("--theta takes angles above 0; their direction does not matter here")
        try:
            known = make_table(read_formula(formula, extrapolate), openF_mm=openF)
            found = look_up(known, openF, theta)
        except OutOfRange as error:
            raise Infeasible(str(error)) from error
        text = assignment_json(found) if as_json else assignment_text(openF, theta, found)
        typer.echo(text, nl=False)
