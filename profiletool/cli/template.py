"""The commands that draw for printer and cutter, and the options they share with `design`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import typer

from profiletool.cli.console import (
    OUTPUT,
    Debug,
    DesignFile,
    Force,
    Quiet,
    changed_notes,
    design_file,
    exit_codes,
    speaker,
)

Paper = Annotated[
    Literal["a4", "letter"],
    typer.Option(help="Pages of the PDFs; larger pieces are tiled.", rich_help_panel=OUTPUT),
]
Kerf = Annotated[
    float,
    typer.Option(
        help="Width that the beam or blade takes away, mm: lines move by half.",
        rich_help_panel=OUTPUT,
    ),
]
Date = Annotated[
    str,
    typer.Option(help="Date to print on the template, in any form.", rich_help_panel=OUTPUT),
]


def template(
    file: DesignFile,
    variant: Annotated[
        Literal["gauze", "sleeve", "strip"],
        typer.Option(
            help="The gauze to roll up, one turn for a seamless sleeve, or a paper strip to wrap "
            "around the rolled gauze and mark through."
        ),
    ] = "gauze",
    kerf: Kerf = 0.0,
    date: Date = "",
    paper: Paper = "a4",
    dxf: Annotated[
        Literal["R2000", "R12"],
        typer.Option(help="Version of the DXF; R12 knows no units: tell its reader mm."),
    ] = "R2000",
    out: Annotated[
        Path | None, typer.Option(help="Output folder (default: the object's name + _template).")
    ] = None,
    force: Force = False,
    quiet: Quiet = False,
    debug: Debug = False,
) -> None:
    """Draw the cut template of a design anew, or for another way to make it."""
    with exit_codes(debug):
        from profiletool.files import write
        from profiletool.files.design_json import load_design, to_json
        from profiletool.report import outputs
        from profiletool.template.kerf import check_kerf
        from profiletool.template.kinds import Wish

        made = load_design(design_file(file))
        folder = out or Path(f"{Path(made.source.file).stem}_template")
        write.check_free(folder, force)
        say = speaker(quiet)
        for note in changed_notes(made):
            say(f"note: {note}")
        check_kerf(kerf, made.gauze.pitch_mm, made.gauze.thread_mm)
        files = outputs.template_files(made, Wish(variant, kerf, date), paper, dxf)
        files["design.json"] = to_json(made).encode()
        write.write_folder(folder, files, force)
        say(f"written: {folder}")


def sheet(
    paper: Paper = "a4",
    out: Annotated[Path | None, typer.Option(help="File (default: sheet_ + paper + .pdf).")] = None,
    force: Force = False,
    quiet: Quiet = False,
    debug: Debug = False,
) -> None:
    """Print the calibration sheet: an object photographed on it needs no size given."""
    with exit_codes(debug):
        from profiletool.files import write
        from profiletool.template.calibration import calibration_sheet

        file = out or Path(f"sheet_{paper}.pdf")
        write.write_file(file, calibration_sheet(paper), force)
        say = speaker(quiet)
        say("print at 100 %, measure both bars, lay the object in the field with its top up")
        say(f"written: {file}")
