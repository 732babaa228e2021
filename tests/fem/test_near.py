"""A state found from a similar actuator's state, against the path from rest."""

from __future__ import annotations

import pickle
from dataclasses import replace

import numpy as np
import pytest

from fem.actuator import Actuator, Window, chain
from fem.errors import NotConverged
from fem.material import MooneyRivlin
from fem.mesh import alike, make_mesh
from fem.meshsize import DEFAULT_MESH
from fem.near import between, solve_near
from fem.rates import flow_to
from fem.sensitivity import sensitivities
from fem.solution import Solution
from fem.solver import solve
from fem.transfer import transfer

PRESSURE = 0.12
SIZE = replace(DEFAULT_MESH, edge=1.0)
ACTUATOR = chain(
    10.0, [16.0, 12.0], [8.0, 6.0], np.radians([110.0, 130.0]), np.radians([270.0, 90.0])
)  # fmt: skip


@pytest.fixture(scope="module")
def known() -> Solution:
    return solve(ACTUATOR, [PRESSURE], SIZE)


def changed(alpha_deg: float, places: float, length: float = 0.0) -> Actuator:
    windows = tuple(
        replace(w, alpha=w.alpha + np.radians(alpha_deg) * sign, centre=w.centre + places * sign)
        for w, sign in zip(ACTUATOR.windows, (1.0, -1.0), strict=True)
    )
    return replace(ACTUATOR, windows=windows, length=ACTUATOR.length + length)


def tip(solution: Solution) -> np.ndarray:
    return solution.states[-1].shape.facing[-1]


def test_the_same_actuator_needs_no_step(known: Solution) -> None:
    again = solve_near(ACTUATOR, known, PRESSURE)
    assert again.newton_iterations == 0
    np.testing.assert_allclose(again.states[-1].x, known.states[-1].x, atol=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("alpha_deg", "places", "length"),
    [(3.0, 0.0, 0.0), (-2.0, 0.3, 1.5), pytest.param(0.0, 0.5, 0.0, marks=pytest.mark.slow)],
)
def test_ends_where_the_path_from_rest_ends(
    known: Solution, alpha_deg: float, places: float, length: float
) -> None:
    actuator = changed(alpha_deg, places, length)
    near, path = solve_near(actuator, known, PRESSURE), solve(actuator, [PRESSURE], SIZE)
    assert near.mesh.actuator == actuator
    assert near.states[-1].residual <= 1e-6
    assert np.isnan(near.states[-1].energy_error)  # not known, and not said to be fine
    assert near.factorisations < path.factorisations
    # The meshes differ a little where sectors change: some hundredths of a degree.
    np.testing.assert_allclose(near.states[-1].theta, path.states[-1].theta, atol=1.5e-3)
    np.testing.assert_allclose(tip(near), tip(path), atol=0.05)


@pytest.mark.slow
def test_another_pressure(known: Solution) -> None:
    near = solve_near(ACTUATOR, known, 0.9 * PRESSURE)
    path = solve(ACTUATOR, [0.9 * PRESSURE], SIZE)
    np.testing.assert_allclose(near.states[-1].theta, path.states[-1].theta, rtol=1e-5)


def test_an_expected_motion_saves_steps(known: Solution) -> None:
    actuator = changed(0.0, 0.5)
    rates = sensitivities(known.mesh, known.states[-1].x, PRESSURE, angles=False)
    flow = flow_to(rates, known.mesh.actuator, actuator, -0.02 * PRESSURE)
    expected = solve_near(actuator, known, 0.98 * PRESSURE, flow=flow)
    plain = solve_near(actuator, known, 0.98 * PRESSURE)
    assert expected.factorisations < plain.factorisations
    np.testing.assert_allclose(expected.states[-1].theta, plain.states[-1].theta, atol=1e-5)


@pytest.mark.slow
def test_an_expected_motion_of_another_mesh_is_left(known: Solution) -> None:
    # Here the sectors' edges part, and each gets bricks of its own.
    windows = list(ACTUATOR.windows)
    windows[1] = replace(windows[1], alpha=windows[1].alpha + np.radians(25.0))
    actuator = replace(ACTUATOR, windows=tuple(windows))
    assert not alike(make_mesh(actuator, SIZE, like=known.mesh), known.mesh)
    flow = np.zeros_like(known.mesh.X)
    near = solve_near(actuator, known, PRESSURE, flow=flow)
    path = solve(actuator, [PRESSURE], SIZE)
    np.testing.assert_allclose(near.states[-1].theta, path.states[-1].theta, atol=2e-3)


def test_no_state_there_is_said_so(known: Solution) -> None:
    with pytest.raises(NotConverged) as failure:
        solve_near(ACTUATOR, known, 5.0)
    error = failure.value
    assert error.history
    # Not a step of the way was made: there is the state at rest alone.
    assert error.solution is not None
    assert [state.pressure for state in error.solution.states] == [0.0]
    assert not error.solution.converged
    copy = pickle.loads(pickle.dumps(error))
    assert (str(copy), copy.history) == (str(error), error.history)


@pytest.mark.slow
def test_the_last_state_on_the_way_is_carried(known: Solution) -> None:
    # With rubber half as stiff the known state is too far off, with three quarters it is not.
    law = ACTUATOR.rubber.constants
    soft = MooneyRivlin(*(0.5 * law[name] for name in ("C10", "C01", "K")))
    with pytest.raises(NotConverged) as failure:
        solve_near(replace(ACTUATOR, rubber=soft), known, PRESSURE)
    solution = failure.value.solution
    assert solution is not None
    assert failure.value.reached == 0.0  # no state of the asked actuator
    assert [state.pressure for state in solution.states] == [0.0, PRESSURE]
    assert solution.states[-1].residual <= 1e-6
    reached = solution.mesh.actuator.rubber.constants
    assert reached["C10"] == pytest.approx(0.75 * law["C10"])
    assert solution.history[-1].outcome != "converged"


def test_transfer_keeps_strains_where_a_sector_grows(known: Solution) -> None:
    longer = replace(
        ACTUATOR,
        length=ACTUATOR.length + 2.0,
        windows=tuple(replace(w, centre=w.centre + 2.0) for w in ACTUATOR.windows),
    )
    mesh = make_mesh(longer, SIZE, like=known.mesh)
    x = transfer(known.mesh, known.states[-1].x, mesh)
    # All but the root, which is straight, is the same body, moved by 2 mm.
    before = known.states[-1].shape.facing
    after = x[:, mesh.outer_ring[np.argmin(mesh.X[0, mesh.outer_ring, 1])]]
    last = np.diff(before, axis=0)[known.mesh.segment > 0]
    np.testing.assert_allclose(
        np.linalg.norm(np.diff(after, axis=0)[mesh.segment > 0], axis=1),
        np.linalg.norm(last, axis=1),
        atol=1e-9,
    )


def test_between_two_actuators() -> None:
    middle = between(ACTUATOR, changed(4.0, 1.0, 2.0), 0.5)
    assert middle == changed(2.0, 0.5, 1.0) or all(
        abs(a.alpha - b.alpha) < 1e-12 and abs(a.centre - b.centre) < 1e-12
        for a, b in zip(middle.windows, changed(2.0, 0.5, 1.0).windows, strict=True)
    )
    assert middle.length == pytest.approx(ACTUATOR.length + 1.0)
    assert isinstance(middle.windows[0], Window)
