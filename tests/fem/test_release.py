"""Obstacles that are let go: the border's derivatives, balance, and which way they go."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from fem import blas
from fem.against import solve_against
from fem.assembly import System
from fem.body import Body, Moved, border_of
from fem.contact import Contact, Pressed
from fem.gap import Sphere
from fem.outline import Extruded, Outline
from fem.solution import Solution
from fem.solver import solve
from tests.fem.test_against import joint
from tests.fem.tubes import COARSE, bent, mesh_of

FloatArray = NDArray[np.float64]
BALL = Sphere(np.array([0.0, -23.2, 26.0]), 12.0)
PLANE = np.eye(3) * [1.0, 1.0, 0.1]  # of a turn, a tenth of a rad counts as a mm


@pytest.fixture(scope="module")
def free() -> Solution:
    return solve(joint(), [0.02, 0.04, 0.06], COARSE)


def test_the_border_holds_derivatives_of_the_energy() -> None:
    contact = Contact(BALL, penalty=2.0, ramp=3.0)
    ball, motion = Sphere(np.array([0.0, -19.0, 12.0]), 11.0), np.array([0.3, -0.2, 0.4])
    body = Body(PLANE, np.zeros(3), np.array([0.0, -16.0, 9.0]))
    with blas.one_thread():
        system = System(mesh_of(), 1, [contact])

        def seen(x: FloatArray, q: FloatArray) -> tuple[float, FloatArray, FloatArray]:
            at = motion + q @ body.ways
            contact.obstacle = Moved(ball, at, body.about)
            slope = border_of(contact, system.mesh, x, body, at).slope
            return contact.energy(system.mesh, x), slope, system.forces(x).internal

        x = bent(system, 6).x
        seen(x, np.zeros(3))
        border, h = border_of(contact, system.mesh, x, body, motion), 1e-5
        for k, way in enumerate(np.eye(3)):
            high, low = seen(x, h * way), seen(x, -h * way)
            energy, slope, internal = ((a - b) / (2.0 * h) for a, b in zip(high, low, strict=True))
            assert border.slope[k] == pytest.approx(energy, rel=1e-6)
            np.testing.assert_allclose(border.curve[k], slope, rtol=1e-5, atol=1e-6)
            mixed = system.restrict(x, border.mixed[k])
            np.testing.assert_allclose(mixed, internal, atol=1e-6)
        system.close()


@pytest.mark.slow
@pytest.mark.parametrize(("turn", "inward"), [(0.0, True), (60.0, False)])
def test_a_ball_held_behind_its_equator_comes_in_and_before_it_goes_out(
    free: Solution, turn: float, inward: bool
) -> None:
    """Along an axis that points away from the clamp, ``turn`` deg off the tube at rest."""
    way = np.array([-np.sin(np.radians(turn)), np.cos(np.radians(turn)), 0.0])
    held = solve_against(free, BALL, [0.06])
    push = float(way[:2] @ held.touches[0].force[1:])
    assert (push < 0.0) == inward
    for share in (0.5, 0.0):
        body = Body(way[None], -share * push * way, BALL.centre)
        (let,) = solve_against(free, BALL, [0.06], body=body).released
        assert (float(way @ let.motion) < -0.01) == inward
        force = 2.0 * let.pressed.force.sum(axis=(0, 1, 2))
        assert float(way[:2] @ (force[1:] + body.load[:2])) == pytest.approx(0.0, abs=1e-6)
        assert let.end == ("rests" if share > 0.0 else "leaves")
        assert let.pressed.depth < 0.02


@pytest.mark.slow
def test_a_cradle_is_in_balance_in_the_plane(free: Solution) -> None:
    """It follows the tube's line at a lower pressure, and is pressed on the tube a little less."""
    line = free.states[2].shape.facing[:, [2, 1]]
    cradle = Extruded(Outline(line + np.array([0.0, -0.3])))
    middle = np.array([0.0, -11.0, 25.0])

    def pull(pressed: Pressed, centre: FloatArray) -> FloatArray:
        arm, force = (rows.reshape(-1, 3) for rows in (pressed.points - centre, pressed.force))
        moment = np.cross(arm, force)[:, 0].sum()
        return 2.0 * np.array([*force.sum(axis=0)[1:], moment])

    held = solve_against(free, cradle, [0.06])
    body = Body(PLANE, -0.8 * pull(held.touches[0].pressed, middle), middle)
    (let,) = solve_against(free, cradle, [0.06], body=body).released
    assert let.end == "rests"
    assert np.abs(let.motion).min() > 1e-3
    moved = middle + np.array([0.0, *let.motion[:2]])
    np.testing.assert_allclose(pull(let.pressed, moved), -body.load, atol=1e-6)


def test_an_obstacle_with_friction_is_not_let_go(free: Solution) -> None:
    body = Body(PLANE, np.zeros(3), BALL.centre)
    with pytest.raises(ValueError, match="friction"):
        solve_against(free, Contact(BALL, friction=0.3), [0.06], body=body)
