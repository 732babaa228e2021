"""Row 9: the pressure on the closed surface of wall, root and plug."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from fem.assembly import System
from fem.meshsize import MeshSize
from fem.pressure import Cap, face_volumes, skew
from fem.sections import Chart, best_rotation, rotation_matrix
from tests.fem.general import IntArray, enclosed, grid
from tests.fem.tubes import COARSE, COARSE8, bent, mesh_of, shifted

FloatArray = NDArray[np.float64]

MESHES = [
    pytest.param(270.0, COARSE, id="half"),
    pytest.param(200.0, COARSE, id="whole"),
    pytest.param(270.0, COARSE8, id="half-hex8"),
    pytest.param(200.0, COARSE8, id="whole-hex8"),
]


def wall(system: System) -> IntArray:
    """Inner faces of all layers, by nodes in one list."""
    mesh = system.mesh
    first = np.arange(mesh.layers)[:, None, None] * (mesh.ring + mesh.mid)
    faces: IntArray = (first + mesh.inner).reshape(-1, mesh.inner.shape[1])
    return faces


def area(system: System) -> float:
    """Of the section inside the wall as the faces enclose it, by quadrature of x dy - y dx."""
    mesh = system.mesh
    cone = enclosed(mesh.X.reshape(-1, 3), wall(system), False)[0]
    return 1.5 * cone / float(mesh.z[-1])  # a cylinder's wall sees 2/3 of it from the axis


@pytest.mark.parametrize("size", [COARSE, COARSE8])
def test_no_net_force_on_the_closed_surface(size: MeshSize) -> None:
    system = System(mesh_of(200.0, size), 1)
    pose = bent(system, 21)
    centre, R = system.plug.pose(pose.x)
    gradient = enclosed(pose.x.reshape(-1, 3), wall(system), False)[1]
    plug, root = Cap(area(system)), Cap(area(system))
    on_plug = plug.volume(centre, R[:, 2])[1]
    on_root = root.volume(np.zeros(3), np.array([0.0, 0.0, -1.0]))[1]
    assert np.abs(on_plug).max() > 10.0
    np.testing.assert_allclose(gradient.sum(axis=0) + on_plug + on_root, 0.0, atol=1e-10)


def test_no_net_force_or_moment_on_a_closed_box() -> None:
    rng = np.random.default_rng(1)
    mesh = grid("hex20", (1, 1, 1), lambda u: 3.0 * u + rng.uniform(-0.2, 0.2, u.shape) + 9.0)
    total = np.zeros_like(mesh.X)
    for axis, end in np.ndindex(3, 2):
        total += (2 * end - 1) * enclosed(mesh.X, mesh.faces(axis, end), False)[1]
    assert np.abs(total).max() > 0.5
    np.testing.assert_allclose(total.sum(axis=0), 0.0, atol=1e-12)
    np.testing.assert_allclose(np.cross(mesh.X, total).sum(axis=0), 0.0, atol=1e-11)


@pytest.mark.parametrize(("center", "size"), MESHES)
def test_hessian_is_symmetric_and_the_derivative_of_the_forces(
    center: float, size: MeshSize
) -> None:
    system = System(mesh_of(center, size), 1)
    x, faces = bent(system, 22).x.reshape(-1, 3), wall(system)
    K = enclosed(x, faces, True)[2]
    assert K is not None
    assert abs(K).max() > 0.1
    assert abs(K - K.T).max() < 1e-12 * abs(K).max()
    way = np.random.default_rng(2).normal(size=x.shape)
    high, low = (enclosed(x + s * way, faces, False)[1] for s in (1.0, -1.0))
    # The volume is cubic in the nodes: central differences are exact at any length.
    slope = 0.5 * (high - low).ravel()
    np.testing.assert_allclose(K @ way.ravel(), slope, atol=1e-10 * np.abs(slope).max())


@pytest.mark.parametrize(("center", "size"), MESHES)
def test_forces_are_the_gradient_of_the_volume(center: float, size: MeshSize) -> None:
    system = System(mesh_of(center, size), 1)
    pose, h = bent(system, 23), 1e-4
    gradient = system.forces(pose.x).volume_gradient
    rng = np.random.default_rng(3)
    ways = [*rng.uniform(-1.0, 1.0, (3, len(gradient))), *np.eye(len(gradient))[-3:]]
    for way in ways:
        high, low = (system.forces(shifted(system, pose, s * h * way)).volume for s in (1.0, -1.0))
        assert (high - low) / (2.0 * h) == pytest.approx(float(gradient @ way), rel=1e-6)


@pytest.mark.parametrize(("center", "size"), MESHES)
def test_internal_forces_are_the_gradient_of_the_energy(center: float, size: MeshSize) -> None:
    system = System(mesh_of(center, size), 1)
    pose, h = bent(system, 24), 1e-6
    internal = system.forces(pose.x).internal
    for way in np.random.default_rng(4).uniform(-1.0, 1.0, (3, len(internal))):
        high, low = (system.forces(shifted(system, pose, s * h * way)).energy for s in (1.0, -1.0))
        assert (high - low) / (2.0 * h) == pytest.approx(float(internal @ way), rel=1e-6)


@pytest.mark.parametrize(("around", "bound"), [(8, 5e-5), (16, 4e-6)])
def test_volume_at_rest_is_the_cylinders(around: int, bound: float) -> None:
    system = System(mesh_of(270.0, MeshSize(around=around, beside=0.0)), 1)
    volume = 2.0 * system.forces(system.mesh.X).volume
    assert abs(volume / (np.pi * 8.0**2 * 21.0) - 1.0) < bound  # falls with the angle's 4th power
    # Exactly: triangles and segments of parabolas.
    b = 0.5 * np.pi / around
    section = 2.0 * around * 8.0**2 * np.sin(b) * (4.0 - np.cos(b)) / 3.0
    assert volume == pytest.approx(section * 21.0, rel=1e-12)


def test_volume_of_eight_node_bricks_is_the_polygons() -> None:
    system = System(mesh_of(200.0, COARSE8), 1)  # eight bricks around
    octagon = 4.0 * 8.0**2 * np.sin(np.pi / 4.0)
    assert system.forces(system.mesh.X).volume == pytest.approx(octagon * 21.0, rel=1e-12)


@pytest.mark.parametrize("center", [270.0, 200.0])
def test_volume_with_the_plug_moved(center: float) -> None:
    system = System(mesh_of(center), 1)
    mesh, rest = system.mesh, system.forces(system.mesh.X).volume
    # Pulled, all sections along: more height. Sheared: the same height.
    pulled = mesh.X * [1.0, 1.0, 1.2]
    assert system.forces(pulled).volume == pytest.approx(1.2 * rest, rel=1e-12)
    sheared = mesh.X.copy()
    sheared[..., 1] += 0.3 * mesh.X[..., 2]
    assert system.forces(sheared).volume == pytest.approx(rest, rel=1e-12)


@pytest.mark.parametrize("center", [270.0, 200.0])
def test_volume_of_a_bent_tube_is_pappus(center: float) -> None:
    # Sections turned about an axis across the tube: area times the way of their middle.
    system = System(
        mesh_of(center, MeshSize(around=6, beside=0.0, end=1.0, wrapped=1.0, window=1.0)), 1
    )
    mesh, radius = system.mesh, 40.0
    rest = system.forces(mesh.X).volume
    turn = mesh.X[..., 2] / radius
    x = mesh.X.copy()
    x[..., 1] = -radius + (radius + mesh.X[..., 1]) * np.cos(turn)
    x[..., 2] = (radius + mesh.X[..., 1]) * np.sin(turn)
    assert system.forces(x).volume == pytest.approx(rest, rel=1e-5)


def test_cap_by_differences() -> None:
    cap = Cap(7.0)
    centre, normal = np.array([1.0, -2.0, 9.0]), rotation_matrix(np.array([0.3, 0.2, 0.0]))[:, 2]
    volume, by_centre, by_spin, hessian = cap.volume(centre, normal)
    assert volume == pytest.approx(7.0 / 3.0 * centre @ normal)

    def at(v: FloatArray) -> float:
        return cap.volume(centre + v[:3], rotation_matrix(v[3:]) @ normal)[0]

    h, units = 1e-3, np.eye(6)
    slopes = [(at(h * e) - at(-h * e)) / (2 * h) for e in units]
    np.testing.assert_allclose(np.concatenate([by_centre, by_spin]), slopes, atol=2e-5)
    second = [
        [(at(h * (a + b)) - at(h * (a - b)) - at(h * (b - a)) + at(-h * (a + b))) / (4 * h * h)
         for b in units] for a in units
    ]  # fmt: skip
    np.testing.assert_allclose(hessian, second, atol=1e-4)
    np.testing.assert_array_equal(hessian, hessian.T)


def test_skew_is_the_cross_product() -> None:
    a, b = np.array([[1.0, 2.0, 3.0], [0.0, -1.0, 2.0]]), np.array([4.0, -1.0, 0.5])
    np.testing.assert_allclose(skew(a) @ b, np.cross(a, b))


def test_one_flat_face_by_hand() -> None:
    # A square of side 2 across z at z = 3: a pyramid of 4 * 3 / 3.
    x = np.array([[-1.0, -1, 3], [1, -1, 3], [1, 1, 3], [-1, 1, 3]]).T[..., None]
    volume, gradient, h = face_volumes(x, False)
    assert volume[0] == pytest.approx(4.0)
    assert gradient[2, :, 0].sum() == pytest.approx(4.0 / 3.0)
    assert h is None


@pytest.mark.parametrize("center", [270.0, 200.0])
def test_pose_of_the_plug_follows_its_spin(center: float) -> None:
    system = System(mesh_of(center), 1)
    chart = Chart(system.mesh)
    values = np.zeros(system.unknowns.count)
    spin = np.array([0.3, 0.0, 0.0]) if system.mesh.half else np.array([0.3, -0.2, 0.1])
    keep = 1 if system.mesh.half else 3
    values[-keep:] = 10.0 * spin[:keep]  # scaled by the outer radius
    x = shifted(system, chart.rest(), values)
    centre, R = system.plug.pose(x)
    np.testing.assert_allclose(R, rotation_matrix(spin), atol=1e-12)
    np.testing.assert_allclose(centre, [0.0, 0.0, 21.0], atol=1e-12)


def test_best_rotation_is_no_reflection() -> None:
    flat = np.array([[1.0, 0, 0], [-1, 0, 0], [0, 2, 0], [0, -2, 0]])
    Q = rotation_matrix(np.array([0.2, 2.9, -0.4]))
    np.testing.assert_allclose(best_rotation(flat, flat @ Q.T), Q, atol=1e-12)
