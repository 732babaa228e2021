"""Another program solves our model: CalculiX, where it is installed (Debian: calculix-ccx)."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from fem.actuator import Actuator, Window, chain
from fem.export.deck import Deck, make_deck
from fem.export.expected import Expected, expect
from fem.export.inp import write_abaqus
from fem.measure import joint_angles, lines, sectors
from fem.mesh import Mesh
from fem.meshsize import MeshSize
from fem.solver import solve
from tests.fem import calculix
from tests.programs import program

PRESSURES = (0.04, 0.07, 0.1)  # MPa
LIMIT = 1800.0  # s; only a hang takes so long

pytestmark = pytest.mark.slow


def joint() -> Actuator:
    return chain(30.0, [30.0], [10.0], [np.radians(84.0)])


@pytest.fixture(scope="module")
def made() -> tuple[Deck, Mesh]:
    return make_deck(joint(), PRESSURES)


@pytest.fixture(scope="module")
def theirs(made: tuple[Deck, Mesh], tmp_path_factory: pytest.TempPathFactory) -> calculix.Run:
    run = calculix.run(program("ccx"), tmp_path_factory.mktemp("ccx"), *made, LIMIT)
    assert tuple(run.x) == PRESSURES, run.said[-2000:]
    return run


@pytest.fixture(scope="module")
def ours(made: tuple[Deck, Mesh]) -> Expected:
    return expect(*made, threads=1)


def angle(mesh: Mesh, x: np.ndarray) -> float:
    """Of the joint, rad, as `fem.State` gives it."""
    return float(joint_angles(mesh, x, sectors(mesh, lines(mesh, x)))[0])


def test_one_and_the_same_discrete_problem(
    made: tuple[Deck, Mesh],
    theirs: calculix.Run,
    ours: Expected,
    record_property: Callable[..., None],
) -> None:
    deck, mesh = made
    record_property("seconds", round(theirs.seconds, 1))
    assert ours.pressure.tolist() == list(PRESSURES)
    for step, x in enumerate(theirs.x.values()):
        theta, tip = angle(mesh, x), x.reshape(-1, 3)[deck.tip] - deck.X[deck.tip]
        record_property("angles_deg", [float(np.degrees(a)) for a in (theta, ours.theta[step, 0])])
        assert ours.theta[step, 0] == pytest.approx(theta, rel=2e-3)
        off = np.linalg.norm(ours.tip[step] - tip)
        assert off < 2e-3 * np.linalg.norm(tip)


def test_the_smeared_gauze_and_our_quadrature(
    made: tuple[Deck, Mesh], theirs: calculix.Run
) -> None:
    # What a user gets: default mesh, gauze and quadrature.
    run = solve(joint(), PRESSURES, threads=1)
    for state, x in zip(run.states[1:], theirs.x.values(), strict=True):
        assert state.theta[0] == pytest.approx(angle(made[1], x), rel=0.03)


def test_abaqus_deck_of_a_whole_tube_in_calculix(tmp_path: Path) -> None:
    # It knows all words but the rotations of a cap on the plane of symmetry, and writes every step.
    window = Window(10.0, 5.0, 1.5, np.radians(210.0))
    size = MeshSize(around=4, edge=2.0, growth=2.0, orders=(2, 2, 2))
    made = make_deck(Actuator(22.0, (window,), diameter=12.0, wall=1.5), (0.02,), size)

    def write(deck: Deck) -> str:
        return write_abaqus(deck).replace("*OUTPUT, FIELD, VARIABLE=PRESELECT", "*NODE FILE\nU")

    (x,) = calculix.run(program("ccx"), tmp_path, *made, LIMIT, write).x.values()
    tip = x.reshape(-1, 3)[made[0].tip] - made[0].X[made[0].tip]
    ours = expect(*made, threads=1).tip[0]
    assert np.linalg.norm(tip - ours) < 2e-3 * np.linalg.norm(ours)
