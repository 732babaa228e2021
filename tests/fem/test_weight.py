"""The weight of an actuator: sums, closed forms of linear beams, derivatives, symmetry."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from fem.actuator import Actuator, chain
from fem.assembly import System
from fem.deadweight import Deadweight
from fem.gauze import Gauze
from fem.mesh import make_mesh
from fem.meshsize import MeshSize
from fem.near import solve_near
from fem.parameters import families
from fem.sensitivity import sensitivities
from fem.solver import solve
from fem.weight import Weight
from tests.fem.tubes import COARSE

RUBBER, GAUZE = 1.08e-5, 1.1e-6  # N/mm^3, N/mm^2
SIZE = MeshSize(around=4, beside=0.0, edge=2.0, growth=2.0)
LENGTH, PLUG, R, WALL = 150.0, 1.0, 10.0, 2.0
AREA = np.pi * (R**2 - (R - WALL) ** 2)
PER_LENGTH = RUBBER * AREA + GAUZE * 2.0 * np.pi * R
PLUG_N = RUBBER * np.pi * R**2 * PLUG


def plain(direction: tuple[float, float, float], gauze: Gauze) -> Actuator:
    """A long tube without joints that hangs from its clamp."""
    return Actuator(LENGTH, (), gauze=gauze, weight=Weight(direction, RUBBER, GAUZE))


def sagged(actuator: Actuator, whole: bool = False) -> NDArray[np.float64]:
    """Motion of the last ring's middle by the linear equations at rest, mm."""
    mesh = make_mesh(actuator, SIZE, whole)
    system = System(mesh, threads=1)
    try:
        forces, inverse = system.factor(mesh.X, 0.0)
        assert inverse is not None
        moved = system.expand(mesh.X, inverse.solve(-forces.residual(0.0)))
    finally:
        system.close()
    middle: NDArray[np.float64] = moved[-1, mesh.outer_ring].mean(axis=0)
    return middle


@pytest.mark.parametrize("whole", [False, True])
def test_the_forces_sum_up_to_the_weight(whole: bool) -> None:
    direction = (0.0, 0.6, 0.8)
    mesh = make_mesh(plain(direction, Gauze()), SIZE, whole)
    system = System(mesh, threads=1)
    pulled = -system.forces(mesh.X).internal
    clamped = np.zeros_like(mesh.X)
    for part in system._parts:
        clamped += part.sums.internal
    system.close()
    weight = PER_LENGTH * (LENGTH - PLUG) + PLUG_N
    total = -clamped.reshape(-1, 3).sum(axis=0) * (1.0 if whole else 2.0)
    assert total[1:] == pytest.approx(weight * np.array(direction[1:]), rel=2e-3)
    assert np.abs(pulled).max() > 0.0


def test_a_hanging_tube_grows_by_its_own_weight() -> None:
    # Without the gauze: w L^2 / (2 E A) + plug L / (E A), but for the clamp's hold on its width.
    soft = Gauze(stiffness=1e-7)
    actuator = plain((0.0, 0.0, 1.0), soft)
    E = 2.0 * actuator.rubber.shear_modulus * 1.46
    free = LENGTH - PLUG
    expected = (0.5 * PER_LENGTH * free**2 + PLUG_N * free) / (E * AREA)
    assert sagged(actuator)[2] == pytest.approx(expected, rel=0.02)


def test_a_level_tube_sags_like_a_beam() -> None:
    # w L^4 / (8 E I) + plug L^3 / (3 E I), and the shear's share of a thin tube.
    actuator = plain((0.0, -1.0, 0.0), Gauze(stiffness=1e-7))
    G = actuator.rubber.shear_modulus
    E, free = 2.0 * G * 1.46, LENGTH - PLUG
    second = np.pi / 4.0 * (R**4 - (R - WALL) ** 4)
    bending = PER_LENGTH * free**4 / (8.0 * E * second) + PLUG_N * free**3 / (3.0 * E * second)
    shear = (0.5 * PER_LENGTH * free**2 + PLUG_N * free) / (0.53 * G * AREA)
    assert -sagged(actuator)[1] == pytest.approx(bending + shear, rel=0.03)
    sideways = sagged(plain((1.0, 0.0, 0.0), Gauze(stiffness=1e-7)))
    assert sideways[0] == pytest.approx(bending + shear, rel=0.03)


def test_gravity_out_of_the_plane_takes_the_whole_tube() -> None:
    assert plain((0.0, 0.6, 0.8), Gauze()).in_plane
    assert not plain((0.6, 0.0, 0.8), Gauze()).in_plane
    assert not make_mesh(plain((1.0, 0.0, 0.0), Gauze()), SIZE).half


@pytest.mark.slow
def test_energy_is_balanced_and_derivatives_hold_under_gravity() -> None:
    heavy = Weight((0.0, 1.0, 0.0), 40.0 * RUBBER, GAUZE)
    joint = chain(6.0, [8.0], [5.0], [np.radians(100.0)], weight=heavy)
    found = solve(joint, [0.03, 0.05], COARSE, threads=1)
    light = solve(replace(joint, weight=None), [0.05], COARSE, threads=1)
    assert found.states[-1].energy_error < 1e-3
    assert abs(found.states[-1].theta[0] - light.states[-1].theta[0]) > 1e-3
    rates, step = sensitivities(found.mesh, found.states[-1].x, 0.05, threads=1), 0.02
    _, _, wraps, (wall,), _ = families(1)
    for rate, parameter in [(rates.wrapped[0], wraps[0]), (rates.wall, wall)]:
        ends = [
            solve_near(parameter.change(joint, sign * step), found, 0.05, threads=1).states[-1]
            for sign in (1.0, -1.0)
        ]
        by_difference = (ends[0].theta[0] - ends[1].theta[0]) / (2.0 * step)
        assert rate.theta[0] == pytest.approx(by_difference, rel=0.01, abs=1e-5)


@pytest.mark.parametrize(
    ("direction", "rubber"), [((0.0, 1.0, 1.0), RUBBER), ((0.0, 1.0, 0.0), -1.0)]
)
def test_weights_that_make_no_sense(direction: tuple[float, float, float], rubber: float) -> None:
    with pytest.raises(ValueError, match="a weight needs"):
        Weight(direction, rubber, GAUZE)


def test_no_item_without_a_weight() -> None:
    with pytest.raises(ValueError, match="no weight"):
        Deadweight(make_mesh(Actuator(30.0, ()), SIZE))
