"""The default campaign: its time, its formula, similar tubes by five runs, the paper's model.

``--speed`` runs it with one and with two processes from nothing; ``--similar`` runs whole
campaigns for a tube of 16 mm and for a rubber twice as stiff and compares those from five runs;
``--paper`` models the joints as the paper did and compares with its Table 3. Runs are kept in
``--runs`` (not those of ``--speed``).
"""

from __future__ import annotations

import argparse
import tempfile
import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from _common import machine, table

from fem.material import PAPER_RUBBER, MooneyRivlin
from formula.files import load_formula, parse_formula, read_bytes, read_tree
from formula.fit import errors_of
from formula.theta import COEFFICIENTS, theta_deg
from profiletool.campaign.derive import Base, CampaignPlan, Derivation, derive, formula_of
from profiletool.campaign.formula_file import formula_file
from profiletool.campaign.runs import JOINT_RUN, Outcome, Task
from profiletool.campaign.store import Store, default_folder
from profiletool.campaign.workers import run_all
from profiletool.rubber.presets import PRESETS, Rubber

JointStore = Store[Task, Outcome]
PLAN = CampaignPlan(
    20.0, 2.0, PRESETS["paper"], (84.0, 108.0, 120.0, 132.0, 156.0), (6.0, 8.0, 10.0, 12.0, 14.0),
    tuple(round(0.2 * k, 9) for k in range(1, 11)),
)  # fmt: skip
SMALLEST = replace(
    PLAN, alpha_deg=(84.0, 120.0, 156.0), openF_mm=(6.0, 8.0, 10.0), pressures_bar=(0.1, 0.2)
)


def campaign(
    plan: CampaignPlan, store: JointStore, workers: int = 2, base: Base | None = None
) -> Derivation:
    """Derive with so many processes."""

    def runs(tasks: Sequence[Task]) -> list[Outcome]:
        return run_all(tasks, store, workers=workers)

    return derive(plan, runs, base)


def speed(plan: CampaignPlan) -> None:
    """Time a campaign from nothing."""
    taken = {}
    for workers in (2, 1, 2, 1):
        with tempfile.TemporaryDirectory() as folder:
            begun = time.perf_counter()
            campaign(plan, Store(Path(folder), JOINT_RUN), workers)
            seconds = time.perf_counter() - begun
        taken[workers] = min(seconds, taken.get(workers, np.inf))
        runs, pressures = len(plan.alpha_deg) * len(plan.openF_mm), len(plan.pressures_bar)
        print(f"  {runs} runs of {pressures} pressures, {workers} workers: {seconds:.1f} s",
              flush=True)  # fmt: skip
    print(f"  two workers are {taken[1] / taken[2]:.2f} times as fast as one")


def against_formula_9(found: Derivation) -> None:
    """Compare the default campaign with formula (9) as published and refitted, by pressure."""
    published = load_formula()
    old = errors_of(found.data, lambda a, o, P: theta_deg(published, a, o, P))
    assert found.paper_errors is not None
    rows = []
    for n, P in enumerate(found.data.pressure_bar):
        cells = (old, found.paper_errors, found.chosen.errors, found.chosen.validated)
        rows.append((f"{P:.1f}", *(f"{v:.2f}" for e in cells for v in e.by_pressure[n])))
    head = ("bar", "(9) RMS", "max", "refitted", "max", "polynomial", "max", "validated", "max")
    print(table(head, rows))
    print(
        f"in all: (9) {old.rms:.2f}, refitted {found.paper_errors.rms:.2f}, polynomial "
        f"{found.chosen.errors.rms:.3f}, cross-validated {found.chosen.validated.rms:.3f} deg RMS"
    )


def similar(plan: CampaignPlan, store: JointStore, known: Derivation) -> None:
    """Compare campaigns from five runs with whole ones."""
    base = Base(parse_formula(formula_file(known, "default"), "default"), known.data)
    law = PAPER_RUBBER
    hard = Rubber(
        "twice", MooneyRivlin(2.0 * law.C10, 2.0 * law.C01, 2.0 * law.K), "twice the paper's"
    )
    plans = {
        "D 16, wall 1.6": replace(plan, diameter_mm=16.0, wall_mm=1.6),
        "twice as stiff": replace(plan, rubber=hard),
    }
    for name, other_plan in plans.items():
        whole, few = campaign(other_plan, store), campaign(other_plan, store, base=base)
        off = few.data.theta_deg / whole.data.theta_deg - 1.0
        alpha, openF, P, theta = whole.data.points
        one, other = (
            theta_deg(formula_of(other_plan, found.chosen.terms), alpha, openF, P)
            for found in (few, whole)
        )
        apart = np.abs(one - other)
        print(
            f"  {name}: angles from 5 runs against 25: {100 * np.nanmax(np.abs(off)):.2f} % at "
            f"most; their formulas {apart.max():.3f} deg, "
            f"{100 * (apart / np.maximum(theta, 1.0)).max():.2f} % at most "
            f"(of angles above 1 deg), {100 * np.sqrt(np.mean((one / other - 1) ** 2)):.2f} % RMS; "
            f"whole: cross-validated {whole.chosen.validated.rms:.3f} deg"
        )


def as_the_paper(plan: CampaignPlan, store: JointStore) -> None:
    """Compare the refitted coefficients of the paper's model with its Table 3."""
    found = campaign(replace(plan, model="paper"), store)
    assert found.paper is not None
    published = read_tree(read_bytes("paper"), "paper")["coefficients"]
    rows = [
        (name, f"{published[name]:.6f}", f"{ours:.6f}")
        for name, ours in zip(COEFFICIENTS, found.paper.coefficients, strict=True)
    ]
    print(table(("", "Table 3", "refitted"), rows))
    old = errors_of(found.data, lambda a, o, P: theta_deg(load_formula(), a, o, P))
    print(
        f"angles of the paper's model against formula (9): {old.rms:.2f} deg RMS, {old.largest:.2f}"
    )
    print(f"runs that ended early: {len(found.failures)}")


def main() -> None:
    """Run what is asked for."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--speed", action="store_true")
    parser.add_argument("--similar", action="store_true")
    parser.add_argument("--paper", action="store_true")
    parser.add_argument(
        "--smallest", action="store_true", help="nine joints to 0.2 bar, which measure nothing"
    )
    parser.add_argument("--runs", type=Path, default=default_folder())
    options = parser.parse_args()
    print(machine(), flush=True)
    plan = SMALLEST if options.smallest else PLAN
    if options.speed:
        speed(plan)
    store = Store(options.runs, JOINT_RUN)
    known = campaign(plan, store)
    against_formula_9(known)
    if options.similar:
        similar(plan, store, known)
    if options.paper:
        as_the_paper(plan, store)


if __name__ == "__main__":
    main()
