"""Newton's method, and the way downhill where it fails."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from fem import blas
from fem.actuator import Actuator, Window
from fem.assembly import System
from fem.loadpath import Options, Path
from fem.material import MooneyRivlin
from fem.newton import correct, descend, relative_residual
from fem.sections import Chart
from fem.solver import solve
from tests.fem.tubes import COARSE, bent, mesh_of, tube

PRESSURE = 0.08


def inverse_of(
    system: System, x: np.ndarray, pressure: float
) -> tuple[int, np.ndarray, np.ndarray]:
    """Negative eigenvalues, the inverse tangent, and the inverse turned positive."""
    _, inverse = system.factor(x, pressure)
    assert inverse is not None
    unit = np.eye(system.unknowns.count)
    return inverse.negative, inverse.solve(unit), inverse.solve(unit, positive=True)


def test_a_tangent_is_turned_positive_definite() -> None:
    system = System(mesh_of())
    # Far more pressure than the state stands.
    negative, plain, positive = inverse_of(system, bent(system, 1).x, 0.6)
    assert negative > 0
    np.testing.assert_allclose(positive, positive.T, atol=1e-9 * np.abs(positive).max())
    assert np.linalg.eigvalsh(positive).min() > 0.0
    # The tangent itself has as many negative eigenvalues as it says.
    assert (np.linalg.eigvalsh(plain) < 0.0).sum() == negative
    # Both are made of the same factors: K^-1 = A^T S A, and A^T A in its place.
    ratio = np.linalg.solve(positive, plain)
    np.testing.assert_allclose(ratio @ ratio, np.eye(len(ratio)), atol=1e-5)


def test_where_the_tangent_is_positive_nothing_changes() -> None:
    system = System(mesh_of())
    negative, plain, positive = inverse_of(system, Chart(system.mesh).taut(4e-4).x, 0.01)
    assert negative == 0
    assert np.array_equal(plain, positive)


def test_a_tangent_in_single_precision_is_the_same_one_but_for_its_digits() -> None:
    system = System(mesh_of(), single=True)
    x, rhs = Chart(system.mesh).taut(4e-4).x, np.ones(system.unknowns.count)
    forces, inverse = system.factor(x, 0.01)
    assert inverse is not None
    exact = inverse.solve(rhs)
    quick_forces, quick = system.factor(x, 0.01, double=False)
    assert quick is not None
    rough = quick.solve(rhs)
    assert rough.dtype == exact.dtype
    np.testing.assert_allclose(rough, exact, rtol=1e-3, atol=1e-3 * np.abs(exact).max())
    assert not np.array_equal(rough, exact)
    np.testing.assert_array_equal(quick_forces.internal, forces.internal)


def test_double_precision_counts_what_single_cannot() -> None:
    plain, system = System(mesh_of()), System(mesh_of(), single=True)
    x = bent(plain, 1).x
    negative, _, positive = inverse_of(plain, x, 0.6)
    _, inverse = system.factor(x, 0.6, double=False)
    assert inverse is not None
    assert inverse.negative == negative > 0
    unit = np.eye(plain.unknowns.count)
    assert np.array_equal(inverse.solve(unit, positive=True), positive)


def test_downhill_leads_to_the_same_state() -> None:
    run = solve(tube(), [PRESSURE], COARSE)
    system, chart = System(run.mesh), Chart(run.mesh)
    with blas.one_thread():
        start = bent(system, 2, amount=0.1)
        far = relative_residual(system.forces(start.x), PRESSURE)
        done = descend(system, chart, start, PRESSURE, 1e-9)
    assert far > 1.0
    assert done.outcome == "converged"
    assert done.negative == 0
    assert done.residual <= 1e-9
    np.testing.assert_allclose(done.pose.x, run.states[-1].x, atol=1e-5)


def test_downhill_the_energy_never_rises(monkeypatch: pytest.MonkeyPatch) -> None:
    system = System(mesh_of())
    chart = Chart(system.mesh)
    start = bent(system, 3, amount=0.2)
    energies = []
    factor = system.factor

    def counted(x: np.ndarray, pressure: float) -> object:
        found = factor(x, pressure)
        energies.append(found[0].energy - pressure * found[0].volume)
        return found

    monkeypatch.setattr(system, "factor", counted)
    descend(system, chart, start, PRESSURE, 1e-8)
    assert len(energies) > 4
    assert np.diff(energies).max() <= 1e-9 * abs(energies[0])


def test_the_balloon_has_no_bottom() -> None:
    system = System(mesh_of())
    done = descend(system, Chart(system.mesh), Chart(system.mesh).rest(), 5.0, 1e-6)
    assert done.outcome != "converged"


def test_a_state_that_jumps_is_not_taken_for_the_path(monkeypatch: pytest.MonkeyPatch) -> None:
    """Downhill may lead to another shape: what it sets free on the way tells."""
    system = System(mesh_of())
    chart = Chart(system.mesh)
    path = Path(system, chart, Options())
    states = list(path.follow([0.02, 0.04]))
    assert path._settle(0.0401, asked=True) is not None
    last = path._states[-1]
    # As if the last state held more energy than the one that it settles into can have left.
    lifted = replace(last.forces, energy=1.01 * last.forces.energy)
    monkeypatch.setattr(path, "_states", [*states, replace(last, forces=lifted)])
    assert path._settle(0.0402, asked=True) is None
    assert path.history[-1].outcome == "unstable"


def test_correct_says_what_it_used() -> None:
    system = System(mesh_of())
    chart = Chart(system.mesh)
    done = correct(system, chart, chart.taut(4e-4), 0.01, 1e-8)
    assert done.outcome == "converged"
    # dV/dp by the last tangent: the tube grows with the pressure.
    assert done.forces.volume_gradient @ done.flow > 0.0


@pytest.mark.slow
def test_threads_that_switch_near_a_loss_of_stability() -> None:
    """Number 49 of the random actuators: Newton's method alone stalls at 1.45 bar."""
    windows = ((4.597, 4.283, 135.2, 270), (14.920, 9.284, 175.2, 270), (25.000, 3.140, 149.8, 90),
               (31.383, 6.101, 100.9, 90), (38.310, 4.388, 167.7, 90))  # fmt: skip
    actuator = Actuator(
        47.055,
        tuple(Window(c, o, np.radians(a), np.radians(s)) for c, o, a, s in windows),
        diameter=12.933,
        wall=1.5777,
        rubber=MooneyRivlin(0.057426, 0.051965, 2.66186),
    )
    run = solve(actuator, [0.08, 0.165])
    assert run.converged
    # Newton's method gives up after ten factorisations: more are the way downhill.
    assert any(attempt.factorisations > 10 for attempt in run.history)
    assert run.states[-1].residual <= 1e-6
    assert run.states[-1].energy_error < 1e-3
