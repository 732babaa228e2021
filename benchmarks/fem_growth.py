"""Growth of the solution time with the tube's length: joints 20 mm apart, up to 500 mm."""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
from _common import calibration, machine, median_of, rising, row_of_joints, table

from fem.solution import Solution
from fem.solver import solve

JOINTS = (2, 4, 8, 12, 16, 24)
TARGET = 1.1


def main() -> None:
    """Measure, fit the exponent, and plot where asked."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repeat", type=int, default=3, help="runs to take the median of")
    parser.add_argument("--threads", type=int, default=2, choices=(1, 2))
    parser.add_argument("--bar", type=float, default=1.5, help="pressure to inflate to")
    parser.add_argument("--out", type=Path, help="PNG to plot to")
    parser.add_argument(
        "--joints", type=int, nargs="+", default=JOINTS, help="numbers of joints, two at least"
    )
    options = parser.parse_args()
    unit = calibration()
    print(machine())
    print(f"calibration kernel {unit:.4f} s; {options.threads} threads, to {options.bar:g} bar\n")

    lengths, times, each, rows = [], [], [], []
    for count in options.joints:
        actuator = row_of_joints(count)
        runs: list[Solution] = []

        def work(actuator=actuator, runs=runs) -> None:  # type: ignore[no-untyped-def]
            runs.append(solve(actuator, rising(options.bar, 1), threads=options.threads))

        seconds = median_of(options.repeat, work).middle
        last = runs[-1]
        lengths.append(actuator.length)
        times.append(seconds)
        each.append(seconds / max(last.factorisations, 1))
        rows.append(
            (f"{count} joints", f"{actuator.length:g}", last.mesh.elements, f"{seconds:.2f}",
             f"{seconds / unit:.1f}", last.factorisations, f"{1e3 * each[-1]:.1f}",
             "" if last.critical is None else last.critical.kind)
        )  # fmt: skip
    head = ("", "mm", "bricks", "s", "x kernel", "factorisations", "ms each", "")
    print(table(head, rows))
    exponent, offset = np.polyfit(np.log(lengths), np.log(times), 1)
    single, _ = np.polyfit(np.log(lengths), np.log(each), 1)
    verdict = "ok" if exponent <= TARGET else "OVER"
    print(f"\ntime ~ length^{exponent:.2f} (target {TARGET}: {verdict})")
    print(f"time of a factorisation ~ length^{single:.2f}")
    if options.out is not None:
        plot(options.out, np.array(lengths), np.array(times), exponent, offset)


def plot(
    path: Path, lengths: np.ndarray, times: np.ndarray, exponent: float, offset: float
) -> None:
    """Draw times over lengths, both logarithmic, with the fitted line."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    figure, axes = plt.subplots(figsize=(5, 4), layout="constrained")
    axes.loglog(lengths, times, "o")
    axes.loglog(lengths, np.exp(offset) * lengths**exponent, label=f"length^{exponent:.2f}")
    axes.set(xlabel="length, mm", ylabel="time, s")
    axes.legend()
    figure.savefig(path, dpi=150)
    print(f"plotted to {path}")


if __name__ == "__main__":
    main()
