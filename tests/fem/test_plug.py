"""The closed end as one rigid body."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from fem.plug import Plug
from tests.fem.tubes import COARSE, mesh_of


@pytest.fixture(params=[270.0, 200.0], ids=["half", "whole"])
def center(request: pytest.FixtureRequest) -> float:
    return float(request.param)


def test_a_rigid_motion_is_found_back(center: float) -> None:
    mesh = mesh_of(center, COARSE)
    plug = Plug(mesh)
    # In the half model about x alone, which its plane allows.
    spin = [0.7, 0.0, 0.0] if mesh.half else [0.7, -0.4, 0.3]
    R = Rotation.from_rotvec(spin).as_matrix()
    middle = np.array([0.0, 3.0, 25.0])
    x = mesh.X.copy()
    x[-1, : mesh.ring] = (mesh.X[-1, : mesh.ring] - [0.0, 0.0, mesh.z[-1]]) @ R.T + middle
    found, turned = plug.pose(x)
    np.testing.assert_allclose(found, middle, atol=1e-9)
    np.testing.assert_allclose(turned, R, atol=1e-9)


def test_motions_are_offsets_and_spins(center: float) -> None:
    mesh = mesh_of(center, COARSE)
    T = Plug(mesh).motions(mesh.X)
    assert T.shape == (3 * mesh.ring, 3 if mesh.half else 6)
    ring = mesh.X[-1, : mesh.ring] - [0.0, 0.0, mesh.z[-1]]
    along_y, about_x = (T[:, 0 if mesh.half else 1], T[:, 2 if mesh.half else 3])
    np.testing.assert_allclose(along_y.reshape(-1, 3), np.tile([0.0, 1.0, 0.0], (mesh.ring, 1)))
    spun = np.cross([1.0, 0.0, 0.0], ring) / mesh.actuator.radius
    np.testing.assert_allclose(about_x.reshape(-1, 3), spun, atol=1e-9)


def test_the_caps_volume_is_the_cone_from_the_origin(center: float) -> None:
    mesh = mesh_of(center, COARSE)
    volume, slope = Plug(mesh).cap_volume(mesh.X)
    inner = mesh.actuator.radius - mesh.actuator.wall
    cone = np.pi * inner**2 * mesh.z[-1] / 3.0 * (0.5 if mesh.half else 1.0)
    assert volume == pytest.approx(cone, rel=0.02)  # the ring is a polygon of curved sides
    assert len(slope) == (3 if mesh.half else 6)
    along = slope[1 if mesh.half else 2]
    assert along == pytest.approx(volume / mesh.z[-1], rel=1e-9)
