"""The commands that run finite elements: parse, call, print, exit codes; nothing else."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import asdict, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from profiletool.cli.console import (
    Debug,
    DesignFile,
    Json,
    Quiet,
    changed_notes,
    design_file,
    exit_codes,
    progress_bar,
    speaker,
)
from profiletool.cli.rows import parameters_of, parameters_of_rows, with_signature
from profiletool.cli.samples import SampleOptions, sampled, taken
from profiletool.errors import Infeasible, NotVerified, UnreadableInput, UsageError
from profiletool.records.making import model_of
from profiletool.records.model import PAPER_MODEL, ModelInputs
from profiletool.records.options import MODEL

if TYPE_CHECKING:
    from profiletool.records.built import BuiltMisfit
    from profiletool.records.design import Design
    from profiletool.records.fe import Verification
    from profiletool.subject.recall import Target

_MOST_BAR = 20.0  # ten times what the tube bears

Out = Annotated[
    Path | None, typer.Option(help="Folder for tables, pictures and the deformed mesh.")
]
Force = Annotated[bool, typer.Option("--force", help="Replace an earlier folder of results.")]
Pressure = Annotated[float, typer.Option(help="Highest pressure, bar; ten equal steps lead there.")]


def joint(
    openF: Annotated[float, typer.Option("--openF", help="Axial length of the cut, mm.")],
    alpha: Annotated[float, typer.Option(help="Extent of the uncut sector, deg.")],
    pressure: Pressure = 2.0,
    alpha_center: Annotated[
        float, typer.Option(help="Middle of the uncut sector, deg: 270 toward the object, 90 away.")
    ] = 270.0,
    diameter: Annotated[float, typer.Option(help="Outer diameter of the tube, mm.")] = 20.0,
    wall: Annotated[float, typer.Option(help="Wall of the tube, mm.")] = 2.0,
    out: Out = None,
    force: Force = False,
    as_json: Json = False,
    quiet: Quiet = False,
    debug: Debug = False,
    **options: Any,
) -> None:
    """Run finite elements of one joint, Root = F1 = 30 mm."""
    with exit_codes(debug):
        model = model_of(options, PAPER_MODEL)
        _check_run(pressure, out, force)
        if not 0.0 <= alpha_center <= 360.0:
            raise UsageError(f"--alpha-center must be 0 to 360, not {alpha_center:g}")
        from profiletool import outputs
        from profiletool.files import write
        from profiletool.records.request import TubeSpec
        from profiletool.report.fe import fe_json, fe_text
        from profiletool.verify.run import DOWN, LYING, inflate, pressures_to
        from profiletool.verify.tube import joint_actuator

        spec = TubeSpec(outer_diameter_mm=diameter, wall_mm=wall)
        with _failures(UsageError), _bar(pressure, quiet) as progress:
            actuator = joint_actuator(openF, alpha, alpha_center, spec, model)
            run = inflate(actuator, pressures_to(pressure), LYING, DOWN, progress=progress)
        found = run.verification
        what = (
            f"one joint: openF {openF:g} mm, alpha_closed {alpha:g} deg, "
            f"alpha_center {alpha_center:g} deg{_beside(model)}"
        )
        told = fe_json(found, _model_json(model))
        typer.echo(told if as_json else f"{what}\n{fe_text(found)}", nl=False)
        if out is not None:
            write.write_folder(out, outputs.fe_files(run, what, told), force)
            speaker(quiet)(f"written: {out}")
        _end(found)


def finger(
    pressure: Annotated[
        float, typer.Option(help="Highest pressure, bar; steps of 0.1 bar lead there.")
    ] = 2.3,
    out: Out = None,
    force: Force = False,
    as_json: Json = False,
    quiet: Quiet = False,
    debug: Debug = False,
    **options: Any,
) -> None:
    """Run finite elements of the paper's three-joint finger (Table 2)."""
    with exit_codes(debug):
        model = model_of(options, PAPER_MODEL)
        _check_run(pressure, out, force)
        from profiletool import outputs
        from profiletool.files import write
        from profiletool.report.fe import fe_json, fe_text, ranges_json, ranges_text
        from profiletool.verify.run import DOWN, LYING, inflate, pressures_to
        from profiletool.verify.tube import finger_actuator

        with _failures(UsageError), _bar(pressure, quiet) as progress:
            asked = pressures_to(pressure, 0.1)
            run = inflate(finger_actuator(model), asked, LYING, DOWN, progress=progress)
        found = run.verification
        told = fe_json(found, ranges_json(found) | _model_json(model))
        text = f"the paper's finger (Table 2){_beside(model)}\n{fe_text(found)}{ranges_text(found)}"
        typer.echo(told if as_json else text, nl=False)
        if out is not None:
            title = "the paper's finger"
            files = outputs.fe_files(run, title, told, trajectories=True)
            write.write_folder(out, files, force)
            speaker(quiet)(f"written: {out}")
        _end(found)


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
    with exit_codes(debug):
        _check_run(pressure, out, force)
        from profiletool import outputs
        from profiletool.files import write
        from profiletool.files.design_json import load_design
        from profiletool.report.dossier import formula_marks
        from profiletool.report.fe import fe_json
        from profiletool.report.sampled import samples_text, samples_tree
        from profiletool.subject.recall import target_of
        from profiletool.verify.run import run_design

        asked, file = taken(options), design_file(file)
        design = load_design(file)
        for note in changed_notes(design):
            speaker(quiet)(f"note: {note}")
        design = replace(design, model=model_of(options, design.model))
        most = design.pressure_bar if pressure is None else pressure
        _check_run(most, None, force)
        wrong = UnreadableInput if design.feasible else Infeasible
        with _failures(wrong, f"{file}: "), _bar(most, quiet) as progress:
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
            marks = formula_marks(design)
            files = outputs.fe_files(run, design.source.file, told, points, marks)
            write.write_folder(out, files, force)
            speaker(quiet)(f"written: {out}")
        _end(found)


