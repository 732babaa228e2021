"""The part of `verify` that runs sampled builds."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Annotated, Any

import typer

from profiletool.cli.console import cores, progress_bar
from profiletool.errors import UnreadableInput, UsageError

if TYPE_CHECKING:
    from profiletool.campaign.builds import SampledBuilds
    from profiletool.records.built import Built
    from profiletool.records.design import Design
    from profiletool.records.units import FloatArray
    from profiletool.verify.run import Run

_MOST = 100_000


@dataclass(frozen=True)
class SampleOptions:
    """How many builds to sample, and on what to run them."""

    samples: Annotated[
        int | None,
        typer.Option(
            help="Run so many builds with errors drawn at random too, and compare them with what "
            "the design expects: some seconds each.",
        ),
    ] = None
    workers: Annotated[
        int | None,
        typer.Option(help="Processes for the samples, one thread each (default: one a core)."),
    ] = None
    scheduler: Annotated[
        str | None,
        typer.Option(
            help="A dask.distributed scheduler for them, tcp://HOST:PORT, to run on instead."
        ),
    ] = None


def taken(options: dict[str, Any]) -> SampleOptions:
    """Take the options of samples out of a command's, and check them.

    Raises
    ------
    UsageError
    """
    asked = SampleOptions(**{row.name: options.pop(row.name) for row in fields(SampleOptions)})
    samples, workers = asked.samples, asked.workers
    if samples is not None and not 2 <= samples <= _MOST:
        raise UsageError(f"--samples must be 2 to {_MOST}, not {samples}")
    if workers is not None and not 1 <= workers <= 1024:
        raise UsageError(f"--workers must be 1 to 1024, not {workers}")
    return asked


def sampled(
    design: Design,
    run: Run,
    target: FloatArray | None,
    asked: SampleOptions,
    quiet: bool,
) -> tuple[SampledBuilds, Built]:
    """Run sampled builds of a design; give them and the figures to first order.

    Raises
    ------
    UsageError
        When there is no target, or the run did not end at the design's own pressure.
    UnreadableInput
        When the tangent at the design's pressure allows no derivatives.
    """
    from profiletool.campaign.build_kind import BUILD_RUN
    from profiletool.campaign.builds import sample_builds
    from profiletool.campaign.store import Store, default_folder
    from profiletool.campaign.workers import run_all
    from profiletool.records.built import BuildErrors
    from profiletool.verify.built import built_of
    from profiletool.verify.fields import even_points, fields_of

    if target is None or not run.verification.converged:
        raise UsageError(
            "--samples needs the target, shape.csv beside DESIGN.json, and the design's own "
            "pressure; leave --pressure away"
        )
    build = BuildErrors() if design.built is None else design.built.build
    points = even_points(target)
    fields = fields_of(design, run, points)
    if fields is None:
        raise UnreadableInput("finite elements lose their stability here: nothing to sample about")
    store = Store(default_folder(), BUILD_RUN)
    with progress_bar("builds", quiet) as show:

        def told(done: int, total: int) -> None:
            if show is not None:
                show(done / total)

        found = sample_builds(
            design,
            points,
            build,
            asked.samples or 0,
            lambda tasks: run_all(
                tasks,
                store,
                workers=asked.workers or cores(),
                scheduler=asked.scheduler,
                progress=told,
            ),
        )
    return found, built_of(design, fields, build)
