"""Runs that are taken further, against the path from rest."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from fem import onward
from fem.actuator import chain
from fem.errors import NotConverged
from fem.loadpath import Options
from fem.mesh import make_mesh
from fem.meshsize import DEFAULT_MESH
from fem.newton import Correction, correct
from fem.onward import solve_onward
from fem.sections import Chart, rotation_matrix
from fem.solution import Solution
from fem.solver import solve

PRESSURE = 0.12
SIZE = replace(DEFAULT_MESH, edge=1.0)
ACTUATOR = chain(
    10.0, [16.0, 12.0], [8.0, 6.0], np.radians([110.0, 130.0]), np.radians([270.0, 90.0])
)  # fmt: skip


@pytest.fixture(scope="module")
def path() -> Solution:
    """From rest to a tenth above the pressure."""
    return solve(ACTUATOR, [share * PRESSURE for share in (0.8, 0.9, 1.0, 1.1)], SIZE)


@pytest.fixture(scope="module")
def known(path: Solution) -> Solution:
    return replace(path, states=path.states[:-1])


def test_ends_where_the_path_from_rest_ends(path: Solution, known: Solution) -> None:
    further = solve_onward(known, 1.1 * PRESSURE)
    assert further.states[:-1] == known.states
    found, expected = further.states[-1], path.states[-1]
    assert found.pressure == pytest.approx(expected.pressure)
    np.testing.assert_allclose(found.theta, expected.theta, atol=2e-5)
    np.testing.assert_allclose(found.x, expected.x, atol=1e-3)
    assert found.energy == pytest.approx(expected.energy, rel=1e-6)


def test_one_factorisation_is_enough_for_a_hundredth_of_a_degree(
    path: Solution, known: Solution
) -> None:
    further = solve_onward(known, 1.1 * PRESSURE, Options(tolerance=3e-3))
    assert further.factorisations == known.factorisations + 1
    off = np.degrees(further.states[-1].theta - path.states[-1].theta)
    assert 0.0 < np.abs(off).max() < 0.01


def test_a_step_that_fails_is_halved(known: Solution, monkeypatch: pytest.MonkeyPatch) -> None:
    """As if nothing converged from beyond a twentieth."""
    longest = 0.0601 * PRESSURE
    reached = [known.states[-1].pressure]

    def hard(*arguments: object) -> Correction:
        done = correct(*arguments)  # type: ignore[arg-type]
        if done.pressure - reached[-1] > longest:
            return replace(done, outcome="residual")
        reached.append(done.pressure)
        return done

    monkeypatch.setattr(onward, "correct", hard)
    further = solve_onward(known, 1.1 * PRESSURE)
    pressures = [state.pressure / PRESSURE for state in further.states[len(known.states) :]]
    assert pressures == pytest.approx([1.05, 1.1])


def test_as_far_as_it_goes(known: Solution, monkeypatch: pytest.MonkeyPatch) -> None:
    """As if all beyond a twentieth were unstable."""

    def unstable(*arguments: object) -> Correction:
        done = correct(*arguments)  # type: ignore[arg-type]
        if done.pressure > 1.051 * PRESSURE:
            return replace(done, inverse=cast(Any, SimpleNamespace(negative=1)))
        return done

    monkeypatch.setattr(onward, "correct", unstable)
    with pytest.raises(NotConverged) as caught:
        solve_onward(known, 1.1 * PRESSURE)
    found = caught.value.solution
    assert isinstance(found, Solution)
    assert not found.converged
    assert caught.value.reached == pytest.approx(1.05 * PRESSURE)
    assert [attempt.outcome for attempt in caught.value.history[-3:]] == [
        "converged", "unstable", "unstable",
    ]  # fmt: skip
    assert found.states[-1].pressure == pytest.approx(1.05 * PRESSURE)


def test_only_upward(known: Solution) -> None:
    with pytest.raises(ValueError, match="already"):
        solve_onward(known, PRESSURE)


@pytest.mark.parametrize("whole", [False, True])
def test_poses_turned_from_rest(whole: bool) -> None:
    """A tube at rest, turned about x by a finite angle and moved: the rotation is found again."""
    mesh = make_mesh(ACTUATOR, SIZE, whole)
    chart = Chart(mesh)
    spin = np.array([1.9, 0.0, 0.0]) if not whole else np.array([0.8, -1.1, 0.6])
    R = rotation_matrix(spin)
    x = mesh.X @ R.T + [0.0, 3.0, -2.0]
    pose = chart.fitted(x)
    np.testing.assert_allclose(pose.rotation, np.broadcast_to(R, pose.rotation.shape), atol=1e-12)
    np.testing.assert_allclose(pose.shape, chart.rest().shape, atol=1e-12)
    there = chart.move(chart.rest(), chart.difference(chart.rest(), pose))
    np.testing.assert_allclose(there.rotation, pose.rotation, atol=1e-12)
    np.testing.assert_allclose(there.offset, pose.offset, atol=1e-9)