def _compared(
    design: Design, found: Verification, target: Target | None, threads: bool
) -> tuple[dict[str, Any], str]:
    """Compare a run with its target, and the smeared gauze with single threads: JSON and text."""
    from profiletool.report.fe import compared_text, fe_text, misfit_json, off_target

    off = None if target is None else off_target(found, target.points)
    beside = None if target is None else target.file
    apart = _single_threads(design) if threads else None
    more = misfit_json(off, beside) | _model_json(design.model, apart)
    text = fe_text(found) + compared_text(design, found, off, beside)
    return more, text + _model_text(design.model, apart)


for _command in (joint, finger):
    with_signature(_command, parameters_of(_command), parameters_of_rows(MODEL))
with_signature(
    verify, parameters_of(verify), parameters_of(SampleOptions), parameters_of_rows(MODEL)
)


def _single_threads(design: Design) -> BuiltMisfit:
    """Say how far the sheet's threads move the shape, at the design's own pressure.

    Raises
    ------
    NotVerified
    """
    from fem.errors import FemError
    from profiletool.verify.threads import with_threads

    try:
        off = with_threads(design).threads_off_mm
    except FemError as error:
        raise NotVerified(f"with single threads: {error}") from error
    assert off is not None
    return off


def _beside(model: ModelInputs) -> str:
    """Say what of the model is not the paper's."""
    return f"; {model}" if str(model) else ""


def _model_json(model: ModelInputs, apart: BuiltMisfit | None = None) -> dict[str, Any]:
    """Make the entries of fe.json for a model that is not the paper's, and for single threads."""
    entries = {} if model == PAPER_MODEL else {"model": asdict(model)}
    return entries if apart is None else {**entries, "threads_off_mm": asdict(apart)}


def _model_text(model: ModelInputs, apart: BuiltMisfit | None) -> str:
    """Say what of the model is not the paper's, and what single threads do."""
    text = f"not the paper's model: {model}\n" if str(model) else ""
    if apart is not None:
        text += (
            f"single threads lie {apart.as_set:.2f} mm RMS off the smeared gauze, "
            f"{apart.trimmed:.2f} once the pressure is set\n"
        )
    return text


def _check_run(pressure: float | None, out: Path | None, force: bool) -> None:
    """Refuse what cannot be run or written, before it takes any time."""
    if pressure is not None and not (math.isfinite(pressure) and 0.0 < pressure <= _MOST_BAR):
        raise UsageError(
            f"--pressure must be above 0 and at most {_MOST_BAR:g} bar, not {pressure:g}"
        )
    if out is not None:
        from profiletool.files import write

        write.check_free(out, force)


@contextmanager
def _failures(
    geometry: type[UsageError] | type[UnreadableInput] | type[Infeasible], where: str = ""
) -> Iterator[None]:
    """Turn what finite elements raise into our errors."""
    from fem.errors import BadGeometry, NotConverged
    from profiletool.verify.run import shortly

    try:
        yield
    except BadGeometry as error:
        raise geometry(f"{where}{error}") from error
    except NotConverged as error:
        raise NotVerified(f"{where}{shortly(error)}; ask for less with --pressure") from error


@contextmanager
def _bar(most: float, quiet: bool) -> Iterator[Callable[[float], None]]:
    """Show how far the pressure has come, bar."""
    with progress_bar("finite elements", quiet) as show:

        def told(reached: float) -> None:
            if show is not None:
                show(reached / most)

        yield told


def _end(found: Verification) -> None:
    """Say so where a run ended early, or would end a little above the pressure asked for.

    Raises
    ------
    NotVerified
    """
    from profiletool.verify.run import reason, too_little

    if found.ahead is not None:
        raise NotVerified(f"{too_little(found)}; ask for less with --pressure")
    if not found.converged:
        raise NotVerified(
            f"{reason(found)}, before the {found.asked_bar:.2f} bar asked for; "
            "ask for less with --pressure"
        )
