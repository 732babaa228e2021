"""The command `design`: parse, call, print, exit codes; nothing else."""

from __future__ import annotations

import itertools
from pathlib import Path
from typing import Annotated, Literal

import typer

from profiletool.cli.config import take_config
from profiletool.cli.console import (
    Debug,
    Extrapolate,
    FormulaFile,
    Quiet,
    degrees,
    exit_codes,
    four,
    progress_bar,
    speaker,
    two,
)
from profiletool.cli.template import Date, Kerf, Paper
from profiletool.errors import Infeasible, NoObject, NotVerified, Unsure, UsageError


def _doubted(unsure: Unsure, name: str) -> NoObject:
    """Draw what the object could be, and say where: never over another file."""
    from profiletool import outputs
    from profiletool.files import write

    names = itertools.chain([name], (f"{name}_{k}" for k in itertools.count(2)))
    file = next(file for one in names if not (file := Path(f"{one}.png")).exists())
    write.write_file(file, outputs.candidates_png(unsure), force=False)
    return NoObject(f"{unsure}; {file} shows what it could be")


def design(
    picture: Annotated[
        Path,
        typer.Argument(
            metavar="PICTURE",
            help="PNG, JPEG, TIFF, BMP or WebP of one object; or a profile as DXF, SVG or CSV.",
        ),
    ],
    height: Annotated[float | None, typer.Option(help="Full height of the object, mm.")] = None,
    width: Annotated[float | None, typer.Option(help="Full width of the object, mm.")] = None,
    mm_per_px: Annotated[float | None, typer.Option(help="Millimetres per pixel.")] = None,
    marker_mm: Annotated[
        float | None, typer.Option(help="Side of an ArUco DICT_4X4_50 marker in the picture, mm.")
    ] = None,
    camera_distance: Annotated[
        float | None,
        typer.Option(help="From the lens to the marker's or printed sheet's plane, mm: parallax."),
    ] = None,
    box: Annotated[
        str | None, typer.Option(metavar="X,Y,W,H", help="The object lies in this box, px.")
    ] = None,
    point: Annotated[
        str | None, typer.Option(metavar="X,Y", help="A point inside the object, px.")
    ] = None,
    mask: Annotated[
        Path | None,
        typer.Option(help="The object in white on black, a picture of the same size."),
    ] = None,
    rotate: Annotated[
        str,
        typer.Option(
            metavar="auto|DEG",
            help="Turn the object, deg counter-clockwise; auto: its axis upright.",
        ),
    ] = "0",
    symmetric: Annotated[
        bool, typer.Option("--symmetric", help="Take the mean of the object's two sides.")
    ] = False,
    side: Annotated[
        Literal["left", "right"], typer.Option(help="Side of the object to follow.")
    ] = "left",
    start: Annotated[
        float, typer.Option("--from", help="Start of the stretch, % of that side from the top.")
    ] = 0.0,
    end: Annotated[float, typer.Option("--to", help="End of the stretch, %.")] = 100.0,
    clearance: Annotated[float, typer.Option(help="Gap between tube and object, mm.")] = 0.0,
    diameter: Annotated[
        float | None,
        typer.Option(help="Outer diameter of the tube, mm (default: the formula's, 20)."),
    ] = None,
    wall: Annotated[
        float | None, typer.Option(help="Wall of the tube, mm (default: the formula's, 2).")
    ] = None,
    root: Annotated[
        float, typer.Option(help="Least clamped length before the first joint's centre, mm.")
    ] = 10.0,
    pitch: Annotated[float, typer.Option(help="Mesh pitch of the gauze, mm.")] = 2.0,
    max_pressure: Annotated[float, typer.Option(help="Highest pressure, bar.")] = 2.0,
    max_length: Annotated[float, typer.Option(help="Longest tube, mm.")] = 250.0,
    formula: FormulaFile = None,
    extrapolate: Extrapolate = False,
    method: Annotated[
        Literal["optimal", "paper"],
        typer.Option(help="How joints are chosen: all at once, or one by one as the paper does."),
    ] = "optimal",
    joints: Annotated[
        int | None,
        typer.Option(min=1, help="Number of joints (default: as few as reach --tolerance)."),
    ] = None,
    tolerance: Annotated[
        float | None,
        typer.Option(
            help="How far the shape may lie off the profile, mm: RMS (default: joints are added "
            "down to 0.25 by the joint response, and 1 % of the length will do), or for --method "
            "paper the polygon of joints at most (default: 1)."
        ),
    ] = None,
    interference: Annotated[
        float, typer.Option(help="How deep the tube may lie in the object, mm (optimal).")
    ] = 0.3,
    base_free: Annotated[
        bool,
        typer.Option(
            "--base-free", help="Let the base leave the profile's start tangent (optimal)."
        ),
    ] = False,
    alpha_step: Annotated[
        float | None,
        typer.Option(help="Step of alpha, deg (default: one thread; 0: any; optimal)."),
    ] = None,
    place_step: Annotated[
        float, typer.Option(help="Step of the joints' places, mm (0: any; optimal).")
    ] = 1.0,
    verify: Annotated[
        bool,
        typer.Option(help="Run finite elements of the whole actuator: some seconds."),
    ] = True,
    refine: Annotated[
        bool, typer.Option(help="Let finite elements correct the design (optimal; needs verify).")
    ] = True,
    kerf: Kerf = 0.0,
    date: Date = "",
    paper: Paper = "a4",
    config: Annotated[
        Path | None,
        typer.Option(
            callback=take_config, is_eager=True, help="TOML file with any of these options."
        ),
    ] = None,
    out: Annotated[
        Path | None, typer.Option(help="Output folder (default: PICTURE's name + _design).")
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace an earlier design.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print design.json on stdout.")] = False,
    quiet: Quiet = False,
    debug: Debug = False,
) -> None:
    """Design an actuator that mirrors the side of an object, and its cut template."""
    del config  # its options are among the others by now
    with exit_codes(debug):
        from profiletool import pipeline
        from profiletool.files import write
        from profiletool.files.formula import read_formula
        from profiletool.records.request import Look, Material, Request, ScaleRequest
        from profiletool.template.kerf import check_kerf
        from profiletool.template.kinds import Wish

        folder = out or Path(f"{picture.stem}_design")
        write.check_free(folder, force)
        known = read_formula(formula, extrapolate)
        request = Request(
            file=picture,
            scale=ScaleRequest(height, width, mm_per_px, marker_mm, camera_distance),
            look=Look(
                box=None if box is None else four("--box", box),
                point=None if point is None else two("--point", point),
                mask=mask,
                rotate="auto" if rotate == "auto" else degrees("--rotate", rotate),
                symmetric=symmetric,
            ),
            side=side,
            start_pct=start,
            end_pct=end,
            clearance_mm=clearance,
            tolerance_mm=tolerance,
            joints=joints,
            material=Material(
                outer_diameter_mm=known.outer_diameter_mm if diameter is None else diameter,
                wall_mm=known.wall_mm if wall is None else wall,
                root_mm=root,
                pitch_mm=pitch,
                max_pressure_bar=max_pressure,
                max_length_mm=max_length,
                rubber=known.rubber,
            ),
            formula=formula,
            extrapolate=extrapolate,
            verify=verify,
            method=method,
            refine=refine,
            interference_mm=interference,
            base_free=base_free,
            alpha_step_deg=alpha_step,
            place_step_mm=place_step,
        )
        try:
            check_kerf(kerf, pitch, request.material.thread_mm)
        except ValueError as error:
            raise UsageError(f"--kerf: {error}") from error
        say = speaker(quiet)
        try:
            with progress_bar("finite elements", quiet) as progress:
                result = pipeline.run(request, say, progress)
        except Unsure as unsure:
            raise _doubted(unsure, f"{out or picture.stem}_candidates") from unsure
        # Heavy: a picture that is refused is refused sooner without it.
        from profiletool import outputs
        from profiletool.report.text import joint_table

        files = outputs.files_of(result, Wish(kerf_mm=kerf, date=date), paper)
        write.write_folder(folder, files, force)
        text = files["design.json"].decode() if as_json else joint_table(result.design)
        typer.echo(text, nl=False)
        for warning in result.design.warnings:
            say(f"note: {warning}")
        say(f"written: {folder}")
        if result.reasons:
            raise Infeasible(
                f"no design within the limits ({'; '.join(result.reasons[:2])}); "
                f"the best attempt is in {folder}, marked infeasible"
            )
        if result.check is not None and result.check.failure is not None:
            raise NotVerified(
                f"finite elements: {result.check.failure}; the design is in {folder}, marked NOT "
                "VERIFIED; try a lower --max-pressure"
            )
