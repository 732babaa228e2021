"""The campaign for the joint response: finite-element runs, the fit and its check.

Run as ``python -m profiletool.campaign.response_runs --out FILE``. Single joints between long
wrapped sectors give the table; pairs, joints near the ends and random actuators give the
neighbours' influence; random actuators of their own check the result. Every finished run is kept:
a campaign that was stopped goes on where it was.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from dataclasses import asdict, replace
from datetime import date
from pathlib import Path

import numpy as np

from fem.material import PAPER_RUBBER
from fem.meshsize import DEFAULT_MESH
from profiletool.bending.response import Response
from profiletool.campaign.response_fit import (
    Lines,
    check,
    factors_in,
    fit_neighbours,
    tabulate,
)
from profiletool.campaign.response_kind import RESPONSE_RUN
from profiletool.campaign.response_tasks import (
    CHECKED,
    COARSE,
    ResponseTask,
    actuators,
    pairs,
    singles,
)
from profiletool.campaign.store import Store, default_folder
from profiletool.campaign.workers import run_all

TRAINED, TRAIN_SEED, CHECK_SEED = 150, 1, 2


def run_group(
    tasks: Sequence[ResponseTask], store: Store[ResponseTask, Lines], workers: int
) -> list[Lines]:
    """Run tasks that the store does not hold yet, and print the progress.

    Returns
    -------
    list of Lines
        In the order of the tasks, less those that did not even begin.
    """

    def told(done: int, total: int) -> None:
        print(f"{done}/{total}", flush=True)

    lines = run_all(tasks, store, workers=workers, progress=told)
    for one in lines:
        if one.ended is not None:
            print(f"{one.name} {one.ended}", flush=True)
    return [one for one in lines if len(one.pressure)]


def fit_response(runs: dict[str, list[Lines]]) -> Response:
    """Fit the response to runs of ``singles``, ``pairs`` and ``actuators``."""
    straight, *alone = runs["singles"]
    tube = np.array([20.0, 2.0, PAPER_RUBBER.C10 + PAPER_RUBBER.C01])
    table = tabulate(alone, straight, tube)
    several = runs["pairs"] + runs["actuators"]
    first = Response(table)
    neighbours = fit_neighbours(several, [factors_in(lines, first) for lines in several], first)
    return Response(replace(table, neighbours=neighbours))


def _ended(runs: dict[str, list[Lines]]) -> Iterator[str]:
    for lines in (line for group in runs.values() for line in group):
        if lines.ended is not None:
            yield f"{lines.name}: {lines.ended}"


def main() -> None:
    """Run the campaign, fit, check and write the data file."""
    parser = argparse.ArgumentParser(prog="python -m profiletool.campaign.response_runs")
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--check", type=int, default=60, help="random actuators")
    parser.add_argument("--train", type=int, default=TRAINED, help="random actuators")
    parser.add_argument("--raw", type=Path, help="folder of finished runs")
    asked = parser.parse_args()
    groups = {
        "singles": singles(),
        "pairs": pairs(),
        "actuators": actuators(asked.train, TRAIN_SEED, COARSE),
        "check": actuators(asked.check, CHECK_SEED, CHECKED),
    }
    store = Store(asked.raw or default_folder(), RESPONSE_RUN)
    runs = {name: run_group(tasks, store, asked.workers) for name, tasks in groups.items()}
    response = fit_response(runs)
    alone = Response(replace(response.table, neighbours=response.table.neighbours.none()))
    figures = {
        "actuators": len(runs["check"]),
        "with_neighbours": check(runs["check"], response).summary(),
        "joints_independent": check(runs["check"], alone).summary(),
    }
    about = {
        "made_by": "python -m profiletool.campaign.response_runs",
        "date": date.today().isoformat(),
        "runs": {name: len(lines) for name, lines in runs.items()},
        "ended_early": list(_ended(runs)),
        "mesh": {name: str(value) for name, value in asdict(DEFAULT_MESH).items()},
        "rubber": {"C10_MPa": PAPER_RUBBER.C10, "C01_MPa": PAPER_RUBBER.C01},
        "error": figures,
    }
    with asked.out.open("wb") as file:
        replace(response.table, about={**response.table.about, **about}).save(file)
    for name, figure in figures.items():
        print(name, figure)


if __name__ == "__main__":
    main()
