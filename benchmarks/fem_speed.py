"""Speed of the finite-element engine, in seconds and in units of a calibration kernel."""

from __future__ import annotations

import argparse
import subprocess
import sys
from collections.abc import Callable
from statistics import median

from _common import bulb, calibration, joint, machine, median_of, rising, skew, table

from fem.actuator import Actuator
from fem.solver import solve

ALPHA, OPENF = (84.0, 108.0, 120.0, 132.0, 156.0), (6.0, 8.0, 10.0, 12.0, 14.0)

_IMPORT = "import time; t = time.perf_counter(); import fem.solver; print(time.perf_counter() - t)"
_MEMORY = """
import resource, sys
sys.path.insert(0, sys.argv[1])
from _common import bulb
from fem.solver import solve
solve(bulb(), [0.19 * float(sys.argv[3])], threads=int(sys.argv[2]))
peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
print(peak * (1 if sys.platform == "darwin" else 1024) / 1e6)
"""


def campaign(threads: int) -> None:
    """Run the paper's 25 joints, ten pressures each."""
    for alpha in ALPHA:
        for openF in OPENF:
            solve(joint(alpha, openF), rising(2.0, 10), threads=threads)


def ask_python(*arguments: str) -> float:
    """Run Python anew and read the number that it prints."""
    done = subprocess.run(
        [sys.executable, "-c", *arguments], check=True, capture_output=True, text=True
    )
    return float(done.stdout)


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repeat", type=int, default=5, help="runs to take the median of")
    parser.add_argument("--threads", type=int, default=2, choices=(1, 2))
    parser.add_argument("--no-campaign", action="store_true", help="leave out the 25 joints")
    parser.add_argument("--share", type=float, default=1.0, help="of each pressure to go to")
    options = parser.parse_args()
    repeat, threads = options.repeat, options.threads

    # First of all: on Linux a new process may begin with the peak of the one that started it.
    memory = ask_python(_MEMORY, sys.path[0], str(threads), str(options.share))
    imports = median(ask_python(_IMPORT) for _ in range(repeat))
    unit = calibration()
    print(machine())
    print(f"calibration kernel {unit:.4f} s; {threads} threads, median of {repeat}\n")

    def run(actuator: Callable[[], Actuator], last: float, count: int) -> Callable[[], object]:
        pressures = rising(options.share * last, count)
        return lambda: solve(actuator(), pressures, threads=threads)

    cases: list[tuple[str, Callable[[], object], float | None, float | None, int]] = [
        ("one joint to 2.0 bar, ten pressures", run(joint, 2.0, 10), None, None, repeat),
        ("one joint to 2.0 bar, only the last", run(joint, 2.0, 1), 0.6, 1.0, repeat),
        ("bulb to 1.9 bar", run(bulb, 1.9, 1), 1.5, 2.5, repeat),
        ("whole 3-D, 100 mm, to 1.9 bar", run(skew, 1.9, 1), 6.0, 12.0, repeat),
    ]
    if not options.no_campaign:
        name = "25 joints, ten pressures each (once)"
        cases.append((name, lambda: campaign(threads), None, None, 1))
    rows: list[tuple[object, ...]] = []
    for name, work, aim, target, count in cases:
        t = median_of(count, work)
        spread = f"{t.least:.2f} .. {t.most:.2f}" if count > 1 else ""
        rows.append((name, f"{t.middle:.2f}", spread, f"{t.cpu:.2f}", f"{t.middle / unit:.1f}",
                     *judged(t.middle, aim, target)))  # fmt: skip
    rows.append(("import fem.solver", f"{imports:.2f}", "", "", f"{imports / unit:.1f}",
                 *judged(imports, None, 0.3)))  # fmt: skip
    rows.append(("peak memory of the bulb, MB", f"{memory:.0f}", "", "", "",
                 *judged(memory, None, 500.0)))  # fmt: skip
    print(table(("", "s", "range", "CPU s", "x kernel", "aim", "target", ""), rows))


def judged(value: float, aim: float | None, target: float | None) -> tuple[str, str, str]:
    """Aim, target, and whether the target is met."""
    verdict = "" if target is None else "ok" if value <= target else "OVER"
    return "" if aim is None else f"{aim:g}", "" if target is None else f"{target:g}", verdict


if __name__ == "__main__":
    main()
