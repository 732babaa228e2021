"""Shared parts of the benchmarks: the machine, a calibration kernel, and the actuators."""

from __future__ import annotations

import os

# Before numpy loads: the kernel is for one thread, and so is the engine's own BLAS.
for _name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[_name] = "1"

import platform  # noqa: E402
import time  # noqa: E402
from collections.abc import Callable, Sequence  # noqa: E402
from dataclasses import dataclass  # noqa: E402
from pathlib import Path  # noqa: E402
from statistics import median  # noqa: E402

import numpy as np  # noqa: E402
import scipy  # noqa: E402
from scipy.linalg import lapack  # noqa: E402

from fem.actuator import Actuator, Window, chain  # noqa: E402

_KERNEL = 400  # rows of the kernel's matrices, as many as a cross-section has unknowns, roughly
_ROUNDS = 40


def machine() -> str:
    """Say what the figures were measured on, and how busy it was already."""
    model = platform.processor() or platform.machine()
    info = Path("/proc/cpuinfo")
    if info.exists():
        names = [line for line in info.read_text().splitlines() if line.startswith("model name")]
        model = names[0].split(":", 1)[1].strip() if names else model
    load = f", load {os.getloadavg()[0]:.1f}" if hasattr(os, "getloadavg") else ""
    return (
        f"{os.cpu_count()} cores{load}, {model}; Python {platform.python_version()}, "
        f"numpy {np.__version__}, scipy {scipy.__version__}"
    )


def calibration() -> float:
    """Time of a fixed workload of products and Cholesky factors on one thread, s.

    The least CPU time of seven: what the machine can do, not what else it was doing. Times over
    this one compare between machines.
    """
    A, B = np.random.default_rng(0).standard_normal((2, _KERNEL, _KERNEL))
    K = A @ A.T + _KERNEL * np.eye(_KERNEL)

    def work() -> None:
        for _ in range(_ROUNDS):
            A @ B
            lapack.dpotrf(K)

    return min(cpu_time(work) for _ in range(7))


def dgemm_rate() -> float:
    """Arithmetic rate of a large matrix product on one thread, GFLOP/s."""
    A, B = np.random.default_rng(0).standard_normal((2, 1000, 1000))
    return 2.0 / min(cpu_time(lambda: A @ B) for _ in range(7))


def cpu_time(work: Callable[[], object]) -> float:
    """Run once: CPU time of all threads, s."""
    begun = time.process_time()
    work()
    return time.process_time() - begun


@dataclass(frozen=True)
class Timing:
    """Median, least and most time of several runs, and the median CPU time, s."""

    middle: float
    least: float
    most: float
    cpu: float


def median_of(count: int, work: Callable[[], object]) -> Timing:
    """Run ``count`` times."""
    times, cpu = [], []
    for _ in range(count):
        begun = time.perf_counter()
        cpu.append(cpu_time(work))
        times.append(time.perf_counter() - begun)
    return Timing(median(times), min(times), max(times), median(cpu))


def rising(last: float, count: int) -> list[float]:
    """``count`` pressures up to ``last`` bar, MPa."""
    return [0.1 * last * k / count for k in range(1, count + 1)]


def joint(alpha: float = 84.0, openF: float = 10.0) -> Actuator:
    """One joint, 30 mm of tube on both sides; alpha in degrees."""
    return chain(30.0, [30.0], [openF], [np.radians(alpha)])


def bulb() -> Actuator:
    """Return the actuator of the paper's Table 5."""
    alpha, center = [132, 132, 132, 144, 144, 108], [270] * 5 + [90]
    return chain(
        10.0, [19, 19, 19, 12, 12, 8], [8, 8, 8, 8, 6, 10],
        list(np.radians(alpha)), list(np.radians(center)), end=4.0,
    )  # fmt: skip


def skew() -> Actuator:
    """Three joints on 100 mm that bend out of plane: the whole tube is modelled."""
    center = [200.0, 250.0, 300.0]
    return chain(25.0, [25.0] * 3, [10.0] * 3, [np.radians(120.0)] * 3, list(np.radians(center)))


def row_of_joints(count: int, pitch: float = 20.0, openF: float = 8.0) -> Actuator:
    """Joints that bend to and fro, so that any number of them stays clear of itself."""
    windows = tuple(
        Window((k + 0.75) * pitch, openF, float(np.radians(120.0)), float(np.radians(center)))
        for k, center in zip(range(count), [270.0, 90.0] * count, strict=False)
    )
    return Actuator((count + 0.5) * pitch, windows)


def table(head: Sequence[str], rows: Sequence[Sequence[object]]) -> str:
    """Align rows under their heads."""
    cells = [list(head), *([str(cell) for cell in row] for row in rows)]
    widths = [max(len(row[k]) for row in cells) for k in range(len(head))]
    lines = [
        "  ".join(
            cell.ljust(width) if k == 0 else cell.rjust(width)
            for k, (cell, width) in enumerate(zip(row, widths, strict=True))
        ).rstrip()
        for row in cells
    ]
    return "\n".join([lines[0], "-" * max(map(len, lines)), *lines[1:]])
