"""Robustness of the engine: random actuators inflated, and the ways in which they end.

A run ends when every asked pressure is reached or the path stops at a critical state. A state
that does not hold what it promises (residual, balance of energy, no brick turned inside out) is
silently wrong, the one thing that must never happen.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass

import numpy as np
from _common import machine, table

from fem.actuator import AWAY, TOWARD, Actuator, Window
from fem.errors import NotConverged
from fem.loadpath import Options
from fem.material import PAPER_RUBBER, MooneyRivlin
from fem.solution import State
from fem.solver import solve

LEAST_SHARE = 0.99
RESIDUAL, ENERGY = 1e-5, 1e-3


@dataclass(frozen=True)
class Outcome:
    """How one run went; ``kind`` is what it is counted as, ``pressure`` (bar) what it reached."""

    number: int
    kind: str
    pressure: float
    of: float
    seconds: float
    residual: float
    energy_error: float
    least_J: float
    reason: str
    about: str


def random_actuator(seed: int, number: int) -> tuple[Actuator, float]:
    """Draw the actuator of one number, and how many times as stiff as the paper's its rubber is."""
    draw = np.random.default_rng([seed, number])
    D = draw.uniform(12.0, 30.0)
    k = D / 20.0  # lengths go with the diameter
    stiff = float(np.exp(draw.uniform(np.log(0.5), np.log(3.0))))
    windows, z = [], 0.0
    for _ in range(draw.integers(1, 9)):
        openF = k * draw.uniform(4.0, 16.0)
        z += k * (2.0 + draw.exponential(6.0))
        side = TOWARD if draw.random() < 0.5 else AWAY
        windows.append(Window(z + 0.5 * openF, openF, np.radians(draw.uniform(72, 180)), side))
        z += openF
    length = z + k * (2.0 + draw.exponential(6.0)) + 1.0
    rubber = MooneyRivlin(
        *(stiff * v for v in (PAPER_RUBBER.C10, PAPER_RUBBER.C01, PAPER_RUBBER.K))
    )
    wall = D * draw.uniform(0.08, 0.14)
    return Actuator(length, tuple(windows), diameter=D, wall=wall, rubber=rubber), stiff


# Every state is to be in balance here, not the last one alone.
_OPTIONS = Options(before=Options().tolerance)


def run(task: tuple[int, int]) -> Outcome:
    """Inflate one actuator."""
    seed, number = task
    actuator, stiff = random_actuator(seed, number)
    asked = [0.05 * k * stiff for k in range(1, 5)]
    kind, reason, reached, states = "ended", "", 0.0, tuple[State, ...]()
    begun = time.perf_counter()
    try:
        solution = solve(actuator, asked, options=_OPTIONS, threads=1)
        states = solution.states[1:]
        reached = asked[-1]
        if solution.critical is not None:
            kind, reason = "critical", solution.critical.kind
            reached = solution.critical.pressure
        elif len(states) != len(asked):
            kind, reason = "wrong", f"{len(states)} of {len(asked)} states"
    except NotConverged as error:
        kind, reason, reached = "NotConverged", str(error), error.reached
        states = error.solution.states[1:] if error.solution is not None else ()
    except Exception as error:  # whatever it is, it is the finding
        kind, reason = "crashed", repr(error)
    seconds = time.perf_counter() - begun
    residual = max((s.residual for s in states), default=0.0)
    energy = max((s.energy_error for s in states), default=0.0)
    least = min((s.least_J for s in states), default=1.0)
    # Written so that a NaN is wrong too.
    broken = [
        name
        for name, fine in (
            ("residual", residual <= RESIDUAL),
            ("energy", energy <= ENERGY),
            ("inverted", least > 0.0),
        )
        if not fine
    ]
    if broken:
        kind, reason = "wrong", ", ".join(broken)
    about = (
        f"D {actuator.diameter:.1f}, s/D {actuator.wall / actuator.diameter:.3f}, "
        f"{len(actuator.windows)} joints, rubber x {stiff:.2f}"
    )
    return Outcome(
        number,
        kind,
        10.0 * reached,
        10.0 * asked[-1],
        seconds,
        residual,
        energy,
        least,
        reason,
        about,
    )


def main() -> None:
    """Run all, count, and print the worst."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=300)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--workers", type=int, default=2, help="processes, one thread each")
    parser.add_argument("--only", type=int, help="run this number alone")
    options = parser.parse_args()
    print(machine(), flush=True)
    numbers = range(options.count) if options.only is None else [options.only]
    tasks = [(options.seed, number) for number in numbers]
    begun = time.perf_counter()
    outcomes = []
    with ProcessPoolExecutor(options.workers) as pool:
        for outcome in pool.map(run, tasks):
            outcomes.append(outcome)
            if outcome.kind not in ("ended", "critical"):
                print(f"  {outcome.number}: {outcome.kind}: {outcome.reason}", flush=True)
    counts = Counter(o.kind for o in outcomes)
    kinds = ("ended", "critical", "NotConverged", "wrong", "crashed")
    print(f"\nseed {options.seed}, {time.perf_counter() - begun:.0f} s")
    print(table(("", "runs"), [(kind, counts[kind]) for kind in kinds]))
    good = counts["ended"] + counts["critical"]
    for kind, number in Counter(o.reason for o in outcomes if o.kind == "critical").items():
        print(f"  critical by {kind}: {number}")

    lists = [
        ("not ended", [o for o in outcomes if o.kind not in ("ended", "critical")]),
        ("largest energy error", sorted(outcomes, key=lambda o: -o.energy_error)[:5]),
        ("largest residual", sorted(outcomes, key=lambda o: -o.residual)[:3]),
        ("smallest J", sorted(outcomes, key=lambda o: o.least_J)[:3]),
        ("slowest", sorted(outcomes, key=lambda o: -o.seconds)[:5]),
    ]
    head = ("", "outcome", "bar", "of", "s", "residual", "energy error", "least J", "actuator")
    for title, some in lists:
        if some:
            print(f"\n{title}")
            print(table(head, [_row(o) for o in some]))
    needed = int(np.ceil(LEAST_SHARE * len(outcomes)))
    passed = good >= needed and counts["wrong"] == 0 and counts["crashed"] == 0
    print(f"\n{good} of {len(outcomes)} end, {needed} must: {'ok' if passed else 'FAILED'}")
    sys.exit(0 if passed else 1)


def _row(o: Outcome) -> tuple[object, ...]:
    return (
        o.number, o.kind, f"{o.pressure:.3f}", f"{o.of:.3f}", f"{o.seconds:.2f}",
        f"{o.residual:.1e}", f"{o.energy_error:.1e}", f"{o.least_J:.3f}", o.about,
    )  # fmt: skip


if __name__ == "__main__":
    main()
