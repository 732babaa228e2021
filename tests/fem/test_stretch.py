"""The stretch of the rubber: the same on any mesh, whatever the corners of a cut do."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from fem.actuator import chain
from fem.measure import _points, stretches
from fem.mesh import make_mesh
from fem.meshsize import DEFAULT_MESH, MeshSize
from fem.solver import solve
from tests.fem.tubes import mesh_of, tube

COARSE = MeshSize(around=3, beside=0.0, edge=0.8, window=2.0)


def test_a_uniform_stretch_is_read_as_it_is() -> None:
    for center in (270.0, 200.0):
        mesh = mesh_of(center)
        np.testing.assert_allclose(stretches(mesh, mesh.X), 1.0, atol=1e-12)
        np.testing.assert_allclose(stretches(mesh, mesh.X * [1.0, 1.0, 1.7]), 1.7, atol=1e-12)


@pytest.mark.parametrize("center", [270.0, 200.0])
def test_all_of_the_rubber_is_counted_once(center: float) -> None:
    mesh = mesh_of(center)
    _, volume = _points(mesh, mesh.X)
    ring = np.pi * (10.0**2 - 8.0**2)
    assert volume.sum() == pytest.approx(ring * tube().free_length, rel=3e-3)


def test_a_joint_reaches_to_the_middles_of_the_sectors_beside_it() -> None:
    """Rings pulled apart at one place: the joint whose side that is tells it, and no other."""
    actuator = chain(10.0, [20.0, 14.0], [6.0, 6.0], [np.radians(90.0)] * 2)
    mesh = make_mesh(actuator, MeshSize(around=3, beside=0.0, wrapped=2.0))
    for place, joint in ((8.0, 0), (17.0, 0), (23.0, 1), (33.0, 1)):
        x = mesh.X.copy()
        x[..., 2] += 1.5 * (mesh.X[..., 2] > place)
        read = stretches(mesh, x)
        assert read[joint] > 1.2
        assert read[1 - joint] == pytest.approx(1.0, abs=1e-6)


def test_a_corner_counts_by_its_size_alone() -> None:
    """One node moved at the edge of the cut, where bricks are 0.2 mm high."""
    mesh = mesh_of(270.0, DEFAULT_MESH)
    x = mesh.X.copy()
    edge = int(np.searchsorted(mesh.z, mesh.actuator.windows[0].start - 1e-6))
    x[edge, mesh.outer_ring[3], 2] -= 0.15
    lam, volume = _points(mesh, x)
    read = stretches(mesh, x)
    values, weights = lam.ravel(), volume.ravel()
    order = np.argsort(-values)
    counted = np.cumsum(weights[order]) <= 0.5 * 2.0**3
    mean = np.average(values[order][counted], weights=weights[order][counted])
    assert read[0] == pytest.approx(mean, rel=0.02)
    assert values.max() - 1.0 > 2.0 * (read[0] - 1.0) > 0.0


def halved(size: MeshSize) -> MeshSize:
    return replace(
        size, around=2 * size.around, beside=0.5 * size.beside, edge=0.5 * size.edge,
        window=0.5 * size.window, wrapped=0.5 * size.wrapped, end=0.5 * size.end,
    )  # fmt: skip


def test_half_of_a_coarse_mesh_reads_alike() -> None:
    actuator = chain(12.0, [14.0], [8.0], [np.radians(100.0)])
    coarse, fine = (
        solve(actuator, [0.1], size).states[-1].stretches for size in (COARSE, halved(COARSE))
    )
    assert coarse == pytest.approx(fine, rel=0.03)
    assert fine[0] > 1.5


@pytest.mark.slow
@pytest.mark.parametrize("alpha_deg", [84.0, 156.0])
def test_halving_the_mesh_changes_the_stretch_by_a_few_percent(alpha_deg: float) -> None:
    actuator = chain(30.0, [30.0], [10.0], [np.radians(alpha_deg)])
    usual, fine = (
        solve(actuator, [0.16], size).states[-1].stretches
        for size in (DEFAULT_MESH, halved(DEFAULT_MESH))
    )
    np.testing.assert_allclose(usual, fine, rtol=0.02)
