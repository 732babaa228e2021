"""The time of a run by stages, and how far it is from what the arithmetic needs."""

from __future__ import annotations

import argparse
import cProfile
import pstats
import time
from collections import defaultdict
from pathlib import Path
from typing import Any

from _common import bulb, dgemm_rate, joint, machine, rising, table

import fem
from fem import blas, solid
from fem.solver import solve

HOME = Path(fem.__file__).parent
# Functions that are a stage of their own; all others go by their module.
STAGES = {
    "cholesky": "factorise",
    "solve_lower": "factorise",
    "subtract_gram": "factorise",
    "solve_rows": "back-substitute",
    "compliance": "compliance of threads",
    "_eliminate": "sum bricks into layers",
}
Function = tuple[str, int, str]


class Count:
    """Arithmetic of the kernels, FLOP, counted by standing in for them."""

    def __init__(self) -> None:
        self.factorise = self.stiffness = 0.0
        cholesky, lower, gram = blas.cholesky, blas.solve_lower, blas.subtract_gram
        respond = solid.respond

        def counted_cholesky(A: Any) -> bool:
            self.factorise += len(A) ** 3 / 3.0
            return cholesky(A)

        def counted_lower(U: Any, B: Any) -> None:
            self.factorise += float(len(U)) ** 2 * B.shape[1]
            lower(U, B)

        def counted_gram(C: Any, B: Any) -> None:
            self.factorise += float(len(C)) ** 2 * len(B)
            gram(C, B)

        def counted_respond(
            rubber: Any, reference: Any, heights: Any, x: Any, *rest: Any, **more: Any
        ) -> Any:
            if len(rest) > 1 and rest[1] is not None:
                columns, rows, entries = reference.pairs.shape
                self.stiffness += 2.0 * 6.0 * columns * rows * entries * x.shape[3]
            return respond(rubber, reference, heights, x, *rest, **more)

        self._ours = (counted_cholesky, counted_lower, counted_gram, counted_respond)
        self._before = (cholesky, lower, gram, respond)

    def __enter__(self) -> Count:
        self._put(self._ours)
        return self

    def __exit__(self, *_: object) -> None:
        self._put(self._before)

    @staticmethod
    def _put(functions: Any) -> None:
        blas.cholesky, blas.solve_lower, blas.subtract_gram, solid.respond = functions


def stage_of(function: Function) -> str | None:
    """Name the stage of a function of the engine; None for all others."""
    path = Path(function[0])
    if path.is_relative_to(HOME / "material"):
        return "material"
    return STAGES.get(function[2], path.stem) if path.parent == HOME else None


def by_stage(stats: Any) -> dict[str, float]:
    """Seconds by stage; what numpy and builtins take goes to those who called them."""
    shares: dict[str, float] = defaultdict(float)

    def give(function: Function, seconds: float, seen: tuple[Function, ...]) -> None:
        stage = stage_of(function)
        callers = {f: v[3] for f, v in stats[function][4].items() if f not in seen}
        total = sum(callers.values())
        if stage is not None or total <= 0.0:
            shares[stage or "other"] += seconds
            return
        for caller, cumulative in callers.items():
            give(caller, seconds * cumulative / total, (*seen, function))

    for function, (_, _, own, _, _) in stats.items():
        if own > 0.0:
            give(function, own, ())
    return shares


def main() -> None:
    """Profile on one thread, count the arithmetic, and time without the profiler."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--functions", type=int, default=0, help="list this many functions too")
    parser.add_argument("--bar", type=float, default=1.9, help="pressure to inflate to")
    parser.add_argument("--joint", action="store_true", help="one joint in place of the bulb")
    options = parser.parse_args()
    print(machine())
    actuator = joint() if options.joint else bulb()
    pressures = rising(options.bar, 1)
    solve(actuator, pressures, threads=1)
    seconds = {}
    for threads in (1, 2):
        begun = time.perf_counter()
        solution = solve(actuator, pressures, threads=threads)
        seconds[threads] = time.perf_counter() - begun
    with Count() as count:
        solve(actuator, pressures, threads=1)
    profiler = cProfile.Profile(time.thread_time)  # not what others took of the core
    profiler.runcall(solve, actuator, pressures, threads=1)
    stats = pstats.Stats(profiler)
    shares = by_stage(stats.stats)  # type: ignore[attr-defined]
    total = sum(shares.values())
    rows = [
        (name, f"{value:.3f}", f"{100.0 * value / total:.1f}")
        for name, value in sorted(shares.items(), key=lambda item: -item[1])
        if value > 0.002 * total
    ]
    print(
        f"\n{'one joint' if options.joint else 'bulb'} to {options.bar:g} bar: "
        f"{solution.factorisations} factorisations, {solution.newton_iterations} Newton steps, "
        f"{solution.mesh.elements} bricks\n"
    )
    print(table(("one thread, profiled", "CPU s", "%"), rows))
    rate = dgemm_rate()
    work = (count.factorise + count.stiffness) / 1e9
    print(
        f"\nfactorisations {count.factorise / 1e9:.1f} GFLOP, element stiffness "
        f"{count.stiffness / 1e9:.1f} GFLOP; a large product runs at {rate:.1f} GFLOP/s"
    )
    for threads, taken in seconds.items():
        limit = work / rate / threads
        print(
            f"{threads} threads: {taken:.2f} s, {taken / limit:.1f} times the arithmetic limit "
            f"of {limit:.2f} s"
        )
    if options.functions:
        stats.sort_stats("tottime").print_stats(options.functions)


if __name__ == "__main__":
    main()
