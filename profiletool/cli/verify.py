"""The command `verify`: parse, call, print, exit codes; nothing else."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from profiletool.cli.console import (
    KEPT,
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
from profiletool.cli.fe import Out, bar, check_run, end, failures, in_tube, model_json
from profiletool.cli.rows import parameters_of, parameters_of_rows, with_signature
from profiletool.cli.samples import SampleOptions, sampled, taken
from profiletool.errors import Infeasible, NotVerified, UnreadableInput
from profiletool.records.making import model_of
from profiletool.records.model import ModelInputs
from profiletool.records.options import MODEL

if TYPE_CHECKING:
    from profiletool.records.built import BuiltMisfit
    from profiletool.records.design import Design
    from profiletool.records.fe import Verification
    from profiletool.records.units import FloatArray
    from profiletool.subject.recall import Target
    from profiletool.verify.run import Run


_KEPT = "stopped: every finished sample is kept; the same command goes on from there"


def verify(
    file: DesignFile,
    pressure: Annotated[
        float | None,
        typer.Option(help="Highest pressure, bar (default: the design's own); ten equal steps."),
    ] = None,
    threads: Annotated[
        bool,
        typer.Option(
            "--threads", help="Run the single threads of each sector, too, beside the smeared."
        ),
    ] = False,
    out: Out = None,
    force: Force = False,
    as_json: Json = False,
    quiet: Quiet = False,
    debug: Debug = False,
    **options: Any,
) -> None:
    """Run finite elements of a whole actuator, and compare it with its target.

    The target is taken from the shape.csv beside DESIGN.json, or from the drawing that the
    design was made from.
    """
    with exit_codes(debug, _KEPT if options.get("samples") else KEPT):
        check_run(pressure, out, force)
        from profiletool.files.design_json import load_design
        from profiletool.report.fe import fe_json
        from profiletool.report.sampled import samples_text, samples_tree
        from profiletool.subject.recall import target_of
        from profiletool.verify.run import run_design

        asked, file = taken(options), design_file(file)
        design = in_tube(load_design(file), options.pop("tube"))
        for note in changed_notes(design):
            speaker(quiet)(f"note: {note}")
        design = replace(design, model=model_of(options, design.model))
        most = design.pressure_bar if pressure is None else pressure
        check_run(most, None, force)
        wrong = UnreadableInput if design.feasible else Infeasible
        with failures(wrong, f"{file}: "), bar(most, quiet) as progress:
            run = run_design(design, most, progress)
        found = run.verification
        target = target_of(design, file)
        more, text = _compared(design, found, target, threads)
        if asked.samples is not None:
            points = None if target is None or pressure is not None else target.points
            both = sampled(design, run, points, asked, quiet)
            more |= samples_tree(*both)
            text += samples_text(*both)
        told = fe_json(found, more)
        typer.echo(told if as_json else text, nl=False)
        if out is not None:
            points = None if target is None else target.points
            _write(out, force, run, design, told, points)
            speaker(quiet)(f"written: {out}")
        end(found)


def _write(
    out: Path, force: bool, run: Run, design: Design, told: str, points: FloatArray | None
) -> None:
    from profiletool.files import write
    from profiletool.report import outputs
    from profiletool.report.dossier import formula_marks

    files = outputs.fe_files(run, design.source.file, told, points, formula_marks(design))
    write.write_folder(out, files, force)


def _compared(
    design: Design, found: Verification, target: Target | None, threads: bool
) -> tuple[dict[str, Any], str]:
    """Compare a run with its target, and the smeared gauze with single threads: JSON and text."""
    from profiletool.report.fe import compared_text, fe_text, misfit_json, off_target

    off = None if target is None else off_target(found, target.points)
    beside = None if target is None else target.file
    apart = _single_threads(design) if threads else None
    more = misfit_json(off, beside) | model_json(design.model, apart)
    text = fe_text(found) + compared_text(design, found, off, beside)
    return more, text + _model_text(design.model, apart)


with_signature(
    verify,
    parameters_of(verify),
    parameters_of(TubeOptions),
    parameters_of(SampleOptions),
    parameters_of_rows(MODEL),
)


def _single_threads(design: Design) -> BuiltMisfit:
    """Say how far the sheet's threads move the shape, at the design's own pressure.

    Raises
    ------
    NotVerified
    """
    from fem.errors import FemError
    from profiletool.verify.threads import sheet_off

    try:
        return sheet_off(design)
    except FemError as error:
        raise NotVerified(f"with single threads: {error}") from error


def _model_text(model: ModelInputs, apart: BuiltMisfit | None) -> str:
    """Say what of the model is not the paper's, and what single threads do."""
    from profiletool.records.built import mm_text

    text = f"not the paper's model: {model}\n" if str(model) else ""
    if apart is not None:
        text += (
            f"single threads lie {mm_text(apart.as_set)} mm RMS off the smeared gauze, "
            f"{mm_text(apart.trimmed)} once the pressure is set\n"
        )
    return text
