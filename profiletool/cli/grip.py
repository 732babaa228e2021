"""The command `grip`: parse, call, print, exit codes; nothing else."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import typer

from profiletool.cli.console import (
    Debug,
    DesignFile,
    Force,
    Json,
    Quiet,
    TubeOptions,
    changed_notes,
    design_file,
    exit_codes,
    speaker,
)
from profiletool.cli.fe import Out, bar, check_run, failures, in_tube
from profiletool.cli.rows import parameters_of, parameters_of_rows, with_signature
from profiletool.errors import NotVerified, UnreadableInput
from profiletool.records.grip_request import GripRequest
from profiletool.records.making import model_of
from profiletool.records.options import GRIP, MODEL


def grip(
    file: DesignFile,
    out: Out = None,
    force: Force = False,
    as_json: Json = False,
    quiet: Quiet = False,
    debug: Debug = False,
    **options: Any,
) -> None:
    """Run finite elements of a finger against its object: forces, contact pressure, payload.

    The object is the profile turned about its axis, rigid and without friction; friction counts
    in what the fingers carry.
    """
    with exit_codes(debug):
        check_run(None, out, force)
        from profiletool.files import write
        from profiletool.files.design_json import load_design
        from profiletool.report import outputs
        from profiletool.report.grip import GripOutput, grip_json, grip_text
        from profiletool.subject.recall import target_of
        from profiletool.verify.grip import run_grip

        own = {row.field: options.pop(row.field) for row in GRIP}
        asked = GripRequest(**{name: value for name, value in own.items() if value is not None})
        file = design_file(file)
        design = in_tube(load_design(file), options.pop("tube"))
        for note in changed_notes(design):
            speaker(quiet)(f"note: {note}")
        design = replace(design, model=model_of(options, design.model))
        target = target_of(design, file)
        if target is None:
            raise UnreadableInput(
                f"{file}: no target beside it: shape.csv of its folder tells what the object is "
                "like; keep both together"
            )
        most = max(asked.pressures_bar, default=1.2 * design.pressure_bar)
        check_run(most, None, force)
        with failures(UnreadableInput, f"{file}: "), bar(most, quiet) as progress:
            found = run_grip(design, target.points, asked, progress)
        told = grip_json(found)
        typer.echo(told if as_json else grip_text(found, asked), nl=False)
        if out is not None:
            files = outputs.grip_files(GripOutput(found, asked, target.points, told))
            write.write_folder(out, files, force)
            speaker(quiet)(f"written: {out}")
        if found.failure is not None:
            advice = "; ask for less with `pressures_bar`" if found.states else ""
            raise NotVerified(f"{found.failure}{advice}")


with_signature(
    grip,
    parameters_of(grip),
    parameters_of(TubeOptions),
    parameters_of_rows(GRIP, GripRequest()),
    parameters_of_rows(MODEL),
)
