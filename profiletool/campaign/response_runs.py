"""Finite-element runs for the joint response, its fit and its check.

Run as ``python -m profiletool.campaign.response_runs --out FILE``. Single joints between long
wrapped sectors give the table; pairs, joints near the ends and random actuators give the
neighbours' influence; random actuators of their own check the result. Runs that are kept with
``--raw`` are not done again.
"""

from __future__ import annotations

import argparse
import os
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import asdict, dataclass, replace
from datetime import date
from itertools import product
from pathlib import Path

import numpy as np

from fem.actuator import Actuator, Window
from fem.errors import NotConverged
from fem.material import PAPER_RUBBER
from fem.meshsize import DEFAULT_MESH
from profiletool.bending.model import Chain, centers_of
from profiletool.bending.response import Response
from profiletool.campaign.response_fit import (
    BASE,
    SIGN,
    Lines,
    check,
    factors_in,
    fit_neighbours,
    tabulate,
    with_about,
)
from profiletool.records.units import BAR_PER_MPA, FloatArray
from profiletool.verify.run import inflate

PRESSURES = tuple(round(0.2 * k, 1) for k in range(1, 12))  # bar, of single joints
COARSE = (0.4, 0.8, 1.2, 1.6, 2.0)  # of several joints
CHECKED = (1.0, 1.25, 1.5, 1.75, 2.0)
PLUG_MM = 1.0
TRAINED, TRAIN_SEED, CHECK_SEED = 150, 1, 2
_ALPHA_DEG, _OPENF = range(72, 181, 12), range(4, 17, 2)
_GAPS = (2, 4, 7, 12, 20)
_PAIRS = (
    ((84, 8), (84, 8)), ((132, 8), (132, 8)), ((108, 12), (108, 12)),
    ((84, 12), (144, 6)), ((144, 12), (96, 6)), ((168, 8), (84, 10)),
)  # fmt: skip
_AT_ENDS, _END_GAPS = ((84, 8), (132, 8), (108, 12), (156, 6)), (1, 2, 4, 7, 12, 20)
_LONGEST_MM = 125.0


@dataclass(frozen=True)
class Plan:
    """One run: what is modelled, and the pressures that are asked for in bar."""

    name: str
    chain: Chain
    pressures: tuple[float, ...]


def plan(
    name: str, length: float, joints: Sequence[tuple[float, ...]], pressures: tuple[float, ...]
) -> Plan:
    """Plan a run of joints (centre mm, openF mm, alpha deg, sense)."""
    centre, openF, alpha, sense = np.array(joints, dtype=float).reshape(-1, 4).T
    return Plan(name, Chain(centre, openF, np.radians(alpha), centers_of(sense), length), pressures)


def singles() -> list[Plan]:
    """Plan single joints between long wrapped sectors, and a tube without joints."""
    grid = product(_OPENF, _ALPHA_DEG)
    alone = [plan(f"s{a}_{o}", 81.0, [(40.0, o, a, 1.0)], PRESSURES) for o, a in grid]
    return [plan("none", 80.0, [], PRESSURES), *alone]


def pairs() -> list[Plan]:
    """Plan pairs of joints, and single joints near an end."""
    plans = []
    for ((a1, o1), (a2, o2)), sense, gap in product(_PAIRS, (1.0, -1.0), _GAPS):
        joints = [(30.0 + o1 / 2, o1, a1, 1.0), (30.0 + o1 + gap + o2 / 2, o2, a2, sense)]
        name = f"p{a1}_{o1}_{a2}_{o2}_{sense}_{gap}"
        plans.append(plan(name, 61.0 + o1 + gap + o2, joints, COARSE))
    for (a, o), end, gap in product(_AT_ENDS, "cp", _END_GAPS):
        centre = gap + o / 2 if end == "c" else 60.0 - gap - o / 2
        plans.append(plan(f"e{a}_{o}_{end}_{gap}", 61.0, [(centre, o, a, 1.0)], COARSE))
    return plans


