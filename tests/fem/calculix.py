"""One of our meshes as a CalculiX deck, and what CalculiX makes of it.

The gauze becomes links: straight threads between neighbouring nodes of the outer surface, which
CalculiX knows as SPRINGA, a force along the line between two nodes by the growth of their
distance, here with another stiffness when slack. (It would expand its trusses to beams with
hinges.) `with_links` gives our own mesh the very same links, so that both programs solve one and
the same discrete problem, and what they differ by is CalculiX' tolerance.
"""

from __future__ import annotations

import os
import subprocess
import time
from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from fem.gauze import Threads
from fem.material import MooneyRivlin
from fem.mesh import Mesh

FloatArray = NDArray[np.float64]

# C3D20's corners below, above, mid-edges below, above and between, in our order of nodes; its
# face P1 is then our inner face.
_C3D20 = (0, 1, 2, 3, 12, 13, 14, 15, 4, 5, 6, 7, 16, 17, 18, 19, 8, 9, 10, 11)

# Links of an outer face: its nodes, and the share of the face's width that they stand for, so
# that the links of the whole surface are half a brick apart.
_AXIAL = ((0, 7, 0.25), (7, 3, 0.25), (4, 6, 0.5), (1, 5, 0.25), (5, 2, 0.25))
_HOOP = ((0, 4, 0.25), (4, 1, 0.25), (7, 5, 0.5), (3, 6, 0.25), (6, 2, 0.25))

_CAP = 1.0  # mm, thickness of the plug
_FAR = 20.0  # mm, more than any link shrinks or grows
# Iterations before it checks for divergence, for slow convergence, and gives up; the default of
# 16 is too few for its approximate tangent, so that it would stop at 1.2 bar.
_PATIENCE = "8, 30, 30, 60, 15, 4, , 10"


@dataclass(frozen=True)
class Run:
    """What CalculiX gave: nodal positions x as ours by pressure in MPa, and its time in s."""

    x: dict[float, FloatArray]
    seconds: float
    said: str


def with_links(mesh: Mesh) -> Mesh:
    """Our mesh with links for its gauze."""
    axial, hoop = (_threads(mesh, family) for family in ("axial", "hoop"))
    return replace(mesh, axial=axial, hoop=hoop)


def deck(mesh: Mesh, pressures: Sequence[float], element: str = "C3D20R") -> str:
    """Write a half tube with links as CalculiX input: one static step a pressure, MPa."""
    assert mesh.half
    assert mesh.size.kind == "hex20"
    assert mesh.size.through == 1
    assert mesh.X[0, 0, 1] < 0.0  # faces are counted from 270 deg
    a, row = mesh.actuator, mesh.ring + mesh.mid
    X = mesh.X.reshape(-1, 3)[: mesh.nodes]
    bricks = (row * np.arange(mesh.layers)[:, None, None] + mesh.bricks).reshape(-1, 20)
    last = row * mesh.layers + np.arange(mesh.ring)
    cap_at, wedges = _cap(mesh, len(X))
    held = np.flatnonzero(np.tile(np.r_[mesh.fixed_ring[:, 0], mesh.fixed_mid[:, 0]], mesh.layers))
    held = held[held >= mesh.ring]
    ref = len(X) + len(cap_at) + 1  # node numbers from here on count from 1, as CalculiX does
    text = ["*NODE, NSET=NALL"]
    text += [_row(n, *at) for n, at in enumerate([*X, *cap_at], start=1)]
    text += ["*NODE", _row(ref, 0.0, 0.0, mesh.z[-1]), _row(ref + 1, 0.0, 0.0, mesh.z[-1])]
    text += _set("TUBE", range(1, len(X) + 1))
    text += _set("ROOT", np.arange(mesh.ring) + 1)
    text += _set("HALF", held + 1)
    text += _set("PLUG", np.r_[last, len(X) + np.arange(len(cap_at))] + 1)
    text.append(f"*ELEMENT, TYPE={element}, ELSET=WALL")
    number = 1
    for nodes in bricks[:, _C3D20] + 1:
        text += [_row(number, *nodes[:10]) + ",", ", ".join(map(str, nodes[10:]))]
        number += 1
    text.append("*ELEMENT, TYPE=C3D15, ELSET=CAP")
    for nodes in wedges + 1:
        text += [_row(number, *nodes[:10]) + ",", ", ".join(map(str, nodes[10:]))]
        number += 1
    for group, (stiffness, pairs) in enumerate(_springs(mesh).items()):
        text.append(f"*ELEMENT, TYPE=SPRINGA, ELSET=LINK{group}")
        for pair in pairs:
            text.append(_row(number, pair[0] + 1, pair[1] + 1))
            number += 1
        text += [f"*SPRING, NONLINEAR, ELSET=LINK{group}"]
        slack = a.gauze.slack * stiffness
        text += [f"{k * e:.12g}, {e:g}" for k, e in ((slack, -_FAR), (0.0, 0.0), (stiffness, _FAR))]
    text += _rubber(a.rubber)
    for part in ("WALL", "CAP"):
        text.append(f"*SOLID SECTION, ELSET={part}, MATERIAL=RUBBER")
    text += [f"*RIGID BODY, NSET=PLUG, REF NODE={ref}, ROT NODE={ref + 1}"]
    text += ["*BOUNDARY", "ROOT, 1, 3", "HALF, 1, 1", f"{ref}, 1, 1", f"{ref + 1}, 2, 3"]
    for pressure in pressures:
        text += ["*STEP, NLGEOM, INC=200", "*STATIC", "0.5, 1.0, 1e-3"]
        text += ["*CONTROLS, PARAMETERS=TIME INCREMENTATION", _PATIENCE]
        text += ["*DLOAD", f"WALL, P1, {pressure:.12g}", f"CAP, P1, {pressure:.12g}"]
        text += ["*NODE PRINT, NSET=TUBE, FREQUENCY=1000", "U", "*END STEP"]
    return "\n".join(text) + "\n"


