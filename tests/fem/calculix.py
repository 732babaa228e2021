"""CalculiX on one of our decks, and the shape that it finds."""

from __future__ import annotations

import os
import subprocess
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from fem.export.deck import Deck
from fem.export.inp import write_calculix
from fem.mesh import Mesh

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class Run:
    """What CalculiX gave: nodal positions x as ours by pressure in MPa, and its time in s."""

    x: dict[float, FloatArray]
    seconds: float
    said: str


def run(
    program: str, folder: Path, deck: Deck, mesh: Mesh, limit: float,
    write: Callable[[Deck], str] = write_calculix,
) -> Run:  # fmt: skip
    """Let CalculiX, on one thread, go as far as it gets within ``limit`` seconds."""
    (folder / "actuator.inp").write_text(write(deck))
    begun = time.perf_counter()
    try:
        done = subprocess.run(
            [program, "-i", "actuator"], cwd=folder, timeout=limit, capture_output=True, text=True,
            check=False, env={**os.environ, "OMP_NUM_THREADS": "1"},
        )  # fmt: skip
        said = done.stdout + done.stderr
    except subprocess.TimeoutExpired:
        said = f"stopped after {limit:g} s"
    seconds = time.perf_counter() - begun
    moved = _displacements(folder / "actuator.frd", mesh.nodes)
    x = {p: _positions(mesh, u) for p, u in zip(deck.pressures, moved, strict=False)}
    return Run(x, seconds, said)


def _positions(mesh: Mesh, u: FloatArray) -> FloatArray:
    x = mesh.X.copy()
    x.reshape(-1, 3)[: mesh.nodes] += u
    return x


def _displacements(frd: Path, nodes: int) -> list[FloatArray]:
    """Displacements of the first nodes, (nodes, 3), at the end of every step that was finished.

    CalculiX writes the last state of a step that it gives up, too; every step takes a time of 1.
    """
    found: list[FloatArray] = []
    lines = frd.read_text().splitlines() if frd.exists() else []
    rows: list[list[float]] | None = None
    time = 0.0
    for line in lines:
        if line.startswith("  100CL"):
            time = float(line[12:24])
        elif line.startswith(" -4"):
            wanted = line.startswith(" -4  DISP ") and abs(time - round(time)) < 1e-6
            rows = [] if wanted else None
        elif line.startswith(" -1") and rows is not None:
            if int(line[3:13]) <= nodes:
                rows.append([float(line[13 + 12 * k : 25 + 12 * k]) for k in range(3)])
        elif line.startswith(" -3") and rows is not None:
            if len(rows) == nodes:
                found.append(np.array(rows))
            rows = None
    return found