def actuators(count: int, seed: int, pressures: tuple[float, ...]) -> list[Plan]:
    """Plan random actuators: 2 to 7 joints on both sides, gaps from 2 mm, up to 125 mm long."""
    rng = np.random.default_rng(seed)
    plans: list[Plan] = []
    while len(plans) < count:
        n = int(rng.integers(2, 8))
        openF, alpha = 2.0 * rng.integers(2, 9, n), rng.uniform(72.0, 180.0, n)
        sense = np.where(rng.random(n) < 0.65, 1.0, -1.0)
        gap = np.minimum(2.0 + rng.exponential(6.0, n + 1), 30.0)
        gap[0] = rng.uniform(2.0, 20.0)
        length = openF.sum() + gap.sum() + PLUG_MM
        if length > _LONGEST_MM:
            continue
        centre = np.cumsum(gap[:-1] + openF) - 0.5 * openF
        joints = list(zip(centre, openF, alpha, sense, strict=True))
        name = f"r{seed}_{len(plans)}"
        plans.append(plan(name, round(float(length), 2), joints, pressures))
    return plans


def run(plan: Plan) -> Lines | None:
    """Run finite elements, as far as they go; None where they do not even begin."""
    chain = plan.chain
    windows = tuple(
        Window(*(float(number) for number in joint))
        for joint in zip(chain.centre, chain.openF, chain.alpha, chain.alpha_center, strict=True)
    )
    actuator = Actuator(chain.length, windows, plug=PLUG_MM)
    pressures, ended = plan.pressures, None
    while True:
        try:
            found = inflate(actuator, pressures, BASE, SIGN, threads=1).verification
            break
        except NotConverged as error:
            ended = f"not converged beyond {BAR_PER_MPA * error.reached:.2f} bar"
            reached = tuple(p for p in pressures if p <= BAR_PER_MPA * error.reached)
            pressures = reached if len(reached) < len(pressures) else pressures[:-1]
            if not pressures:
                return None
    if found.critical is not None:
        ended = f"{found.critical.kind} at {found.critical.pressure_bar:.2f} bar"
    shapes = [state.shape for state in found.states]
    if not shapes:
        return None
    return Lines(
        name=plan.name,
        chain=chain,
        pressure=np.array(found.pressures_bar) / BAR_PER_MPA,
        along=found.rest.shape.along,
        facing=np.array([shape.facing for shape in shapes]),
        far=np.array([shape.far for shape in shapes]),
        ended=ended,
    )


def run_all(plans: Sequence[Plan], workers: int, raw: Path | None) -> list[Lines]:
    """Run all plans, in order; those kept in the folder ``raw`` are read."""
    done: dict[str, Lines] = {}
    if raw is not None:
        raw.mkdir(parents=True, exist_ok=True)
        kept = ((p, raw / f"{p.name}.npz") for p in plans)
        done = {p.name: _read(p, file) for p, file in kept if file.exists()}
    left = [p for p in plans if p.name not in done]
    with ProcessPoolExecutor(workers, initializer=_one_thread) as pool:
        for future in as_completed([pool.submit(run, p) for p in left]):
            lines = future.result()
            if lines is None:
                continue
            done[lines.name] = lines
            if raw is not None:
                _keep(lines, raw / f"{lines.name}.npz")
            print(f"{len(done)}/{len(plans)} {lines.name} {lines.ended or ''}", flush=True)
    return [done[p.name] for p in plans if p.name in done]


def _one_thread() -> None:
    for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS"):
        os.environ[name] = "1"


def _keep(lines: Lines, file: Path) -> None:
    np.savez_compressed(
        file,
        pressure=lines.pressure,
        along=lines.along,
        facing=lines.facing.astype(np.float32),
        far=lines.far.astype(np.float32),
        ended=np.array(lines.ended or ""),
    )


def _read(plan: Plan, file: Path) -> Lines:
    with np.load(file) as kept:
        values: dict[str, FloatArray] = {
            name: kept[name].astype(float) for name in ("pressure", "along", "facing", "far")
        }
        ended = str(kept["ended"]) or None
    return Lines(name=plan.name, chain=plan.chain, ended=ended, **values)


def derive(runs: dict[str, list[Lines]]) -> Response:
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
    parser.add_argument("--raw", type=Path, help="folder that keeps finished runs")
    asked = parser.parse_args()
    groups = {
        "singles": singles(),
        "pairs": pairs(),
        "actuators": actuators(asked.train, TRAIN_SEED, COARSE),
        "check": actuators(asked.check, CHECK_SEED, CHECKED),
    }
    runs = {name: run_all(plans, asked.workers, asked.raw) for name, plans in groups.items()}
    response = derive(runs)
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
        with_about(response.table, about).save(file)
    for name, figure in figures.items():
        print(name, figure)


if __name__ == "__main__":
    main()
