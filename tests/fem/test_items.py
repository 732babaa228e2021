"""A contribution to the energy that `fem` knows nothing of joins bricks, gauze and air."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from fem import blas
from fem.actuator import chain
from fem.assembly import System
from fem.element import face_nodes, gauss, natural_nodes, shape
from fem.items import Batch
from fem.mesh import Mesh
from fem.meshsize import MeshSize
from fem.near import solve_near
from fem.sensitivity import sensitivities
from fem.solver import solve
from tests.fem.test_tangent import CASES, SOFT, differences, factored, turning
from tests.fem.tubes import bent, mesh_of, shifted

FloatArray = NDArray[np.float64]

FOUNDATION = 0.02  # MPa/mm
PRESSURE = 0.08
SHORT = chain(8.0, [14.0], [6.0], [np.radians(100.0)])
SIZE = MeshSize(around=3, beside=0.0, edge=2.0, growth=2.0)


class Foundation:
    """Springs from every point of the outer surface to where it is at rest.

    Energy k/2 |x - X|^2 per area at rest: forces are the sum of k w N_a (x - X), the stiffness
    k w N_a N_b for each direction.
    """

    def __init__(self, mesh: Mesh) -> None:
        m = face_nodes(mesh.size.kind)
        points, w = gauss((3, 3))
        N, dN = shape(natural_nodes(mesh.size.kind)[-m:, 1:], points)
        first = np.arange(mesh.layers)[:, None, None] * (mesh.ring + mesh.mid)
        at_rest = mesh.X.reshape(-1, 3)[first + mesh.outer]
        along = np.einsum("qnd,lcni->lcqdi", dN, at_rest)
        area = np.linalg.norm(np.cross(along[..., 0, :], along[..., 1, :]), axis=-1)
        self.matrix = FOUNDATION * np.einsum("q,lcq,qa,qb->lcab", w, area, N, N)
        self.at_rest = at_rest

    def add(self, batch: Batch) -> None:
        layers = slice(batch.layers.start, batch.layers.stop)
        u = batch.x[batch.outer] - self.at_rest[layers]
        force = self.matrix[layers] @ u
        batch.sums.energy += 0.5 * float((force * u).sum())
        batch.add_forces(batch.outer, np.moveaxis(force, -1, 0))
        if batch.skin is not None:
            for pair in (0, 3, 5):  # xx, yy, zz
                batch.skin[pair] += np.moveaxis(self.matrix[layers], 0, 1)


@pytest.fixture
def _one_thread() -> Iterator[None]:
    with blas.one_thread():
        yield


@pytest.mark.usefixtures("_one_thread")
@pytest.mark.parametrize(("center", "size"), CASES)
def test_the_item_is_in_the_tangent(center: float, size: MeshSize) -> None:
    system = System(mesh_of(center, size, SOFT), 1, [Foundation])
    pose = bent(system, 6)
    inverse = factored(system, pose)
    values = np.random.default_rng(12).uniform(-1.0, 1.0, system.unknowns.count)
    slope = differences(system, pose, values, 1e-5)
    slope -= turning(system, pose, values, 0.15)
    np.testing.assert_allclose(inverse.solve(slope), values, rtol=0.0, atol=1e-6)
    # It changes the residual by far more than that.
    plain = System(mesh_of(center, size, SOFT), 1)
    without = differences(plain, pose, values, 1e-5)
    assert np.linalg.norm(without - slope) > 1e-4 * np.linalg.norm(slope)


@pytest.mark.usefixtures("_one_thread")
@pytest.mark.parametrize(("center", "size"), CASES)
def test_the_items_forces_are_the_gradient_of_the_energy(center: float, size: MeshSize) -> None:
    system = System(mesh_of(center, size), 1, [Foundation])
    pose, h = bent(system, 24), 1e-6
    internal = system.forces(pose.x).internal
    for way in np.random.default_rng(4).uniform(-1.0, 1.0, (3, len(internal))):
        high, low = (system.forces(shifted(system, pose, s * h * way)).energy for s in (1.0, -1.0))
        assert (high - low) / (2.0 * h) == pytest.approx(float(internal @ way), rel=1e-6)


def test_the_energy_balance_holds_with_the_item() -> None:
    free, held = (solve(SHORT, [PRESSURE], SIZE, extra=extra) for extra in ((), (Foundation,)))
    state = held.states[-1]
    assert state.residual <= 1e-6
    assert state.energy_error < 1e-3
    # The springs hold the tube back, and a fair part of the work is in them.
    assert 0.0 < state.theta[0] < 0.9 * free.states[-1].theta[0]
    bare = 2.0 * System(held.mesh, 1).forces(state.x).energy
    assert bare < 0.95 * state.energy


def test_one_thread_and_two_give_the_same_bits_with_the_item() -> None:
    a, b = (solve(SHORT, [PRESSURE], SIZE, threads=t, extra=[Foundation]) for t in (1, 2))
    np.testing.assert_array_equal(a.states[-1].x, b.states[-1].x)


def test_sensitivities_and_near_states_know_the_item() -> None:
    run = solve(SHORT, [PRESSURE], SIZE, extra=[Foundation])
    x, h = run.states[-1].x, 1e-4
    rates = sensitivities(run.mesh, x, PRESSURE, extra=[Foundation])
    after, before = (
        solve_near(SHORT, run, PRESSURE + s * h, extra=[Foundation]).states[-1] for s in (1.0, -1.0)
    )
    slope = (after.theta - before.theta) / (2.0 * h)
    np.testing.assert_allclose(rates.pressure.theta, slope, rtol=1e-3)
    # A longer cut: the springs' own places at rest move along with the mesh.
    cut, h = SHORT.windows[0], 1e-3
    after, before = (
        solve_near(
            replace(
                SHORT,
                length=SHORT.length + by,
                windows=(replace(cut, centre=cut.centre + 0.5 * by, openF=cut.openF + by),),
            ),
            run,
            PRESSURE,
            extra=[Foundation],
        ).states[-1]
        for by in (h, -h)
    )
    slope = (after.theta - before.theta) / (2.0 * h)
    np.testing.assert_allclose(rates.openF[0].theta, slope, rtol=2e-3)
