"""Direct differentiation against differences of whole solutions."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from fem.actuator import Actuator, Window, chain
from fem.errors import FemError
from fem.material import MooneyRivlin
from fem.meshsize import MeshSize
from fem.near import solve_near
from fem.parameters import alpha_center, poisson, rubber_constant
from fem.rates import Rate, Sensitivities
from fem.sensitivity import rates_by, sensitivities
from fem.solution import State
from fem.solver import solve
from tests.fem.laws import RUBBERS

# Even bricks: the mesh itself must not follow the sectors, or it would change with alpha.
SIZE = MeshSize(around=4, beside=0.0, edge=2.0, growth=2.0)
PRESSURE = 0.1


def two(center: tuple[float, float]) -> Actuator:
    return chain(
        12.0, [14.2, 12.1], [6.3, 5.7], np.radians([100.0, 120.0]), np.radians(center), end=2.0
    )


def widened(actuator: Actuator, number: int, by: float) -> Actuator:
    windows = list(actuator.windows)
    windows[number] = replace(windows[number], alpha=windows[number].alpha + by)
    return replace(actuator, windows=tuple(windows))


def lengthened(actuator: Actuator, segment: int, by: float) -> Actuator:
    """Segments in order: root, first cut, wrapped, second cut, rest."""
    lengths = np.diff([0.0, *[e for w in actuator.windows for e in (w.start, w.end)]])
    lengths = np.append(lengths, actuator.length - lengths.sum())
    lengths[segment] += by
    edges = np.concatenate([[0.0], np.cumsum(lengths)])
    windows = tuple(
        replace(w, centre=0.5 * (edges[2 * k + 1] + edges[2 * k + 2]), openF=lengths[2 * k + 1])
        for k, w in enumerate(actuator.windows)
    )
    return replace(actuator, length=float(edges[-1]), windows=windows)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("center", "rubber"),
    [
        ((270.0, 90.0), "mooney-rivlin"),
        ((250.0, 30.0), "mooney-rivlin"),
        ((270.0, 90.0), "yeoh"),
        ((270.0, 90.0), "ogden"),
    ],
)
def test_against_differences(center: tuple[float, float], rubber: str) -> None:
    actuator = replace(two(center), rubber=RUBBERS[rubber])
    run = solve(actuator, [PRESSURE], SIZE)
    found = sensitivities(run.mesh, run.states[-1].x, PRESSURE)

    def state(changed: Actuator, pressure: float = PRESSURE) -> State:
        # From the known state: the layers of its mesh follow the change as the rates assume.
        return solve_near(changed, run, pressure).states[-1]

    def check(rate: Rate, after: State, before: State, step: float) -> None:
        theta = (after.theta - before.theta) / (2.0 * step)
        line = (after.shape.facing - before.shape.facing) / (2.0 * step)
        places = (after.shape.z - before.shape.z) / (2.0 * step)
        volume = (after.volume - before.volume) / (2.0 * step)
        np.testing.assert_allclose(rate.theta, theta, rtol=1e-3, atol=1e-3 * np.abs(theta).max())
        np.testing.assert_allclose(rate.facing, line, atol=1e-3 * np.abs(line).max())
        np.testing.assert_allclose(rate.z, places, atol=1e-6)
        assert rate.volume == pytest.approx(volume, rel=1e-3)

    h = 1e-4
    check(found.pressure, state(actuator, PRESSURE + h), state(actuator, PRESSURE - h), h)
    changes: list[tuple[Rate, Callable[[float], Actuator]]] = [
        (found.alpha[1], lambda by: widened(actuator, 1, by)),
        (found.openF[0], lambda by: lengthened(actuator, 1, by)),
        (found.wrapped[1], lambda by: lengthened(actuator, 2, by)),
    ]
    for rate, change in changes:
        check(rate, state(change(1e-3)), state(change(-1e-3)), 1e-3)

    def walled(by: float) -> State:
        return solve(replace(actuator, wall=actuator.wall + by), [PRESSURE], SIZE).states[-1]

    check(found.wall, walled(1e-3), walled(-1e-3), 1e-3)
    assert found.wall.theta[0] < 0.0  # a thicker wall, less angle

    def stiffened(by: float) -> State:
        gauze = replace(actuator.gauze, stiffness=(1.0 + by) * actuator.gauze.stiffness)
        return solve(replace(actuator, gauze=gauze), [PRESSURE], SIZE).states[-1]

    check(found.gauze, stiffened(0.01), stiffened(-0.01), 0.01)


def test_stiffer_rubber_is_less_pressure_and_a_softer_gauze() -> None:
    actuator = two((270.0, 90.0))
    run = solve(actuator, [PRESSURE], SIZE)
    rate = sensitivities(run.mesh, run.states[-1].x, PRESSURE).rubber(PRESSURE)

    def with_rubber(by: float) -> State:
        law = actuator.rubber
        scaled = MooneyRivlin(*((1.0 + by) * c for c in (law.C10, law.C01, law.K)))
        return solve(replace(actuator, rubber=scaled), [PRESSURE], SIZE).states[-1]

    after, before = with_rubber(0.01), with_rubber(-0.01)
    theta = (after.theta - before.theta) / 0.02
    np.testing.assert_allclose(rate.theta, theta, rtol=2e-3)
    assert rate.theta[0] < 0.0


def test_rates_by_rubber_constants_and_alpha_center() -> None:
    actuator = two((250.0, 30.0))
    run = solve(actuator, [PRESSURE], SIZE)
    wanted = [rubber_constant("C10"), rubber_constant("C01"), poisson(), alpha_center(1)]
    rates = rates_by(run.mesh, run.states[-1].x, PRESSURE, wanted)
    for parameter, rate, step in zip(wanted, rates, (1e-2, 1e-2, 1e-4, 1e-3), strict=True):
        after, before = (
            solve_near(parameter.change(actuator, by), run, PRESSURE).states[-1]
            for by in (step, -step)
        )
        line = (after.shape.facing - before.shape.facing) / (2.0 * step)
        np.testing.assert_allclose(rate.facing, line, atol=2e-3 * np.abs(line).max())
        volume = (after.volume - before.volume) / (2.0 * step)
        assert rate.volume == pytest.approx(volume, rel=2e-3)


def test_half_a_tube_cannot_turn_a_sector() -> None:
    run = solve(two((270.0, 90.0)), [PRESSURE], SIZE)
    assert run.mesh.half
    with pytest.raises(FemError, match="leave its plane"):
        rates_by(run.mesh, run.states[-1].x, PRESSURE, [alpha_center(0)])


def test_a_constant_that_is_no_number_is_refused() -> None:
    actuator = replace(two((270.0, 90.0)), rubber=RUBBERS["ogden"])
    with pytest.raises(ValueError, match="mu of ogden is not one number"):
        rubber_constant("mu").change(actuator, 0.1)


def test_signs() -> None:
    run = solve(two((270.0, 90.0)), [PRESSURE], SIZE)
    found: Sensitivities = sensitivities(run.mesh, run.states[-1].x, PRESSURE)
    toward, away = found.pressure.theta
    assert toward > 0.0 > away  # more pressure, more angle, each its own way
    assert found.alpha[0].theta[0] < 0.0  # more uncut gauze, less angle
    assert found.openF[0].theta[0] > 0.0  # a longer cut, more angle
    assert len(found.wrapped) == 3


def test_positions_off_equilibrium_are_refused() -> None:
    run = solve(two((270.0, 90.0)), [PRESSURE], SIZE)
    with pytest.raises(FemError, match="equilibrium"):
        sensitivities(run.mesh, run.states[-1].x, 1.1 * PRESSURE)


def test_a_window_of_its_own() -> None:
    w = Window(10.0, 4.0, 1.0)
    assert (w.start, w.end, w.away) == (8.0, 12.0, False)
