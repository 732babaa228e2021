"""Distances of designs off their profiles, by FE: the optimal method against the paper's.

The paper's method is the yardstick: errors are printed as ratios to its own. Without arguments all
samples are designed; pictures with a stored resolution and drawings can be given instead.
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path

from _common import machine, table

from profiletool.errors import ProfiletoolError
from profiletool.pipeline import Result, run
from profiletool.records.request import Method, Request

SAMPLES = Path(__file__).parents[1] / "samples"


def designed(file: Path, method: Method) -> tuple[Result, float]:
    """Design for a file, and give the seconds that it took."""
    begun = time.perf_counter()
    made = run(Request(file, method=method, verify=True), lambda line: None)
    return made, time.perf_counter() - begun


def main() -> None:
    """Design with both methods and print them side by side."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("files", nargs="*", type=Path)
    files = parser.parse_args().files or sorted(SAMPLES.glob("*.png"))
    print(machine(), flush=True)
    rows = []
    for file in files:
        try:
            (paper, _), (best, seconds) = (designed(file, "paper"), designed(file, "optimal"))
        except ProfiletoolError as problem:
            print(f"{file.name}: {problem}")
            continue
        off = [made.design.fit.fe or made.design.fit.formula for made in (paper, best)]
        length = best.design.source.profile_length_mm
        rows.append((
            file.name, f"{length:.0f}",
            f"{len(paper.design.joints)} {len(best.design.joints)}",
            f"{off[0].rms_mm:.2f}", f"{off[1].rms_mm:.2f}", f"{off[1].max_mm:.2f}",
            f"{off[0].rms_mm / off[1].rms_mm:.1f}", f"{100.0 * off[1].rms_mm / length:.2f}",
            "yes" if best.design.feasible and best.design.verified else "no", f"{seconds:.1f}",
        ))  # fmt: skip
    head = (
        "", "profile mm", "joints paper, optimal", "RMS paper", "RMS optimal", "max", "ratio",
        "% of length", "good", "s",
    )  # fmt: skip
    print(table(head, rows))


if __name__ == "__main__":
    main()
