"""The command that sets a finished actuator: parse, call, print, exit codes; nothing else."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from profiletool.cli.console import (
    Debug,
    DesignFile,
    Json,
    Numbers,
    TubeFile,
    design_file,
    exit_codes,
    two,
)
from profiletool.errors import Infeasible, UnreadableInput, UsageError

if TYPE_CHECKING:
    from profiletool.records.design import Design
    from profiletool.records.setting import PressureSetting


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
    tube: TubeFile = None,
    as_json: Json = False,
    debug: Debug = False,
) -> None:
    """Find the pressure at which a finished actuator fits: from its tip, angles, or tube file."""
    with exit_codes(debug):
        if [tip, angles, tube].count(None) != 2:
            raise UsageError(
                "give one of --tip, --angles and --tube, to say where the actuator stands"
            )
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
            if tube is not None:
                found = _by_tube(design, file, tube)
            elif tip is None or at is None:
                found = by_angles(design, readings)
            else:
                found = by_tip(design, (tip[0], tip[1]), at)
        except (UnreadableInput, Infeasible) as error:
            raise type(error)(f"{file}: {error}") from error
        typer.echo(setting_json(found) if as_json else setting_text(found), nl=False)


def _by_tube(design: Design, file: Path, tube: Path) -> PressureSetting:
    from profiletool.files.tube_json import load_tube
    from profiletool.subject.recall import profile_of
    from profiletool.verify.tube_setting import by_tube

    return by_tube(design, load_tube(tube), profile_of(design, file).points)
