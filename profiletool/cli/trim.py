"""The command that sets a finished actuator: parse, call, print, exit codes; nothing else."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from profiletool.cli.console import Debug, DesignFile, Json, Numbers, design_file, exit_codes, two
from profiletool.errors import Infeasible, UnreadableInput, UsageError


def trim(
    file: DesignFile,
    tip: Annotated[
        Numbers | None,
        typer.Option(
            parser=two,
            metavar="X,Y",
            help="Where the tip stands, mm in the object's frame; needs --at.",
        ),
    ] = None,
    at: Annotated[
        float | None, typer.Option(metavar="BAR", help="Pressure that the tip was measured at.")
    ] = None,
    angles: Annotated[
        Path | None,
        typer.Option(
            metavar="ANGLES.csv",
            help="Measured angles: columns pressure_bar, joint, theta_deg, and sigma_deg if known.",
        ),
    ] = None,
    as_json: Json = False,
    debug: Debug = False,
) -> None:
    """Find the pressure at which a finished actuator fits, from its tip or its angles."""
    with exit_codes(debug):
        if (tip is None) == (angles is None):
            raise UsageError("give one of --tip and --angles, to say where the actuator stands")
        if (tip is None) != (at is None):
            raise UsageError("--tip and --at go together: where the tip stands, and at what bar")
        from profiletool.files.angles_csv import read_angles
        from profiletool.files.design_json import load_design
        from profiletool.report.setting import setting_json, setting_text
        from profiletool.verify.setting import by_angles, by_tip

        file = design_file(file)
        design = load_design(file)
        readings = () if angles is None else read_angles(angles)
        try:
            if tip is None or at is None:
                found = by_angles(design, readings)
            else:
                found = by_tip(design, (tip[0], tip[1]), at)
        except (UnreadableInput, Infeasible) as error:
            raise type(error)(f"{file}: {error}") from error
        typer.echo(setting_json(found) if as_json else setting_text(found), nl=False)
