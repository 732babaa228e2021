"""Friction: forces and stiffness as derivatives, its bound, and what it does to a pressed joint."""

from __future__ import annotations

import numpy as np
import pytest

from fem.against import solve_against
from fem.contact import Contact
from fem.friction import RAMP_MM, Hold
from fem.solver import solve
from tests.fem.test_against import FLOOR, joint
from tests.fem.tubes import COARSE


def held() -> tuple[Hold, np.ndarray]:
    rng = np.random.default_rng(5)
    normal = rng.normal(size=(1, 1, 30, 3))
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    points = rng.normal(size=(1, 1, 30, 3))
    hold = Hold(points, normal, rng.uniform(0.0, 0.2, (1, 1, 30)))
    return hold, points + 2.0 * RAMP_MM * rng.normal(size=points.shape)


def test_force_and_stiffness_are_derivatives_and_symmetric() -> None:
    hold, x = held()
    _, force, stiffness = hold.respond(x)
    h = 1e-6
    for k in range(3):
        step = h * np.eye(3)[k]
        high, low = hold.respond(x + step), hold.respond(x - step)
        np.testing.assert_allclose(force[..., k], (high[0] - low[0]) / (2.0 * h), atol=1e-8)
        slope = (high[1] - low[1]) / (2.0 * h)
        np.testing.assert_allclose(stiffness[..., k], slope, atol=1e-5)
    np.testing.assert_allclose(stiffness, np.swapaxes(stiffness, -1, -2), atol=1e-14)
    size = np.linalg.norm(force, axis=-1)
    assert (size <= hold.bound + 1e-12).all()
    assert np.isclose(size, hold.bound).any()
    np.testing.assert_allclose((force * hold.normal).sum(axis=-1), 0.0, atol=1e-12)


def test_a_held_point_keeps_its_friction() -> None:
    hold, x = held()
    next_hold = Hold(hold.dragged(x), hold.normal, hold.bound)
    np.testing.assert_allclose(next_hold.respond(x)[1], hold.respond(x)[1], atol=1e-12)


@pytest.mark.slow
def test_friction_resists_and_is_borne_by_the_clamp() -> None:
    free = solve(joint(), [0.02, 0.04, 0.06], COARSE)
    plain = solve_against(free, FLOOR, [0.06])
    rough = solve_against(free, Contact(FLOOR, friction=0.4), [0.06], tolerance=1e-8)
    assert rough.failure is None
    force = rough.touches[-1].force
    assert abs(plain.touches[-1].force[2]) < 1e-9
    assert 0.0 < abs(force[2]) <= 0.4 * abs(force[1]) * (1.0 + 1e-6)
    # The tube grows along the floor and drags it outward; the clamp bears that.
    assert force[2] > 0.0
    drag = rough.touches[-1].clamp[2] - plain.touches[-1].clamp[2]
    assert drag == pytest.approx(force[2], rel=1e-4)
