"""The command that writes the finite-element model for other codes."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Annotated, Any, Literal

import typer

from profiletool.cli.console import Debug, Force, Quiet, exit_codes, speaker
from profiletool.cli.fe import bar, check_run, failures
from profiletool.cli.rows import parameters_of, parameters_of_rows, with_signature
from profiletool.errors import Infeasible, NotVerified, UnreadableInput, UsageError
from profiletool.records.making import model_of
from profiletool.records.options import MODEL


@dataclass(frozen=True)
class DeckOptions:
    """What deck to write."""

    code: Annotated[
        Literal["calculix", "abaqus", "ansys", "febio"],
        typer.Option("--for", help="The code that the deck is for."),
    ]
    mesh: Annotated[
        Literal["default", "paper"],
        typer.Option(
            help="Bricks of 20 nodes, fine at the cuts; or of 8 nodes and 2 mm, two through the "
            "wall, as in the paper."
        ),
    ] = "default"
    verify: Annotated[
        bool,
        typer.Option(
            "--verify/--no-verify", help="Run our own finite elements for the angles to expect."
        ),
    ] = True


def deck(
    file: Annotated[Path, typer.Argument(metavar="DESIGN.json", help="A design.json.")],
    pressure: Annotated[
        float | None,
        typer.Option(help="Highest pressure, bar (default: the design's own); ten equal steps."),
    ] = None,
    out: Annotated[
        Path | None, typer.Option(help="Output folder (default: name + _ + code).")
    ] = None,
    force: Force = False,
    quiet: Quiet = False,
    debug: Debug = False,
    **options: Any,
) -> None:
    """Write the finite-element model of a design for another code.

    Beside the deck lie a cube that checks the rubber, the angles to expect, and how to run it.
    """
    with exit_codes(debug):
        asked = DeckOptions(**{row.name: options.pop(row.name) for row in fields(DeckOptions)})
        folder = out or Path(f"{file.stem}_{asked.code}")
        check_run(pressure, folder, force)
        from profiletool.files import write
        from profiletool.files.design_json import load_design
        from profiletool.report import outputs
        from profiletool.report.deck import make_deck_output

        design = load_design(file)
        design = replace(design, model=model_of(options, design.model))
        if design.model.gravity != "none":
            raise UsageError("a deck holds no weight: leave it out with `gravity` none")
        most = design.pressure_bar if pressure is None else pressure
        check_run(most, None, force)
        wrong = UnreadableInput if design.feasible else Infeasible
        with failures(wrong, f"{file}: "), bar(most, quiet) as progress:
            made = make_deck_output(
                design, asked.code, asked.mesh, most, solve=asked.verify, progress=progress
            )
        write.write_folder(folder, outputs.deck_files(made), force)
        speaker(quiet)(f"written: {folder}")
        if made.reached_bar < most - 1e-9:
            raise NotVerified(
                f"our own finite elements came to {made.reached_bar:.2f} bar, not to the "
                f"{most:.2f} bar of the deck; ask for less with --pressure"
            )


with_signature(deck, parameters_of(deck), parameters_of(DeckOptions), parameters_of_rows(MODEL))
