"""The chart of sections: rotations, finite moves, and their inverses."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.linalg import expm

from fem.meshsize import MeshSize
from fem.pressure import skew
from fem.sections import Chart, Pose, rotation_matrix, rotation_vector
from tests.fem.tubes import COARSE, COARSE8, mesh_of

spins = st.tuples(*[st.floats(-1.7, 1.7)] * 3)

MESHES = [
    pytest.param(270.0, COARSE, id="half"),
    pytest.param(200.0, COARSE, id="whole"),
    pytest.param(270.0, COARSE8, id="half-hex8"),
    pytest.param(200.0, COARSE8, id="whole-hex8"),
]


@given(spins)
def test_rotation_matrix_is_the_exponential(spin: tuple[float, float, float]) -> None:
    R = rotation_matrix(np.array(spin))
    np.testing.assert_allclose(R, expm(skew(np.array(spin))), atol=1e-13)
    np.testing.assert_allclose(R @ R.T, np.eye(3), atol=1e-14)


@given(spins)
def test_rotation_vector_is_its_inverse(spin: tuple[float, float, float]) -> None:
    v = np.array(spin)  # at most 2.95 rad
    np.testing.assert_allclose(rotation_vector(rotation_matrix(v)), v, atol=1e-11)


def test_rotations_of_a_quarter_turn_and_of_nothing() -> None:
    quarter = rotation_matrix(np.array([0.0, 0.0, 0.5 * np.pi]))
    np.testing.assert_allclose(quarter @ [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], atol=1e-15)
    np.testing.assert_array_equal(rotation_matrix(np.zeros(3)), np.eye(3))
    np.testing.assert_array_equal(rotation_vector(np.eye(3)), 0.0)
    tiny = np.array([[3e-13, 0.0, 0.0], [0.0, 2e-8, 0.0]])
    np.testing.assert_allclose(rotation_vector(rotation_matrix(tiny)), tiny, rtol=1e-6)


def some(chart: Chart, seed: int, half: bool, change: float = 0.1) -> Pose:
    """A pose far from rest: the tube bent, its offsets and shapes changed at random."""
    rng = np.random.default_rng(seed)
    rest = chart.rest()
    S = len(rest.centre)
    spin = np.zeros((S, 3))
    spin[:, 0] = -np.linspace(0.0, 1.2, S) + rng.uniform(-0.1, 0.1, S)
    if not half:
        spin += rng.uniform(-0.1, 0.1, (S, 3))
    offset = rng.uniform(-0.1, 0.1, (S - 1, 3))
    shape = change * rng.uniform(-1.0, 1.0, rest.shape.shape)
    return chart.move(rest, np.concatenate([spin.ravel(), offset.ravel(), shape.ravel()]))


@pytest.mark.parametrize(("center", "size"), MESHES)
def test_rest_is_the_mesh(center: float, size: MeshSize) -> None:
    mesh = mesh_of(center, size)
    chart = Chart(mesh)
    rest = chart.rest()
    np.testing.assert_array_equal(rest.x, mesh.X)
    still = chart.move(rest, chart.difference(rest, rest))
    np.testing.assert_allclose(still.x, mesh.X, atol=1e-14)
    assert (np.diff(chart.z) > 0.0).all()


@pytest.mark.parametrize(("center", "size"), MESHES)
def test_move_and_difference_are_inverse(center: float, size: MeshSize) -> None:
    mesh = mesh_of(center, size)
    chart = Chart(mesh)
    a, b = some(chart, 1, mesh.half), some(chart, 2, mesh.half)
    step = chart.difference(a, b)
    assert np.abs(step).max() > 0.1
    there = chart.move(a, step)
    np.testing.assert_allclose(there.x, b.x, atol=1e-11)
    np.testing.assert_allclose(there.rotation, b.rotation, atol=1e-12)
    np.testing.assert_allclose(chart.difference(a, there), step, atol=1e-11)


@pytest.mark.parametrize(("center", "size"), MESHES)
def test_move_follows_the_nodes_to_first_order(center: float, size: MeshSize) -> None:
    mesh = mesh_of(center, size)
    chart = Chart(mesh)
    pose = some(chart, 3, mesh.half)
    # The clamped ring stays, as it does in a System: the chart's first centre is no unknown.
    du = np.random.default_rng(4).uniform(-1.0, 1.0, pose.x.shape)
    du[0, : mesh.ring] = 0.0
    du[-1, mesh.ring :] = 0.0
    if mesh.half:
        du[:, : mesh.ring][:, mesh.fixed_ring[:, 0], 0] = 0.0
        du[:, mesh.ring :][:, mesh.fixed_mid[:, 0], 0] = 0.0
    increment = chart.increment(pose, du)
    errors = [
        np.abs((chart.move(pose, h * increment).x - pose.x) / h - du).max()
        for h in (1e-2, 1e-3, 1e-4)
    ]
    assert errors[0] < 0.5
    np.testing.assert_allclose(errors[1:], [0.1 * errors[0], 0.01 * errors[0]], rtol=0.2)


@pytest.mark.parametrize(("center", "size"), MESHES)
def test_a_rigid_turn_is_all_spin(center: float, size: MeshSize) -> None:
    mesh = mesh_of(center, size)
    chart = Chart(mesh)
    # Sections are round here, as their centres are then the means of their nodes.
    pose = some(chart, 5, mesh.half, change=0.0)
    w = np.array([0.3, 0.0, 0.0]) if mesh.half else np.array([0.3, -0.2, 0.5])
    du = np.cross(w, pose.x)
    if mesh.mid:
        du[-1, mesh.ring :] = 0.0
    increment = chart.increment(pose, du)
    np.testing.assert_allclose(chart.spins(increment), np.tile(w, (len(chart.z), 1)), atol=1e-9)
    assert np.abs(increment[3 * len(chart.z) :]).max() < 1e-9
    # And then the move is exact at any angle.
    turned = chart.move(pose, increment)
    expected = (pose.x - pose.centre[0]) @ rotation_matrix(w).T + pose.centre[0]
    np.testing.assert_allclose(turned.x[:-1], expected[:-1], atol=1e-9)
