"""Row 3: the tangent of rubber, threads, pressure and plug together; its factorisation."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from fem import blas
from fem.actuator import Actuator, Window
from fem.assembly import Inverse, System
from fem.gauze import Gauze
from fem.mesh import make_mesh
from fem.meshsize import MeshSize
from fem.pivot import Pivot
from fem.sections import Chart, Pose
from tests.fem.tubes import COARSE, COARSE8, bent, mesh_of, shifted

FloatArray = NDArray[np.float64]

PRESSURE = 0.15
# The force sets in over a wide stretch, so that many points are on the curved part of the law.
SOFT = Gauze(transition=0.05)

CASES = [
    pytest.param(270.0, COARSE, id="half"),
    pytest.param(200.0, COARSE, id="whole"),
    pytest.param(270.0, COARSE8, id="half-hex8"),
    pytest.param(200.0, COARSE8, id="whole-hex8"),
]


@pytest.fixture(autouse=True)
def _one_thread() -> Iterator[None]:
    with blas.one_thread():
        yield


def factored(system: System, pose: Pose, pressure: float = PRESSURE) -> Inverse:
    _, inverse = system.factor(pose.x, pressure)
    assert inverse is not None
    return inverse


def differences(
    system: System, pose: Pose, values: FloatArray, h: float, pressure: float = PRESSURE
) -> FloatArray:
    """Central differences of the residual along the unknowns ``values``."""
    ends = [
        system.forces(shifted(system, pose, s * h * values)).residual(pressure) for s in (1.0, -1.0)
    ]
    return (ends[0] - ends[1]) / (2.0 * h)


def turning(system: System, pose: Pose, values: FloatArray, pressure: float) -> FloatArray:
    """What differences of a moment have beyond the Hessian where the moment is not zero.

    Spins do not commute: half of the moment turned along with the spin. A half model has one
    axis to spin about, and no such term.
    """
    extra = np.zeros_like(values)
    if not system.mesh.half:
        moment = system.forces(pose.x).residual(pressure)[-3:]
        extra[-3:] = 0.5 * np.cross(values[-3:], moment) / system.mesh.actuator.radius
    return extra


@pytest.mark.parametrize(("center", "size"), CASES)
def test_tangent_is_the_derivative_of_the_residual(center: float, size: MeshSize) -> None:
    system = System(mesh_of(center, size, SOFT), 1)
    pose = bent(system, 5)
    inverse = factored(system, pose)
    rng = np.random.default_rng(11)
    rhs = rng.normal(size=system.unknowns.count)
    values = inverse.solve(rhs)
    scale = 1.0 / np.abs(values).max()  # steps are then in mm
    rhs, values = scale * rhs, scale * values
    expected = rhs + turning(system, pose, values, PRESSURE)
    errors = [
        float(np.linalg.norm(differences(system, pose, values, h) - expected))
        / float(np.linalg.norm(rhs))
        for h in (1e-2, 1e-3, 1e-4, 1e-5, 1e-8, 1e-10)
    ]
    assert min(errors) < 1e-6
    # A V: truncation falls with h^2, rounding rises with 1/h.
    assert errors[1] < 0.1 * errors[0]
    assert errors[2] < 0.05 * errors[1]
    assert errors[5] > 10.0 * min(errors)


@pytest.mark.parametrize(("center", "size"), CASES)
def test_tangent_in_stiff_directions(center: float, size: MeshSize) -> None:
    # The solved directions above are soft ones. Here every unknown moves.
    system = System(mesh_of(center, size, SOFT), 1)
    pose = bent(system, 6)
    inverse = factored(system, pose)
    values = np.random.default_rng(12).uniform(-1.0, 1.0, system.unknowns.count)
    slope = differences(system, pose, values, 1e-5)
    slope -= turning(system, pose, values, PRESSURE)
    np.testing.assert_allclose(inverse.solve(slope), values, rtol=0.0, atol=1e-6)


@pytest.mark.parametrize(("center", "size"), CASES)
def test_tangent_of_a_stable_state(center: float, size: MeshSize) -> None:
    # The random states above are unstable and go through eigenvalues; this is Cholesky's way.
    system = System(mesh_of(center, size, SOFT), 1)
    chart, rng = Chart(system.mesh), np.random.default_rng(15)
    rest = chart.rest()
    values = 0.02 * rng.uniform(-1.0, 1.0, system.unknowns.count)
    pose = chart.move(rest, chart.increment(rest, system.expand(rest.x, values)))
    inverse = factored(system, pose, 0.02)
    assert inverse.negative == 0
    way = rng.uniform(-1.0, 1.0, system.unknowns.count)
    slope = differences(system, pose, way, 1e-5, 0.02) - turning(system, pose, way, 0.02)
    np.testing.assert_allclose(inverse.solve(slope), way, rtol=0.0, atol=1e-6)


def test_every_part_counts() -> None:
    # The checks above mean something only if pressure and threads change the tangent by far more
    # than the 1e-6 that they ask for.
    system = System(mesh_of(270.0, COARSE, SOFT), 1)
    pose = bent(system, 5)
    values = np.random.default_rng(12).uniform(-1.0, 1.0, system.unknowns.count)
    slope = differences(system, pose, values, 1e-5)
    unloaded = differences(system, pose, values, 1e-5, pressure=0.0)
    bare = System(mesh_of(270.0, COARSE, replace(SOFT, stiffness=1e-9)), 1)
    unbound = differences(bare, pose, values, 1e-5)
    for other in (unloaded, unbound):
        assert np.linalg.norm(other - slope) > 1e-4 * np.linalg.norm(slope)


@pytest.mark.parametrize(("center", "size"), CASES)
def test_inverse_is_symmetric(center: float, size: MeshSize) -> None:
    system = System(mesh_of(center, size), 1)
    inverse = factored(system, bent(system, 7))
    a, b = np.random.default_rng(13).normal(size=(2, system.unknowns.count))
    assert a @ inverse.solve(b) == pytest.approx(b @ inverse.solve(a), rel=1e-9)


def dense(system: System, pose: Pose, pressure: float) -> FloatArray:
    """The tangent by differences, column by column."""
    count = system.unknowns.count
    columns = []
    for unit in np.eye(count):
        column = differences(system, pose, unit, 1e-5, pressure)
        columns.append(column - turning(system, pose, unit, pressure))
    K = np.array(columns).T
    np.testing.assert_allclose(K, K.T, rtol=0.0, atol=1e-5 * np.abs(K).max())
    return 0.5 * (K + K.T)


TINY = MeshSize(around=2, beside=0.0, growth=2.0, edge=4.0, window=4.0, wrapped=8.0, end=8.0)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("center", "pressure", "amount"),
    [(270.0, 0.0, None), (270.0, 0.0, 0.1), (270.0, 3.0, 0.1), (200.0, 0.8, 0.1)],
)
def test_indefinite_tangents_are_solved_and_counted(
    center: float, pressure: float, amount: float | None
) -> None:
    window = Window(5.0, 3.0, np.radians(90.0), np.radians(center))
    system = System(make_mesh(Actuator(10.0, (window,), gauze=Gauze(slack=1.0)), TINY), 1)
    pose = Chart(system.mesh).rest() if amount is None else bent(system, 8, amount)
    inverse = factored(system, pose, pressure)
    K = dense(system, pose, pressure)
    E = np.linalg.eigvalsh(K)
    assert np.abs(E).min() > 1e-4  # no sign is in doubt
    assert inverse.negative == (E < 0.0).sum()
    assert (inverse.negative == 0) == (amount is None)  # only the tube at rest is stable
    rhs = np.random.default_rng(14).normal(size=(2, len(E)))
    np.testing.assert_allclose(inverse.solve(rhs) @ K, rhs, rtol=0.0, atol=1e-5)


def test_one_thread_and_two_give_the_same_bits() -> None:
    mesh = mesh_of(200.0)
    found = []
    for threads in (1, 2):
        system = System(mesh, threads)
        try:
            pose = bent(system, 9)
            forces, inverse = system.factor(pose.x, PRESSURE)
            assert inverse is not None
            found.append((forces.internal, forces.volume_gradient, forces.energy, forces.volume))
            found[-1] += (inverse.solve(forces.residual(PRESSURE)),)
        finally:
            system.close()
    for one, two in zip(*found, strict=True):
        assert np.array_equal(one, two)


def test_an_old_inverse_is_refused() -> None:
    system = System(mesh_of(), 1)
    pose = Chart(system.mesh).rest()
    old = factored(system, pose)
    factored(system, pose)
    with pytest.raises(RuntimeError, match="factored anew"):
        old.solve(np.zeros(system.unknowns.count))


def test_a_brick_inside_out_is_told() -> None:
    system = System(mesh_of(), 1)
    x = system.mesh.X * [1.0, 1.0, -1.0]
    forces, inverse = system.factor(x, PRESSURE)
    assert inverse is None
    assert not forces.least_J > 0.0
    assert np.isnan(forces.internal).all()


def test_newtons_tail_is_quadratic() -> None:
    # Bars for threads, and weak ones: the law is then smooth and the rubber carries the load.
    system = System(mesh_of(270.0, COARSE, Gauze(stiffness=0.1, slack=1.0)), 1)
    chart = Chart(system.mesh)
    pose, pressure, residuals = chart.rest(), 0.02, []
    for _ in range(8):
        forces, inverse = system.factor(pose.x, pressure)
        assert inverse is not None
        push = pressure * np.linalg.norm(forces.volume_gradient)
        residuals.append(float(np.linalg.norm(forces.residual(pressure)) / push))
        if residuals[-1] < 1e-11:
            break
        du = inverse.solve(-forces.residual(pressure))
        pose = chart.move(pose, chart.increment(pose, system.expand(pose.x, du)))
    e = np.log([r for r in residuals if 1e-12 < r < 1e-1])
    orders = np.diff(e)[1:] / np.diff(e)[:-1]
    assert len(orders) >= 1
    assert orders[-1] > 1.8


def symmetric(n: int, negative: int, seed: int) -> FloatArray:
    rng = np.random.default_rng(seed)
    Q, _ = np.linalg.qr(rng.normal(size=(n, n)))
    E = np.where(np.arange(n) < negative, -1.0, 1.0) * rng.uniform(0.5, 2.0, n)
    A: FloatArray = (Q * E) @ Q.T
    return A


@pytest.mark.parametrize("negative", [0, 1, 3])
def test_pivot(negative: int) -> None:
    A, last = symmetric(7, negative, 1), np.zeros((3, 3))
    last[0, 1] = 7.0  # goes to the last rows; only upper triangles are read
    A_given = np.triu(A) + np.tril(np.full((7, 7), np.nan), -1)
    A_given[4, 5] -= 7.0
    pivot = Pivot(7)
    pivot.factorise(np.where(np.isnan(A_given), 99.0, A_given), last)
    assert pivot.negative == negative
    rows = np.random.default_rng(2).normal(size=(2, 7))
    solved = rows.copy()
    pivot.forward(solved)
    pivot.backward(solved)
    np.testing.assert_allclose(solved @ A, rows, atol=1e-12)
    # The Schur complement B^T A^-1 B.
    B = np.random.default_rng(3).normal(size=(7, 4))
    reduced, C = B.copy(), np.zeros((4, 4))
    pivot.reduce(reduced)
    pivot.update(C, reduced)
    np.testing.assert_allclose(np.triu(C), -np.triu(B.T @ np.linalg.solve(A, B)), atol=1e-12)


def test_a_pivot_is_used_again_after_an_indefinite_matrix() -> None:
    pivot = Pivot(5)
    pivot.factorise(symmetric(5, 2, 4), np.zeros((0, 0)))
    pivot.factorise(symmetric(5, 0, 5), np.zeros((0, 0)))
    assert pivot.negative == 0
    rows = np.ones((1, 5))
    pivot.forward(rows)
    pivot.backward(rows)
    np.testing.assert_allclose(rows @ symmetric(5, 0, 5), np.ones((1, 5)), atol=1e-12)
