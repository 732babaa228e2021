"""The command line: parse, call, print, exit codes; nothing else."""

from __future__ import annotations

import itertools
import json
import sys
import tomllib
from pathlib import Path
from typing import Annotated, Any, Literal, cast

import typer

from profiletool import __version__, cli_derive, cli_fe, cli_table, cli_template
from profiletool.cli_template import Date, Kerf, Paper
from profiletool.console import (
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
from profiletool.errors import (
    Infeasible,
    NoObject,
    NotVerified,
    UnreadableInput,
    Unsure,
    UsageError,
)

app = typer.Typer(
    name="profiletool",
    help="From the picture of an object to a soft bending actuator that mirrors its shape.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)
design_app = typer.Typer(
    add_completion=False, pretty_exceptions_enable=False, rich_markup_mode=None
)


_MOST_CONFIG_BYTES = 10_000
# What typer raises for words it cannot take; its own base classes have no public name.
_BadUsage = cast(type[typer.BadParameter], typer.BadParameter.__bases__[0])


def main() -> None:
    """Run `profiletool`."""
    _run(app)


def design_main() -> None:
    """Run `design`, which is `profiletool design`."""
    _run(design_app)


def _run(commands: typer.Typer) -> None:
    """Run a command line; bad usage ends in one line too."""
    try:
        code = commands(standalone_mode=False)
    except typer.Abort:
        code = 130
    except _BadUsage as problem:
        code = UsageError.exit_code
        message = problem.format_message().replace("Value error, ", "").rstrip(".")
        # No arguments at all: the message is the help page.
        typer.echo(message if "\n" in message else f"error: {message}; see --help", err=True)
    sys.exit(code or 0)


def _version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"profiletool {__version__}")
        raise typer.Exit


def _config(context: typer.Context, path: Path | None) -> Path | None:
    """Take the options of a TOML file as defaults; the command line wins."""
    if path is None:
        return None
    with exit_codes(debug=False):
        context.default_map = {**(context.default_map or {}), **_read_config(context, path)}
    return path


def _read_config(context: typer.Context, path: Path) -> dict[str, Any]:
    from profiletool.reading import read_file

    try:
        data = read_file(path, _MOST_CONFIG_BYTES, "a file of options")
        tree = tomllib.loads(data.decode("utf-8-sig"))
    except UnreadableInput as error:
        raise UnreadableInput(f"cannot read {path}: {error}") from None
    except (ValueError, RecursionError) as error:
        raise UnreadableInput(f"{path} is not TOML: {error}") from error
    names = {
        option.removeprefix("--"): parameter
        for parameter in context.command.params
        for option in parameter.opts
        if option.startswith("--") and parameter.name not in (None, "config", "debug")
    }
    known = {}
    for key, value in tree.items():
        parameter = names.get(key.replace("_", "-"))
        if isinstance(value, list) and "," in str(getattr(parameter, "metavar", "")):
            value = ",".join(str(part) for part in value)
        if parameter is None or isinstance(value, dict | list):
            raise UsageError(f'{path}: "{key}" is no option of design; see design --help')
        if isinstance(value, bool) != bool(getattr(parameter, "is_flag", False)):
            raise UsageError(f'{path}: "{key}" cannot be {json.dumps(value, default=str)}')
        known[str(parameter.name)] = value
    return known


def _doubted(unsure: Unsure, name: str) -> NoObject:
    """Draw what the object could be, and say where: never over another file."""
    from profiletool import artifacts, output

    names = itertools.chain([name], (f"{name}_{k}" for k in itertools.count(2)))
    file = next(file for one in names if not (file := Path(f"{one}.png")).exists())
    output.write_file(file, artifacts.candidates_png(unsure), force=False)
    return NoObject(f"{unsure}; {file} shows what it could be")


@app.callback()
def _profiletool(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Show the version.")
    ] = False,
) -> None:
    pass


@design_app.command(epilog="Example:  design bulb.png --height 107.5 --side left --out bulb")
@app.command(epilog="Example:  profiletool design bulb.png --height 107.5 --out bulb")
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
        typer.Option(callback=_config, is_eager=True, help="TOML file with any of these options."),
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
        from profiletool import output, pipeline, subject
        from profiletool.image.scale import ScaleRequest
        from profiletool.records import Material
        from profiletool.sight import Look
        from profiletool.template.kerf import check_kerf
        from profiletool.template.kinds import Wish

        folder = out or Path(f"{picture.stem}_design")
        output.check_free(folder, force)
        known = pipeline.read_formula(formula, extrapolate)
        request = subject.Request(
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
        from profiletool import artifacts
        from profiletool.report.text import joint_table

        files = artifacts.files_of(result, Wish(kerf_mm=kerf, date=date), paper)
        output.write_folder(folder, files, force)
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


for _command, _example in (
    (cli_fe.verify, "profiletool verify bulb_design/design.json"),
    (cli_fe.joint, "profiletool joint --openF 10 --alpha 84 --pressure 2.0"),
    (cli_fe.finger, "profiletool finger --out finger"),
    (cli_derive.derive, "profiletool derive --diameter 16 --wall 1.6 --out tube16.json"),
    (cli_table.table, "profiletool table --openF 6,8,10 --csv"),
    (cli_table.assign, "profiletool assign --openF 8,8,8,8,6,10 --theta 30,30,30,25,20,45"),
    (cli_template.template, "profiletool template bulb_design/design.json --variant strip"),
    (cli_template.sheet, "profiletool sheet --paper letter --out sheet.pdf"),
):
    app.command(epilog=f"Example:  {_example}")(_command)


if __name__ == "__main__":
    main()
