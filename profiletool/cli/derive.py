"""The command that derives a formula: parse, call, print, exit codes; nothing else."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Annotated, Literal

import typer

from profiletool.cli.console import (
    Debug,
    Numbers,
    Quiet,
    ascending,
    exit_codes,
    progress_bar,
    speaker,
)
from profiletool.errors import UsageError


def derive(
    out: Annotated[Path | None, typer.Option(help="The formula file to write (JSON).")] = None,
    diameter: Annotated[float, typer.Option(help="Outer diameter of the tube, mm.")] = 20.0,
    wall: Annotated[float, typer.Option(help="Wall of the tube, mm.")] = 2.0,
    rubber: Annotated[
        str,
        typer.Option(
            help="A preset (`list` shows them), mooney-rivlin:C10,C01,nu, neo-hooke:C10,nu (MPa), "
            "or a CSV of uniaxial test data (stretch,stress)."
        ),
    ] = "paper",
    alpha: Annotated[
        Numbers,
        typer.Option(parser=ascending, metavar="DEG,...", help="Extents of the uncut sector, deg."),
    ] = "84,108,120,132,156",  # type: ignore[assignment]
    openF: Annotated[
        Numbers,
        typer.Option(
            "--openF", parser=ascending, metavar="MM,...", help="Axial lengths of the cut, mm."
        ),
    ] = "6,8,10,12,14",  # type: ignore[assignment]
    max_pressure: Annotated[
        float, typer.Option(help="Highest pressure, bar; ten equal steps lead there.")
    ] = 2.0,
    start: Annotated[
        str | None,
        typer.Option(
            "--from",
            help="A formula (file, or name: fe) whose campaign is carried over by similarity; "
            "five runs or fewer correct it.",
        ),
    ] = None,
    model: Annotated[
        Literal["converged", "paper"],
        typer.Option(help="paper: modelled as the paper did (coarse bricks, threads as bars)."),
    ] = "converged",
    workers: Annotated[
        int | None, typer.Option(help="Processes, one thread each (default: one a core).")
    ] = None,
    scheduler: Annotated[
        str | None,
        typer.Option(help="A dask.distributed scheduler, tcp://HOST:PORT, to run on instead."),
    ] = None,
    runs: Annotated[
        Path | None, typer.Option(help="Folder of finished runs (default: the user's cache).")
    ] = None,
    report: Annotated[
        Path | None, typer.Option(help="Folder for the figures and the table of residuals.")
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace earlier results.")] = False,
    quiet: Quiet = False,
    debug: Debug = False,
) -> None:
    """Derive a formula for a tube and rubber from finite elements of single joints.

    Every finished run is kept: a campaign that was stopped goes on where it was.
    """
    with exit_codes(debug):
        from profiletool.rubber.presets import parse_rubber, presets_text

        if rubber == "list":
            typer.echo(presets_text(), nl=False)
            return
        if out is None:
            raise UsageError("--out FILE is missing: where the formula shall be written")
        from profiletool.campaign.derive import CampaignPlan, check_plan, load_base, similar
        from profiletool.campaign.derive import derive as run
        from profiletool.campaign.formula_file import formula_file
        from profiletool.files import write
        from profiletool.verify.run import pressures_to

        write.check_file(out, force)
        if report is not None:
            write.check_free(report, force)
        if workers is not None and not 1 <= workers <= 1024:
            raise UsageError(f"--workers must be 1 to 1024, not {workers}")
        if not 0.0 < max_pressure <= 100.0:
            raise UsageError(
                f"--max-pressure must be above 0 and at most 100 bar, not {max_pressure:g}"
            )
        plan = CampaignPlan(
            diameter_mm=diameter,
            wall_mm=wall,
            rubber=parse_rubber(rubber),
            alpha_deg=tuple(alpha),
            openF_mm=tuple(openF),
            pressures_bar=tuple(round(p, 9) for p in pressures_to(max_pressure)),
            model=model,
        )
        check_plan(plan)
        say = speaker(quiet)
        base = None if start is None else load_base(start)
        if base is not None and not similar(plan, base):
            say(
                f"note: this tube's shape or kind of rubber is not that of {start}; five runs "
                "correct what differs, a full campaign without --from is surer"
            )
        from profiletool.campaign.runs import JOINT_RUN
        from profiletool.campaign.store import Store, default_folder
        from profiletool.campaign.workers import run_all

        store = Store(runs or default_folder(), JOINT_RUN)
        with progress_bar("finite elements", quiet, left=True) as show:

            def told(done: int, total: int) -> None:
                if show is not None:
                    show(done / total)

            found = run(
                plan,
                lambda tasks: run_all(
                    tasks, store, workers=workers or _cores(), scheduler=scheduler, progress=told
                ),
                base,
            )
        for a, o, why in found.failures:
            say(f"note: alpha {a:g} deg, openF {o:g} mm ended early ({why}); fitted without")
        from profiletool.report.derivation import derivation_files, derivation_text

        made = formula_file(found, out.stem)
        files = None if report is None else {**derivation_files(found), "formula.json": made}
        write.write_file(out, made, force)
        if report is not None and files is not None:
            write.write_folder(report, files, force)
        typer.echo(derivation_text(found), nl=False)
        say(f"written: {out}" + ("" if report is None else f", {report}"))


def _cores() -> int:
    """How many cores this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