def run(
    program: str, folder: Path, mesh: Mesh, pressures: Sequence[float], limit: float,
    element: str = "C3D20R",
) -> Run:  # fmt: skip
    """Let CalculiX, on one thread, go as far as it gets within ``limit`` seconds."""
    (folder / "tube.inp").write_text(deck(mesh, pressures, element))
    begun = time.perf_counter()
    try:
        done = subprocess.run(
            [program, "-i", "tube"], cwd=folder, timeout=limit, capture_output=True, text=True,
            check=False, env={**os.environ, "OMP_NUM_THREADS": "1"},
        )  # fmt: skip
        said = done.stdout + done.stderr
    except subprocess.TimeoutExpired:
        said = f"stopped after {limit:g} s"
    seconds = time.perf_counter() - begun
    return Run(_positions(folder / "tube.dat", mesh, pressures), seconds, said)


def swollen_cube(rubber: MooneyRivlin, lam: float) -> str:
    """Write a deck that stretches a unit cube alike in all directions and prints its stress."""
    corners = [(x, y, z) for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]
    text = ["*NODE, NSET=NALL", *(_row(n, *at) for n, at in enumerate(corners, start=1))]
    text += ["*ELEMENT, TYPE=C3D8, ELSET=CUBE", "1, 1, 2, 3, 4, 5, 6, 7, 8"]
    text += [*_rubber(rubber), "*SOLID SECTION, ELSET=CUBE, MATERIAL=RUBBER"]
    text += ["*STEP, NLGEOM", "*STATIC", "1.0, 1.0", "*BOUNDARY"]
    text += [
        f"{n}, {i}, {i}, {(lam - 1.0) * value:.12g}"
        for n, at in enumerate(corners, start=1)
        for i, value in enumerate(at, start=1)
    ]
    return "\n".join([*text, "*EL PRINT, ELSET=CUBE", "S", "*END STEP"]) + "\n"


def mean_stress(program: str, folder: Path) -> float:
    """Run the cube's deck: the mean of its normal Cauchy stresses, MPa."""
    subprocess.run([program, "-i", "cube"], cwd=folder, check=True, capture_output=True, timeout=60)
    lines = (folder / "cube.dat").read_text().split("stresses")[-1].splitlines()[1:]
    values = np.array([line.split()[2:5] for line in lines if line.strip()], dtype=float)
    return float(values.mean())


def _threads(mesh: Mesh, family: str) -> Threads:
    """Links as thread points: each is one whose gradient takes the difference of two nodes."""
    gradient = np.zeros((mesh.layers, mesh.around, 5, 8))
    weight = np.zeros((mesh.layers, mesh.around, 5))
    for layer, face, q, i, k, length, EA in _links(mesh, family):
        gradient[layer, face, q, [i, k]] = -1.0 / length, 1.0 / length
        weight[layer, face, q] = EA * length
    return Threads(gradient.reshape(-1, 5, 8), weight.reshape(-1, 5))


