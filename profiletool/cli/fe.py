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
    OUTPUT,
    Debug,
    Force,
    Json,
    Quiet,
    exit_codes,
    progress_bar,
    speaker,
)
from profiletool.cli.rows import parameters_of, parameters_of_rows, with_signature
from profiletool.errors import Infeasible, NotVerified, UnreadableInput, UsageError
from profiletool.records.making import model_of
from profiletool.records.model import PAPER_MODEL, ModelInputs
from profiletool.records.options import MODEL

if TYPE_CHECKING:
    from formula.theta import Formula
    from profiletool.records.built import BuiltMisfit
    from profiletool.records.design import Design
    from profiletool.records.fe import Verification
    from profiletool.records.request import TubeSpec

_MOST_BAR = 20.0  # ten times what the tube bears

Out = Annotated[
    Path | None,
    typer.Option(help="Folder for tables, pictures and the deformed mesh.", rich_help_panel=OUTPUT),
]
Pressure = Annotated[float, typer.Option(help="Highest pressure, bar; ten equal steps lead there.")]


RubberName = Annotated[
    str | None,
    typer.Option(help="The rubber, as derive takes it: a preset, LAW:CONSTANTS, or a CSV."),
]
FormulaBeside = Annotated[
    Path | None,
    typer.Option(
        "--formula",
        help="A formula file, or by name paper or fe: its tube and rubber, and its angles beside.",
    ),
]


def in_tube(design: Design, tube: Path | None) -> Design:
    """Give a design the tube of a file, if one is named."""
    from profiletool.files.tube_json import load_tube
    from profiletool.records.calibrated import with_tube

    return design if tube is None else with_tube(design, load_tube(tube))


def joint(
    openF: Annotated[float, typer.Option("--openF", help="Axial length of the cut, mm.")],
    alpha: Annotated[float, typer.Option(help="Extent of the uncut sector, deg.")],
    pressure: Pressure = 2.0,
    alpha_center: Annotated[
        float, typer.Option(help="Middle of the uncut sector, deg: 270 toward the object, 90 away.")
    ] = 270.0,
    diameter: Annotated[
        float | None,
        typer.Option(help="Outer diameter of the tube, mm (default: the formula's, 20)."),
    ] = None,
    wall: Annotated[
        float | None, typer.Option(help="Wall of the tube, mm (default: the formula's, 2).")
    ] = None,
    rubber: RubberName = None,
    formula: FormulaBeside = None,
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
        check_run(pressure, out, force)
        if not 0.0 <= alpha_center <= 360.0:
            raise UsageError(f"--alpha-center must be 0 to 360, not {alpha_center:g}")
        from profiletool.files import write
        from profiletool.report import outputs
        from profiletool.report.fe import fe_json, fe_text, formula_json, formula_text
        from profiletool.verify.run import DOWN, LYING, breaking, inflate, pressures_to
        from profiletool.verify.tube import joint_actuator

        known = _formula(formula)
        spec = _spec(known, rubber, outer_diameter_mm=diameter, wall_mm=wall)
        with failures(UsageError), bar(pressure, quiet) as progress:
            actuator = joint_actuator(openF, alpha, alpha_center, spec, model)
            run = inflate(actuator, pressures_to(pressure), LYING, DOWN, progress=progress)
        run = breaking(run, spec.rubber)
        found = run.verification
        what = (
            f"one joint: openF {openF:g} mm, alpha_closed {alpha:g} deg, "
            f"alpha_center {alpha_center:g} deg{_beside(model)}"
        )
        cuts = [(openF, alpha)]
        told = fe_json(found, model_json(model) | formula_json(found, known, cuts))
        text = f"{what}\n{fe_text(found)}{formula_text(found, known, cuts)}"
        typer.echo(told if as_json else text, nl=False)
        if out is not None:
            write.write_folder(out, outputs.fe_files(run, what, told), force)
            speaker(quiet)(f"written: {out}")
        end(found)


def finger(
    pressure: Annotated[
        float, typer.Option(help="Highest pressure, bar; steps of 0.1 bar lead there.")
    ] = 2.3,
    rubber: RubberName = None,
    formula: FormulaBeside = None,
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
        check_run(pressure, out, force)
        from profiletool.files import write
        from profiletool.report import outputs
        from profiletool.report.fe import (
            fe_json,
            fe_text,
            formula_json,
            formula_text,
            ranges_json,
            ranges_text,
        )
        from profiletool.verify.run import DOWN, LYING, breaking, inflate, pressures_to
        from profiletool.verify.tube import FINGER, finger_actuator

        known = _formula(formula)
        spec = _spec(known, rubber)
        with failures(UsageError), bar(pressure, quiet) as progress:
            asked = pressures_to(pressure, 0.1)
            run = inflate(finger_actuator(model, spec), asked, LYING, DOWN, progress=progress)
        run = breaking(run, spec.rubber)
        found = run.verification
        more = ranges_json(found) | model_json(model) | formula_json(found, known, FINGER)
        told = fe_json(found, more)
        text = (
            f"the paper's finger (Table 2){_beside(model)}\n{fe_text(found)}{ranges_text(found)}"
            f"{formula_text(found, known, FINGER)}"
        )
        typer.echo(told if as_json else text, nl=False)
        if out is not None:
            title = "the paper's finger"
            files = outputs.fe_files(run, title, told, trajectories=True)
            write.write_folder(out, files, force)
            speaker(quiet)(f"written: {out}")
        end(found)


for _command in (joint, finger):
    with_signature(_command, parameters_of(_command), parameters_of_rows(MODEL))


def _formula(formula: Path | None) -> Formula | None:
    """Read the formula to compare with, where one is named."""
    from profiletool.files.formula import read_formula

    return None if formula is None else read_formula(formula)


def _spec(known: Formula | None, rubber: str | None, **sizes: float | None) -> TubeSpec:
    """Give the tube: what is given, else the formula's, else the paper's."""
    from profiletool.records.request import TubeSpec
    from profiletool.rubber.presets import parse_rubber

    spec = TubeSpec()
    if known is not None:
        spec = TubeSpec(known.outer_diameter_mm, known.wall_mm, rubber=known.rubber)
    given: dict[str, Any] = {k: size for k, size in sizes.items() if size is not None}
    if rubber is not None:
        spec = replace(spec, rubber=parse_rubber(rubber).record)
    return replace(spec, **given)


def _beside(model: ModelInputs) -> str:
    """Say what of the model is not the paper's."""
    return f"; {model}" if str(model) else ""


def model_json(model: ModelInputs, apart: BuiltMisfit | None = None) -> dict[str, Any]:
    """Make the entries of fe.json for a model that is not the paper's, and for single threads."""
    entries = {} if model == PAPER_MODEL else {"model": asdict(model)}
    return entries if apart is None else {**entries, "threads_off_mm": asdict(apart)}


def check_run(pressure: float | None, out: Path | None, force: bool) -> None:
    """Refuse what cannot be run or written, before it takes any time."""
    if pressure is not None and not (math.isfinite(pressure) and 0.0 < pressure <= _MOST_BAR):
        raise UsageError(
            f"--pressure must be above 0 and at most {_MOST_BAR:g} bar, not {pressure:g}"
        )
    if out is not None:
        from profiletool.files import write

        write.check_free(out, force)


@contextmanager
def failures(
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
def bar(most: float, quiet: bool) -> Iterator[Callable[[float], None]]:
    """Show how far the pressure has come, bar."""
    with progress_bar("finite elements", quiet) as show:

        def told(reached: float) -> None:
            if show is not None:
                show(reached / most)

        yield told


def end(found: Verification) -> None:
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
