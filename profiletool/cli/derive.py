"""The command `derive`: parse, call, print, exit codes; nothing else."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from profiletool.cli.console import (
    Debug,
    Force,
    Numbers,
    Quiet,
    TubeFile,
    ascending,
    cores,
    exit_codes,
    progress_bar,
    speaker,
)
from profiletool.cli.rows import parameters_of, with_signature
from profiletool.errors import UsageError

if TYPE_CHECKING:
    from profiletool.campaign.derive import CampaignPlan, Derivation
    from profiletool.rubber.presets import Rubber


_KEPT = "stopped: every finished run is kept; the same command goes on from there"


@dataclass(frozen=True)
class Campaign:
    """The options of the command."""

    out: Annotated[Path | None, typer.Option(help="The formula file to write (JSON).")] = None
    diameter: Annotated[float, typer.Option(help="Outer diameter of the tube, mm.")] = 20.0
    wall: Annotated[float, typer.Option(help="Wall of the tube, mm.")] = 2.0
    rubber: Annotated[
        str,
        typer.Option(
            help="A preset (`list` shows them), mooney-rivlin:C10,C01,nu, neo-hooke:C10,nu, "
            "yeoh:C10,C20,C30,nu or ogden:mu1,alpha1,...,nu (MPa), or a CSV of uniaxial test data "
            "(stretch,stress)."
        ),
    ] = "paper"
    tube: TubeFile = None
    alpha: Annotated[
        Numbers,
        typer.Option(parser=ascending, metavar="DEG,...", help="Extents of the uncut sector, deg."),
    ] = "84,108,120,132,156"  # type: ignore[assignment]
    openF: Annotated[
        Numbers,
        typer.Option(
            "--openF", parser=ascending, metavar="MM,...", help="Axial lengths of the cut, mm."
        ),
    ] = "6,8,10,12,14"  # type: ignore[assignment]
    max_pressure: Annotated[
        float, typer.Option(help="Highest pressure, bar; ten equal steps lead there.")
    ] = 2.0
    start: Annotated[
        str | None,
        typer.Option(
            "--from",
            help="A formula (file, or name: fe) whose campaign is carried over by similarity; "
            "five runs or fewer correct it.",
        ),
    ] = None
    model: Annotated[
        Literal["converged", "paper"],
        typer.Option(help="paper: modelled as the paper did (coarse bricks, threads as bars)."),
    ] = "converged"
    workers: Annotated[
        int | None, typer.Option(help="Processes, one thread each (default: one a core).")
    ] = None
    scheduler: Annotated[
        str | None,
        typer.Option(help="A dask.distributed scheduler, tcp://HOST:PORT, to run on instead."),
    ] = None
    runs: Annotated[
        Path | None, typer.Option(help="Folder of finished runs (default: the user's cache).")
    ] = None
    report: Annotated[
        Path | None, typer.Option(help="Folder for the figures and the table of residuals.")
    ] = None
    force: Force = False
    quiet: Quiet = False
    debug: Debug = False


def derive(**options: Any) -> None:
    """Derive a formula for a tube and rubber from finite elements of single joints.

    Every finished run is kept: a campaign that was stopped goes on where it was.
    """
    asked = Campaign(**options)
    with exit_codes(asked.debug, _KEPT):
        if asked.rubber == "list":
            from profiletool.rubber.presets import presets_text

            typer.echo(presets_text(), nl=False)
            return
        if asked.out is None:
            raise UsageError("--out FILE is missing: where the formula shall be written")
        plan = _plan(asked, asked.out)
        say = speaker(asked.quiet)
        found = _derived(asked, plan, say)
        for a, o, why in found.failures:
            say(f"note: alpha {a:g} deg, openF {o:g} mm ended early ({why}); fitted without")
        from profiletool.report.derivation import derivation_text

        _write(asked, asked.out, found)
        typer.echo(derivation_text(found), nl=False)
        say(f"written: {asked.out}" + ("" if asked.report is None else f", {asked.report}"))


with_signature(derive, parameters_of(Campaign))


def _plan(asked: Campaign, out: Path) -> CampaignPlan:
    """Refuse what cannot be run or written, before it takes any time."""
    from profiletool.campaign.derive import CampaignPlan, check_plan
    from profiletool.files import write
    from profiletool.rubber.presets import parse_rubber
    from profiletool.verify.run import pressures_to

    write.check_file(out, asked.force)
    if asked.report is not None:
        write.check_free(asked.report, asked.force)
    if asked.workers is not None and not 1 <= asked.workers <= 1024:
        raise UsageError(f"--workers must be 1 to 1024, not {asked.workers}")
    if not 0.0 < asked.max_pressure <= 100.0:
        raise UsageError(
            f"--max-pressure must be above 0 and at most 100 bar, not {asked.max_pressure:g}"
        )
    diameter, wall, rubber = asked.diameter, asked.wall, parse_rubber(asked.rubber)
    if asked.tube is not None:
        diameter, wall, rubber = _calibrated(asked, asked.tube)
    plan = CampaignPlan(
        diameter_mm=diameter,
        wall_mm=wall,
        rubber=rubber,
        alpha_deg=tuple(asked.alpha),
        openF_mm=tuple(asked.openF),
        pressures_bar=tuple(round(p, 9) for p in pressures_to(asked.max_pressure)),
        model=asked.model,
    )
    check_plan(plan)
    return plan


def _calibrated(asked: Campaign, file: Path) -> tuple[float, float, Rubber]:
    """Give diameter, wall and rubber of a tube file.

    Raises
    ------
    UnreadableInput
    UsageError
        Others are given as well.
    """
    from profiletool.files.tube_json import load_tube
    from profiletool.rubber.presets import rubber_of

    usual = Campaign()
    given = (asked.diameter, asked.wall, asked.rubber)
    if given != (usual.diameter, usual.wall, usual.rubber):
        raise UsageError("--tube tells diameter, wall and rubber: leave those away")
    tube = load_tube(file)
    return tube.outer_diameter_mm, tube.wall_mm, rubber_of(tube.rubber, f"calibrated, {file.name}")


def _derived(asked: Campaign, plan: CampaignPlan, say: Callable[[str], None]) -> Derivation:
    """Run the campaign."""
    from profiletool.api import derive_formula
    from profiletool.campaign.derive import load_base, similar

    base = None if asked.start is None else load_base(asked.start)
    if base is not None and not similar(plan, base):
        say(
            f"note: this tube's shape or kind of rubber is not that of {asked.start}; five runs "
            "correct what differs, a full campaign without --from is surer"
        )
    with progress_bar("finite elements", asked.quiet, left=True) as show:

        def told(done: int, total: int) -> None:
            if show is not None:
                show(done / total)

        return derive_formula(
            plan,
            base=base,
            workers=asked.workers or cores(),
            scheduler=asked.scheduler,
            runs=asked.runs,
            progress=told,
        )


def _write(asked: Campaign, out: Path, found: Derivation) -> None:
    """Write the formula file, and the report where one is asked for."""
    from profiletool.campaign.formula_file import formula_file
    from profiletool.files import write
    from profiletool.report.derivation import derivation_files

    made = formula_file(found, out.stem)
    files = {} if asked.report is None else {**derivation_files(found), "formula.json": made}
    write.write_file(out, made, asked.force)
    if asked.report is not None:
        write.write_folder(asked.report, files, asked.force)