def _springs(mesh: Mesh) -> dict[float, list[tuple[int, int]]]:
    """Nodes of the links by stiffness, N/mm; links of two faces on their border are added up."""
    total: dict[tuple[int, int], float] = defaultdict(float)
    row = mesh.ring + mesh.mid
    for family in ("axial", "hoop"):
        for layer, face, _, i, k, length, EA in _links(mesh, family):
            nodes = row * layer + mesh.outer[face]
            total[int(nodes[i]), int(nodes[k])] += EA / length
    groups: dict[float, list[tuple[int, int]]] = defaultdict(list)
    for pair, stiffness in total.items():
        if stiffness > 0.0:
            groups[float(f"{stiffness:.9g}")].append(pair)
    return groups


def _links(mesh: Mesh, family: str) -> Iterable[tuple[int, int, int, int, int, float, float]]:
    """Yield (layer, face, which, node, node, length in mm, EA in N) of all links."""
    a = mesh.actuator
    span = np.pi / mesh.around
    X = mesh.X.reshape(-1, 3)
    for layer in range(mesh.layers):
        middle = 0.5 * (mesh.z[layer] + mesh.z[layer + 1])
        window = next((w for w in a.windows if w.start < middle < w.end), None)
        for face in range(mesh.around):
            nodes = X[(mesh.ring + mesh.mid) * layer + mesh.outer[face]]
            width = span * a.radius if family == "axial" else mesh.heights[layer]
            if family == "axial" and window is not None:
                width *= _covered(face, span, 0.5 * (window.alpha + a.gauze.allowance))
            for q, (i, k, share) in enumerate(_AXIAL if family == "axial" else _HOOP):
                length = float(np.linalg.norm(nodes[k] - nodes[i]))
                yield layer, face, q, i, k, length, a.gauze.stiffness * width * share


def _covered(face: int, span: float, half: float) -> float:
    """Whether a face lies in a sector at 270 deg, whose edge must be a mesh line."""
    edge = half / span
    assert abs(edge - round(edge)) < 1e-9, "the sector's edge is not on a mesh line"
    return 1.0 if face < round(edge) else 0.0


def _cap(mesh: Mesh, first: int) -> tuple[FloatArray, NDArray[np.int64]]:
    """Nodes (from number ``first`` on) and C3D15 wedges, a fan that fills the last ring.

    Their inner faces P1 are the disc that the air pushes on.
    """
    at: list[FloatArray] = []
    known: dict[tuple[float, ...], int] = {}

    def node(x: FloatArray) -> int:
        key = tuple(np.round(x, 9) + 0.0)
        if key not in known:
            known[key] = first + len(at)
            at.append(x)
        return known[key]

    row = mesh.ring + mesh.mid
    X = mesh.X.reshape(-1, 3)
    base = row * (mesh.layers - 1)
    for n in base + mesh.inner[:, [3, 6, 2]].ravel():
        known[tuple(np.round(X[n], 9) + 0.0)] = int(n)
    up = np.array([0.0, 0.0, _CAP])
    middle = np.array([0.0, 0.0, mesh.z[-1]])
    wedges = []
    for face in mesh.inner:
        start, arc, end = X[base + face[[3, 6, 2]]]
        corners = [middle, start, end]
        sides = [0.5 * (middle + start), arc, 0.5 * (middle + end)]
        nodes = [*corners, *(c + up for c in corners), *sides, *(s + up for s in sides)]
        wedges.append([node(x) for x in [*nodes, *(c + 0.5 * up for c in corners)]])
    return np.array(at), np.array(wedges)


def _positions(dat: Path, mesh: Mesh, pressures: Sequence[float]) -> dict[float, FloatArray]:
    found: dict[float, FloatArray] = {}
    blocks = dat.read_text().split("displacements")[1:] if dat.exists() else []
    for block in blocks:
        head, *lines = block.strip().splitlines()
        step = float(head.split()[-1])  # each step takes a time of 1
        values = np.array([line.split() for line in lines if line.strip()], dtype=float)
        if abs(step - round(step)) > 1e-6 or len(values) != mesh.nodes:
            continue  # CalculiX was stopped in the middle of a step
        x = mesh.X.copy()
        flat = x.reshape(-1, 3)
        flat[values[:, 0].astype(int) - 1] += values[:, 1:]
        found[pressures[round(step) - 1]] = x
    return found


def _row(*values: float) -> str:
    return ", ".join(str(v) if isinstance(v, (int, np.integer)) else f"{v:.12g}" for v in values)


def _set(name: str, nodes: Iterable[int]) -> list[str]:
    return [f"*NSET, NSET={name}", *(f"{n}," for n in nodes)]


def _rubber(r: MooneyRivlin) -> list[str]:
    # Its U is 1/D1 (J - 1)^2.
    values = f"{r.C10:.12g}, {r.C01:.12g}, {2.0 / r.K:.12g}"
    return ["*MATERIAL, NAME=RUBBER", "*HYPERELASTIC, MOONEY-RIVLIN", values]
