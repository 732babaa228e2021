"""The path: asked pressures, limit points, honest failures."""

from __future__ import annotations

import pickle

import numpy as np
import pytest

from fem.actuator import Actuator, chain
from fem.assembly import System
from fem.equilibrium import lagrange
from fem.errors import NotConverged
from fem.gauze import Gauze
from fem.items import Batch
from fem.loadpath import Options
from fem.material import NeoHooke
from fem.mesh import Mesh
from fem.meshsize import MeshSize
from fem.solution import Solution
from fem.solver import solve

COARSE = MeshSize(around=3, beside=0.0, edge=2.0, growth=2.0)
SHORT = chain(8.0, [14.0], [6.0], [np.radians(100.0)])
SPOILT = 1.06  # times the volume at rest: between 0.04 and 0.06 MPa
SOFT = Gauze(stiffness=1e-3)  # hardly any: the tube balloons


def balloon() -> Actuator:
    """A neo-Hookean tube that the gauze does not hold."""
    rubber = NeoHooke.from_poisson(0.1, 0.46)
    return Actuator(40.0, (), rubber=rubber, gauze=SOFT)


def test_asked_pressures_are_reached_exactly_and_in_order() -> None:
    run = solve(SHORT, [0.11, 0.03, 0.0, 0.07], COARSE)
    assert [state.pressure for state in run.states] == [0.0, 0.03, 0.07, 0.11]
    assert run.converged
    assert all(np.diff([state.theta[0] for state in run.states]) > 0.0)


@pytest.mark.parametrize("pressure", [-0.1, np.nan, np.inf])
def test_pressures_that_make_no_sense(pressure: float) -> None:
    with pytest.raises(ValueError, match="finite"):
        solve(SHORT, [pressure], COARSE)


@pytest.fixture(scope="module")
def stepped() -> Solution:
    """The balloon by way of three pressures that it stands."""
    return solve(balloon(), [0.01, 0.02, 0.03, 0.5], COARSE)


@pytest.fixture(scope="module")
def at_once() -> tuple[Solution, list[float]]:
    """The balloon straight to a pressure that it does not stand, and beyond by its volume.

    With the pressures that were told on the way.
    """
    told: list[float] = []
    return solve(balloon(), [0.5], COARSE, Options(beyond=0.3), progress=told.append), told


def test_a_balloon_has_a_limit_point_with_its_pressure(stepped: Solution) -> None:
    run = stepped
    assert not run.converged
    assert run.critical is not None
    assert run.critical.kind == "limit point"
    # The states up to it are there, and what lies above the limit is not.
    assert [state.pressure for state in run.states] == [0.0, 0.01, 0.02, 0.03]
    # A long thin neo-Hookean tube balloons at hoop stretches of 1.5 to 2: about mu s / r.
    mu, s, r = 0.2, 2.0, 9.0
    assert 0.5 * mu * s / r < run.critical.pressure < 1.2 * mu * s / r


def test_the_limit_does_not_depend_on_the_steps(
    stepped: Solution, at_once: tuple[Solution, list[float]]
) -> None:
    one, other = stepped.critical, at_once[0].critical
    assert one is not None
    assert other is not None
    assert one.pressure == pytest.approx(other.pressure, rel=2e-3)


def test_the_path_goes_on_past_the_limit_by_volume(
    at_once: tuple[Solution, list[float]],
) -> None:
    run, reached = at_once
    assert run.critical is not None
    assert reached[-1] < run.critical.pressure
    assert max(reached) <= run.critical.pressure * (1.0 + 1e-6)


@pytest.mark.slow
def test_what_lies_a_little_ahead_is_told(stepped: Solution) -> None:
    assert stepped.critical is not None
    limit = stepped.critical.pressure
    near = solve(balloon(), [0.02, 0.97 * limit], COARSE, Options(ahead=0.05 * limit))
    assert near.converged
    assert near.critical is None
    assert [state.pressure for state in near.states] == [0.0, 0.02, 0.97 * limit]
    assert near.ahead is not None
    assert near.ahead.kind == "limit point"
    assert near.ahead.pressure == pytest.approx(limit, rel=2e-3)
    far = solve(balloon(), [0.9 * limit], COARSE, Options(ahead=0.05 * limit))
    assert far.converged
    assert far.ahead is None
    assert len(far.states) == 2


@pytest.mark.slow
def test_a_limit_below_the_asked_pressure_is_not_ahead() -> None:
    run = solve(balloon(), [0.5], COARSE, Options(ahead=0.02))
    assert run.critical is not None
    assert run.ahead is None


def test_not_converged_carries_its_history() -> None:
    # A tolerance below the last bits cannot be met.
    with pytest.raises(NotConverged, match="no equilibrium found") as caught:
        solve(SHORT, [0.05], COARSE, Options(tolerance=1e-18))
    assert caught.value.history
    assert caught.value.reached < 0.05
    assert all(attempt.outcome != "converged" for attempt in caught.value.history[-1:])


def passed_on(error: NotConverged) -> NotConverged:
    """The error as another process gets it."""
    copy = pickle.loads(pickle.dumps(error))
    assert isinstance(copy, NotConverged)
    return copy


@pytest.fixture(scope="module")
def stuck() -> NotConverged:
    """A path that reaches two asked pressures of three: the rubber is lost at the third."""
    with pytest.raises(NotConverged) as caught:
        solve(SHORT, [0.02, 0.04, 0.06], COARSE, extra=[Spoilt])
    return caught.value


class Spoilt:
    """An item that turns every brick inside out once the air inside has grown by 6 %."""

    def __init__(self, mesh: Mesh) -> None:
        self._system = System(mesh, 1)
        self._rest = float(self._system.forces(mesh.X).volume)

    def add(self, batch: Batch) -> None:
        x = batch.x.reshape(self._system.mesh.X.shape)
        if self._system.forces(x).volume > SPOILT * self._rest:
            batch.sums.least_J = -1.0


def test_not_converged_carries_the_states_that_were_reached(stuck: NotConverged) -> None:
    error = stuck
    assert error.solution is not None
    states = error.solution.states
    assert [state.pressure for state in states] == [0.0, 0.02, 0.04]
    assert error.reached >= 0.04
    assert not error.solution.converged
    assert error.solution.critical is None
    assert error.solution.failure == str(error)
    assert error.solution.history == error.history
    # They are the states that a run to there gives.
    run = solve(SHORT, [0.02, 0.04], COARSE)
    for state, other in zip(states, run.states, strict=True):
        np.testing.assert_allclose(state.x, other.x, atol=1e-4)
        assert state.energy_error <= 1e-3


def test_not_converged_at_once_carries_the_state_at_rest() -> None:
    with pytest.raises(NotConverged) as caught:
        solve(SHORT, [0.05], COARSE, Options(tolerance=1e-18))
    assert caught.value.solution is not None
    assert [state.pressure for state in caught.value.solution.states] == [0.0]


def test_not_converged_goes_from_process_to_process(stuck: NotConverged) -> None:
    error = stuck
    copy = passed_on(error)
    assert str(copy) == str(error)
    assert (copy.history, copy.reached) == (error.history, error.reached)
    assert copy.solution is not None
    assert error.solution is not None
    np.testing.assert_array_equal(copy.solution.states[-1].x, error.solution.states[-1].x)
    assert passed_on(NotConverged("far", (), 0.1)).solution is None


def test_weights_reproduce_a_polynomial() -> None:
    places = np.array([0.1, 0.4, 0.7, 0.75])
    assert lagrange(places, 1.1) @ (places**3 - places) == pytest.approx(1.1**3 - 1.1)
