"""Accuracy of sizes from the printed sheet: rendered photographs of known bodies.

The error is the worse one of width and length. `measured` is the part of the stated error that
does not doubt the body to be one of revolution, `stated` the whole.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))  # the renderer is the tests'

from tests.image.trials import Trial, trial
from tests.image.views import BODIES, POSES, Body, Shot, random_shot


def row(name: str, kind: str, shot: Shot, body: Body, rng: np.random.Generator) -> Trial:
    """Take one picture and print what came of it."""
    # What a camera writes of its focal length is a few per cent off.
    tried = trial(body, shot, rng, focal_error=float(rng.normal(0.0, 0.03)))
    made, found = tried.made, tried.measured
    print(
        f"{name:24} {kind:9} {shot.distance:6.0f} {shot.tilt:5.1f} {shot.k1:6.2f} "
        f"{100 * tried.errors[0]:+7.2f} {100 * tried.errors[1]:+7.2f} "
        f"{200 * made.error_share:6.2f} {100 * found.measured_share:9.2f} "
        f"{100 * (found.scale.error_share or 0.0):7.2f} "
        f"{'yes' if tried.inside_measured else 'no':>4} {'yes' if tried.inside else 'no':>4} "
        f"{made.corners_seen:3d}/{made.corners_total} {made.reprojection_px:5.2f}",
        flush=True,
    )
    return tried


def main() -> None:
    """Print the table of poses and the share of error bars that hold the truth."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--random", type=int, default=20, help="further random poses")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--smallest", action="store_true", help="one pose of one body")
    options = parser.parse_args()
    rng = np.random.default_rng(options.seed)
    print(
        f"{'pose':24} {'body':9} {'mm':>6} {'tilt':>5} {'k1':>6} {'width %':>7} {'len %':>7} "
        f"{'sheet':>6} {'measured':>9} {'stated':>7} {'in':>4} {'in':>4} corners  rms px"
    )
    shots = [(name, kind, shot) for name, shot in POSES.items() for kind in BODIES]
    kinds = list(BODIES)
    shots += [
        (f"random {k}", kinds[k % len(kinds)], random_shot(rng)) for k in range(options.random)
    ]
    if options.smallest:
        shots = shots[:1]
    trials = [row(name, kind, shot, BODIES[kind], rng) for name, kind, shot in shots]
    worst = [abs(tried.worst) for tried in trials]
    print(
        f"error: median {100 * np.median(worst):.2f} %, worst {100 * max(worst):.2f} %; inside the "
        f"measured part {sum(tried.inside_measured for tried in trials)} of {len(trials)}, inside "
        f"the whole {sum(tried.inside for tried in trials)} of {len(trials)}"
    )


if __name__ == "__main__":
    main()
