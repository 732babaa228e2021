"""The path: asked pressures, limit points, honest failures."""

from __future__ import annotations

import numpy as np
import pytest

from fem.actuator import Actuator, chain
from fem.errors import NotConverged
from fem.gauze import Gauze
from fem.loadpath import Options, lagrange
from fem.material import NeoHooke
from fem.meshsize import MeshSize
from fem.solve import solve

COARSE = MeshSize(around=3, beside=0.0, edge=2.0, growth=2.0)
SHORT = chain(8.0, [14.0], [6.0], [np.radians(100.0)])
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


def test_a_balloon_has_a_limit_point_with_its_pressure() -> None:
    run = solve(balloon(), [0.01, 0.5], COARSE)
    assert not run.converged
    assert run.critical is not None
    assert run.critical.kind == "limit point"
    # The states up to it are there, and what lies above the limit is not.
    assert [state.pressure for state in run.states] == [0.0, 0.01]
    # A long thin neo-Hookean tube balloons at hoop stretches of 1.5 to 2: about mu s / r.
    mu, s, r = 0.2, 2.0, 9.0
    assert 0.5 * mu * s / r < run.critical.pressure < 1.2 * mu * s / r


def test_the_limit_does_not_depend_on_the_steps() -> None:
    found = [solve(balloon(), asked, COARSE).critical for asked in ([0.5], [0.01, 0.02, 0.03, 0.5])]
    assert found[0] is not None
    assert found[1] is not None
    assert found[0].pressure == pytest.approx(found[1].pressure, rel=2e-3)


def test_the_path_goes_on_past_the_limit_by_volume() -> None:
    reached: list[float] = []
    options = Options(beyond=0.3)
    run = solve(balloon(), [0.5], COARSE, options, progress=reached.append)
    assert run.critical is not None
    assert reached[-1] < run.critical.pressure
    assert max(reached) <= run.critical.pressure * (1.0 + 1e-6)


def test_not_converged_carries_its_history() -> None:
    # A tolerance below the last bits cannot be met.
    with pytest.raises(NotConverged, match="no equilibrium found") as caught:
        solve(SHORT, [0.05], COARSE, Options(tolerance=1e-18))
    assert caught.value.history
    assert caught.value.reached < 0.05
    assert all(attempt.outcome != "converged" for attempt in caught.value.history[-1:])


def test_weights_reproduce_a_polynomial() -> None:
    places = np.array([0.1, 0.4, 0.7, 0.75])
    assert lagrange(places, 1.1) @ (places**3 - places) == pytest.approx(1.1**3 - 1.1)
