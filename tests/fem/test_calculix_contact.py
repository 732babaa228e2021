"""Another program presses our finger on a plate: CalculiX (Debian: calculix-ccx)."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from fem.actuator import Actuator, Window
from fem.against import solve_against
from fem.contact import Contact
from fem.export.deck import Deck, make_deck
from fem.export.inp import write_calculix
from fem.export.springs import with_springs
from fem.gap import Plane
from fem.meshsize import MeshSize
from fem.solver import solve_mesh
from tests.fem import calculix
from tests.programs import program

pytestmark = pytest.mark.slow

PRESSURES = (0.04, 0.06, 0.08)  # MPa
SIZE = MeshSize(around=6, edge=1.0, growth=2.0, orders=(2, 2, 2))
LIMIT = 1800.0  # s; only a hang takes so long
PENALTY = 30.0  # MPa/mm
PLATE_Y = -6.5  # mm: 0.5 below the tube at rest
BLOCK = np.array([[x, y, z] for z in (15.0, 45.0) for y in (-9.0, PLATE_Y) for x in (-12.0, 12.0)])
_BRICK = (1, 2, 4, 3, 5, 6, 8, 7)  # of the block's nodes; its face 5 looks up


def tube() -> Actuator:
    window = Window(10.0, 5.0, np.radians(90.0), np.radians(270.0))
    return Actuator(30.0, (window,), diameter=12.0, wall=1.5)


def with_plate(deck: Deck, around: int, layers: int) -> str:
    """Add a plate that stands still, and its contact with the outside of the wall."""
    text = write_calculix(deck)
    number, node = deck.elements + 100, len(deck.X) + 100
    per_layer = len(deck.wall) // layers
    outer = [
        layer * per_layer + k + 1
        for layer in range(layers)
        for k in range(per_layer - around, per_layer)
    ]
    added = [
        "*NODE, NSET=PLATE",
        *(f"{node + k}, {x:g}, {y:g}, {z:g}" for k, (x, y, z) in enumerate(BLOCK, start=1)),
        "*ELEMENT, TYPE=C3D8, ELSET=PLATE",
        ", ".join(str(v) for v in (number, *(node + k for k in _BRICK))),
        "*SOLID SECTION, ELSET=PLATE, MATERIAL=STEEL",
        "*MATERIAL, NAME=STEEL",
        "*ELASTIC",
        "1000., 0.3",
        "*SURFACE, NAME=SKIN, TYPE=ELEMENT",
        *(f"{one}, S2" for one in outer),
        "*SURFACE, NAME=TOP, TYPE=ELEMENT",
        f"{number}, S5",
        "*SURFACE INTERACTION, NAME=TOUCH",
        "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR",
        f"{PENALTY:g}, 1e-4, 1e-2",
        "*CONTACT PAIR, INTERACTION=TOUCH, TYPE=SURFACE TO SURFACE",
        "SKIN, TOP",
        "*BOUNDARY",
        "PLATE, 1, 3",
    ]
    head, tail = text.split("*STEP", 1)
    steps = ("*STEP" + tail).replace(
        "*NODE PRINT, NSET=TIP",
        "*NODE PRINT, NSET=PLATE, TOTALS=ONLY, FREQUENCY=1000\nRF\n*NODE PRINT, NSET=TIP",
    )
    return head + "\n".join(added) + "\n" + steps


def pushes(dat: Path) -> list[float]:
    """What holds the plate along y at the end of every step, N."""
    lines = dat.read_text().splitlines()
    return [
        float(lines[k + 2].split()[1])
        for k, line in enumerate(lines)
        if line.strip().startswith("total force") and "PLATE" in line
    ]


def test_the_force_on_a_plate(tmp_path: Path) -> None:
    deck, mesh = make_deck(tube(), PRESSURES, SIZE)
    theirs = calculix.run(
        program("ccx"), tmp_path, deck, mesh, LIMIT,
        lambda made: with_plate(made, mesh.around, mesh.layers),
    )  # fmt: skip
    found = pushes(tmp_path / "actuator.dat")
    assert len(found) == len(PRESSURES), theirs.said[-2000:]
    plate = Plane(np.array([0.0, PLATE_Y, 0.0]), np.array([0.0, 1.0, 0.0]))
    free = solve_mesh(with_springs(mesh), PRESSURES, threads=1)
    ours = solve_against(free, Contact(plate, penalty=PENALTY), PRESSURES, settle=False, threads=1)
    assert ours.failure is None
    for touch, state, force, x in zip(
        ours.touches, ours.states, found, theirs.x.values(), strict=True
    ):
        assert touch.force[1] == pytest.approx(-2.0 * force, rel=0.015)
        off = np.linalg.norm(state.x[-1] - x[-1], axis=-1).max()
        assert off < 0.03
