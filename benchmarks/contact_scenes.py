"""Random fingers against random objects: how the runs end, and what they take.

An object is the line that the free finger lies on at 80 % of its pressure, turned or extruded,
and misplaced: by up to 5 mm along the clamped tube, and by a turn of up to 5 mm at its far end. A
run must reach its pressures or name what is in the way; no state may lie deep in the object or lose
energy without saying so.
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
from fem.against import solve_against
from fem.arrays import FloatArray
from fem.errors import FemError
from fem.gap import Obstacle
from fem.outline import Extruded, Outline, Revolved
from fem.solver import solve

MISPLACED_MM, AXIS_MM = 5.0, 25.0
DEEP_MM, ENERGY = 0.02, 1e-3
SHARES = (0.7, 0.85, 1.0)  # of the pressure, reported in contact


@dataclass(frozen=True)
class Outcome:
    """How one scene went.

    Attributes
    ----------
    number : int
    kind : {"converged", "named", "deep", "energy", "no free run", "crashed"}
    reason : str
    factorisations, seconds : float
        Those of the run in contact over the free one's.
    depth_mm, energy : float
        Deepest point in the object, and the energy balance's largest error, over all states.
    """

    number: int
    kind: str
    reason: str
    factorisations: float = np.nan
    seconds: float = np.nan
    depth_mm: float = np.nan
    energy: float = np.nan


def finger(draw: np.random.Generator) -> tuple[Actuator, float]:
    """Draw a finger and its pressure, MPa."""
    windows, z = [], 2.0
    for number in range(draw.integers(1, 5)):
        openF = 2.0 * draw.integers(3, 8)
        z += draw.uniform(3.0, 12.0)
        side = TOWARD if number == 0 or draw.random() < 0.75 else AWAY
        windows.append(Window(z + 0.5 * openF, openF, np.radians(draw.uniform(80, 160)), side))
        z += openF
    return Actuator(z + draw.uniform(6.0, 20.0), tuple(windows)), draw.uniform(0.06, 0.15)


def placed(line: FloatArray, draw: np.random.Generator) -> Obstacle:
    """Make an object of a line (n, 2) in (z, y): misplaced, turned or extruded."""
    far = float(np.linalg.norm(line - line[0], axis=1).max())
    turn = draw.uniform(-1.0, 1.0) * MISPLACED_MM / far
    c, s = np.cos(turn), np.sin(turn)
    points = line[0] + (line - line[0]) @ np.array([[c, s], [-s, c]])
    # Up to a mm off the clamped end, which must be free of it, and any way along it.
    moved = np.array([draw.uniform(-1.0, 1.0) * MISPLACED_MM, -draw.uniform(0.1, 1.0)])
    outline = Outline(points + moved)
    if draw.random() < 0.5:
        return Extruded(outline)
    below = np.array([0.0, points[:, 1].min() - AXIS_MM])
    return Revolved(outline, below, np.array([1.0, 0.0]), np.array([0.0, 1.0]))


def run(task: tuple[int, int]) -> Outcome:
    """Press one finger on its object."""
    seed, number = task
    draw = np.random.default_rng([seed, number])
    actuator, most = finger(draw)
    begun = time.process_time()
    try:
        free = solve(actuator, [0.1 * k * most for k in range(1, 11)], threads=1)
    except FemError as error:
        return Outcome(number, "no free run", str(error))
    between = time.process_time()
    if not free.converged:
        return Outcome(number, "no free run", "critical")
    line = free.states[8].shape.facing[:, [2, 1]]
    try:
        held = solve_against(free, placed(line, draw), [s * most for s in SHARES], threads=1)
    except Exception as error:  # whatever it is, it is the finding
        return Outcome(number, "crashed", repr(error))
    took = (time.process_time() - between) / (between - begun)
    kind, reason = ("converged", "") if held.failure is None else ("named", held.failure)
    deepest = max((touch.depth for touch in held.touches), default=0.0)
    energy = max((state.energy_error for state in held.states), default=0.0)
    if not deepest <= DEEP_MM:
        kind, reason = "deep", f"{deepest:.3f} mm"
    elif not energy <= ENERGY:
        kind, reason = "energy", f"{energy:.1e}"
    factored = held.factorisations / free.factorisations
    return Outcome(number, kind, reason, factored, took, deepest, energy)


def main() -> int:
    """Run all scenes; tell how they ended."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scenes", type=int, default=100)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--workers", type=int, default=1)
    given = parser.parse_args()
    tasks = [(given.seed, number) for number in range(given.scenes)]
    print(machine())
    outcomes = []
    with ProcessPoolExecutor(given.workers) as pool:
        for one in pool.map(run, tasks):
            outcomes.append(one)
            print(
                f"{one.number:4d}  {one.kind}: depth {one.depth_mm:.3f} mm, "
                f"energy {one.energy:.1e}, time {one.seconds:.2f} {one.reason}",
                flush=True,
            )
    counts = Counter(one.kind for one in outcomes)
    print(table(["ended", "scenes"], [[kind, str(count)] for kind, count in counts.most_common()]))
    ran = [one for one in outcomes if np.isfinite(one.seconds)]
    if ran:
        print(
            f"in contact over free, median: time {np.median([o.seconds for o in ran]):.2f}, "
            f"factorisations {np.median([o.factorisations for o in ran]):.2f}; "
            f"depth at most {max(o.depth_mm for o in ran):.3f} mm, "
            f"energy off by at most {max(o.energy for o in ran):.1e}"
        )
    return 1 if counts["crashed"] else 0


if __name__ == "__main__":
    sys.exit(main())
