"""The files for ParaView, read back by meshio: other eyes than ours."""

from __future__ import annotations

import tempfile
import xml.etree.ElementTree as ET
from pathlib import Path

import meshio
import numpy as np
import pytest

from fem.actuator import Actuator, Window
from fem.export.vtu import write_pvd, write_vtu
from fem.mesh import Mesh, MeshSize, make_mesh

LENGTH, R, WALL = 24.0, 10.0, 2.0
COARSE8 = MeshSize(kind="hex8", through=2, orders=(2, 2, 2))
# VTK's quadratic hexahedron: corners at the ends of the edge that each mid-side node is on.
EDGES = [
    (0, 1),
    (1, 2),
    (2, 3),
    (3, 0),
    (4, 5),
    (5, 6),
    (6, 7),
    (7, 4),
    (0, 4),
    (1, 5),
    (2, 6),
    (3, 7),
]


def tube(center_deg: float = 270.0) -> Actuator:
    window = Window(12.0, 8.0, np.radians(120.0), np.radians(center_deg))
    return Actuator(LENGTH, (window,), diameter=2.0 * R, wall=WALL)


def bent(mesh: Mesh) -> np.ndarray:
    """Some displacement that is symmetric to the bending plane, and swells by 1 % of r."""
    x = mesh.X.copy()
    x[..., :2] *= 1.01
    x[..., 1] -= 0.02 * mesh.X[..., 2] ** 2
    return x


def read(mesh: Mesh, x: np.ndarray) -> meshio.Mesh:
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "a.vtu"
        file.write_bytes(write_vtu(mesh, x))
        return meshio.read(file)


@pytest.fixture(params=["half", "whole", "out of plane", "hex8"])
def mesh(request: pytest.FixtureRequest) -> Mesh:
    size = COARSE8 if request.param == "hex8" else MeshSize()
    center = 200.0 if request.param == "out of plane" else 270.0
    made = make_mesh(tube(center), size, whole=request.param == "whole")
    assert made.half == (request.param in ("half", "hex8"))
    return made


def test_the_whole_tube_is_there(mesh: Mesh) -> None:
    found = read(mesh, bent(mesh))
    (block,) = found.cells
    assert block.type == {"hex20": "hexahedron20", "hex8": "hexahedron"}[mesh.size.kind]
    assert len(block.data) == mesh.elements * (2 if mesh.half else 1)
    assert len(np.unique(np.round(found.points, 4), axis=0)) == len(found.points)
    assert set(block.data.ravel()) == set(range(len(found.points)))
    x, y, z = found.points.T
    r = np.hypot(x, y)
    assert (r.min(), r.max()) == pytest.approx((R - WALL, R), abs=1e-5)
    assert (z.min(), z.max()) == pytest.approx((0.0, LENGTH - 1.0), abs=1e-5)
    for phi in (0.0, 0.5, 1.0, 1.5):  # it goes all around
        assert np.min(np.hypot(x - R * np.cos(phi * np.pi), y - R * np.sin(phi * np.pi))) < 3.0


def test_nodes_are_in_vtks_order(mesh: Mesh) -> None:
    found = read(mesh, bent(mesh))
    corners = found.points[found.cells[0].data]
    a, b, c = (corners[:, k] - corners[:, 0] for k in (1, 3, 4))
    volume = np.einsum("ij,ij->i", np.cross(a, b), c)
    assert volume.min() > 0.0  # mirrored bricks too
    # A brick is flatter than its arc: its parallelepiped is somewhat off the wall's volume.
    assert volume.sum() == pytest.approx(np.pi * (R**2 - (R - WALL) ** 2) * 23.0, rel=0.25)
    if mesh.size.kind == "hex20":
        for k, (i, j) in enumerate(EDGES, start=8):
            off = corners[:, k] - 0.5 * (corners[:, i] + corners[:, j])
            sagitta = R * (1.0 - np.cos(0.5 * np.diff(mesh.columns).max()))
            assert np.linalg.norm(off, axis=1).max() < sagitta + 1e-4


def test_displacement_takes_points_to_where_they_are(mesh: Mesh) -> None:
    found = read(mesh, bent(mesh))
    X, u = found.points, found.point_data["displacement"]
    assert u.shape == X.shape
    wanted = 0.01 * X * [1, 1, 0]
    wanted[:, 1] -= 0.02 * X[:, 2] ** 2
    np.testing.assert_allclose(u, wanted, atol=1e-4)
    swelling = found.point_data["swelling"]
    np.testing.assert_allclose(swelling, 0.01 * np.hypot(X[:, 0], X[:, 1]), atol=1e-4)


def test_cells_know_their_joint(mesh: Mesh) -> None:
    found = read(mesh, mesh.X)
    middle = found.points[found.cells[0].data].mean(axis=1)[:, 2]
    assert np.array_equal(found.cell_data["joint"][0], (np.abs(middle - 12.0) < 4.0).astype(int))


def test_a_series_names_pressures_and_files() -> None:
    tree = ET.fromstring(write_pvd([(0.0, "a_00.vtu"), (1.9, "a_01.vtu")]))
    sets = [(float(d.get("timestep")), d.get("file")) for d in tree.iter("DataSet")]
    assert sets == [(0.0, "a_00.vtu"), (1.9, "a_01.vtu")]
