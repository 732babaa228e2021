"""Stations, volumes and symmetry of the mesh; actuators that cannot be."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from fem.actuator import AWAY, TOWARD, Actuator, Window, chain
from fem.element import natural_nodes, reference
from fem.errors import BadGeometry, FemError
from fem.mesh import Mesh, make_mesh
from fem.meshsize import DEFAULT_MESH, MeshSize
from tests.fem.tubes import COARSE, COARSE8

QUARTER = np.radians(90.0)


def two_joints(center: float = TOWARD) -> Actuator:
    return Actuator(
        60.0, (Window(15.0, 10.0, QUARTER), Window(38.0, 6.0, QUARTER, center)), plug=1.0
    )


@pytest.mark.parametrize("size", [DEFAULT_MESH, COARSE8, COARSE])
def test_rings_lie_on_every_window_edge(size: MeshSize) -> None:
    z = make_mesh(two_joints(), size).z
    assert (np.diff(z) > 0.0).all()
    for edge in (0.0, 10.0, 20.0, 35.0, 41.0, 59.0):
        assert np.abs(z - edge).min() < 1e-12


def test_heights_grow_from_the_edges_and_are_bounded() -> None:
    mesh = make_mesh(two_joints(), MeshSize(edge=0.5, window=2.5, wrapped=8.0, end=2.0, growth=2.0))
    z, h = mesh.z, mesh.heights  # stretched by a tenth at most to fill a length
    for edge in (10.0, 20.0, 35.0, 41.0):
        k = int(np.argmin(np.abs(z - edge)))
        assert max(h[k - 1], h[k]) <= 1.1 * 0.5 + 1e-12
    middle = 0.5 * (z[1:] + z[:-1])
    for w in mesh.actuator.windows:
        assert h[(middle > w.start) & (middle < w.end)].max() <= 1.1 * 2.5
    assert h.max() <= 1.1 * 8.0
    assert h.max() > 2.5
    assert h[0] <= 1.1 * 2.0
    ratio = h[1:] / h[:-1]
    assert ratio.max() < 2.6
    assert ratio.min() > 1.0 / 2.6


def test_sizes_scale_with_the_tube() -> None:
    small = Actuator(60.0, (Window(15.0, 10.0, QUARTER),))
    big = Actuator(120.0, (Window(30.0, 20.0, QUARTER),), diameter=40.0, wall=4.0, plug=2.0)
    np.testing.assert_allclose(make_mesh(big).X, 2.0 * make_mesh(small).X, atol=1e-9)


SLIM = MeshSize(around=8, beside=0.0, growth=2.0, edge=4.0, window=5.0, wrapped=20.0, end=10.0)


def volume(mesh: Mesh) -> float:
    """Of the rubber, brick by brick from the nodes."""
    total = 0.0
    for layer in range(mesh.layers):
        nodes = mesh.bricks + layer * (mesh.ring + mesh.mid)
        X = mesh.X.reshape(-1, 3)[nodes]
        total += float(reference(mesh.size.kind, X, (3, 3, 3)).weights.sum())
    return total


def test_volume_of_the_rubber() -> None:
    half, whole = (make_mesh(two_joints(), SLIM, whole=w) for w in (False, True))
    assert half.half
    assert not whole.half
    tube = np.pi * (10.0**2 - 8.0**2) * 59.0
    assert volume(half) == pytest.approx(0.5 * tube, rel=5e-5)
    assert volume(whole) == pytest.approx(2.0 * volume(half), rel=1e-12)
    polygon = 4.0 * np.sin(np.pi / 4.0) * (10.0**2 - 8.0**2) * 59.0
    assert volume(make_mesh(two_joints(), COARSE8, whole=True)) == pytest.approx(polygon, rel=1e-12)


@pytest.mark.parametrize("size", [COARSE, COARSE8])
@pytest.mark.parametrize("whole", [False, True])
def test_references_are_those_of_the_bricks(size: MeshSize, whole: bool) -> None:
    # One brick turned and stretched stands for all: same volume and same gradients, up to a turn.
    mesh = make_mesh(two_joints(), size, whole)
    layer, height = 3, float(mesh.heights[3])
    nodes = mesh.bricks + layer * (mesh.ring + mesh.mid)
    for number, X in enumerate(mesh.X.reshape(-1, 3)[nodes]):
        own = reference(size.kind, X[None], size.orders)
        deep, column = divmod(number, mesh.around)
        shared = mesh.brick[deep]
        np.testing.assert_allclose(
            own.weights[0], shared.weights[column] * 0.5 * height, rtol=1e-12
        )
        q, n = own.weights.shape[1], X.shape[0]
        a, b = own.dN.reshape(3, q, n), shared.dN[column].reshape(3, q, n)
        np.testing.assert_allclose(a[2], b[2] * 2.0 / height, atol=1e-12)
        np.testing.assert_allclose((a[:2] ** 2).sum(axis=0), (b[:2] ** 2).sum(axis=0), atol=1e-12)


@pytest.mark.parametrize("size", [COARSE, COARSE8])
def test_bricks_touch_without_gaps(size: MeshSize) -> None:
    for whole in (False, True):
        mesh = make_mesh(two_joints(), size, whole)
        used = np.unique(mesh.bricks)
        np.testing.assert_array_equal(used, np.arange(2 * mesh.ring + mesh.mid))
        assert mesh.X.shape == (mesh.layers + 1, mesh.ring + mesh.mid, 3)
        assert mesh.bricks.shape == (size.through * mesh.around, len(natural_nodes(size.kind)))
        ring = np.round(mesh.X[0, : mesh.ring], 9)
        assert len(np.unique(ring, axis=0)) == mesh.ring  # no node stands twice


def test_faces_lie_on_their_surfaces() -> None:
    mesh = make_mesh(two_joints(), COARSE8, whole=True)
    flat = mesh.X.reshape(-1, 3)
    for faces, r in ((mesh.outer, 10.0), (mesh.inner, 8.0)):
        np.testing.assert_allclose(np.hypot(*flat[faces][..., :2].T), r, rtol=1e-12)
    np.testing.assert_allclose(np.hypot(*mesh.X[0, mesh.outer_ring, :2].T), 10.0, rtol=1e-12)


def test_the_plane_of_symmetry_holds_what_lies_in_it() -> None:
    mesh = make_mesh(two_joints(AWAY), COARSE)
    assert mesh.half
    assert mesh.X[..., 0].min() > -1e-9
    on_plane = np.abs(mesh.X[0, : mesh.ring, 0]) < 1e-9
    np.testing.assert_array_equal(mesh.fixed_ring[:, 0], on_plane)
    assert on_plane.sum() == 6
    assert not mesh.fixed_ring[:, 1:].any()
    assert not make_mesh(two_joints(AWAY), COARSE, whole=True).fixed_ring.any()
    assert not make_mesh(two_joints(np.radians(250.0)), COARSE).half


def test_counts() -> None:
    mesh = make_mesh(two_joints(), COARSE)
    assert mesh.elements == 3 * mesh.layers
    assert mesh.nodes == (mesh.layers + 1) * mesh.ring + mesh.layers * mesh.mid
    assert (mesh.ring, mesh.mid) == (7 * 2 + 4, 4 * 2)


def joint(centre: float = 30.0, openF: float = 10.0, alpha: float = 90.0) -> Window:
    return Window(centre, openF, np.radians(alpha))


BAD: list[tuple[str, Callable[[], Actuator]]] = [
    ("finite numbers", lambda: Actuator(float("nan"), ())),
    ("finite numbers", lambda: Actuator(60.0, (joint(float("inf")),))),
    ("does not make a tube", lambda: Actuator(60.0, (), diameter=0.0)),
    ("does not make a tube", lambda: Actuator(60.0, (), wall=10.0)),
    ("does not make a tube", lambda: Actuator(60.0, (), wall=-1.0)),
    ("beyond this model", lambda: Actuator(60.0, (), wall=0.1)),
    ("beyond this model", lambda: Actuator(60.0, (), wall=7.0)),
    ("has no inside", lambda: Actuator(60.0, (), plug=59.0)),
    ("has no inside", lambda: Actuator(60.0, (), plug=-1.0)),
    ("joint 1: a cut of 0.1 mm is too short", lambda: Actuator(60.0, (joint(openF=0.1),))),
    ("joint 1: a cut of -4 mm is too short", lambda: Actuator(60.0, (joint(openF=-4.0),))),
    ("joint 1: alpha_closed 0 deg", lambda: Actuator(60.0, (joint(alpha=0.0),))),
    ("joint 1: alpha_closed 331 deg", lambda: Actuator(60.0, (joint(alpha=331.0),))),
    ("joint 1 reaches beyond the clamped end", lambda: Actuator(60.0, (joint(4.0),))),
    ("joint 1 reaches beyond the plug", lambda: Actuator(60.0, (joint(55.0),))),
    ("joints 1 and 2 leave 0.3 mm", lambda: Actuator(60.0, (joint(20.0), joint(30.3)))),
    ("joints 1 and 2 leave -20 mm", lambda: Actuator(60.0, (joint(30.0), joint(20.0)))),
]


@pytest.mark.parametrize(("reason", "make"), BAD)
def test_impossible_actuators_are_told_why(reason: str, make: Callable[[], Actuator]) -> None:
    with pytest.raises(BadGeometry, match=reason) as caught:
        make()
    assert isinstance(caught.value, FemError)


def test_bounds_themselves_are_possible() -> None:
    Actuator(60.0, (joint(5.0, alpha=330.0), joint(54.0)))
    Actuator(60.0, (joint(20.0), joint(30.4)))
    Actuator(60.0, (), wall=0.2)
    Actuator(60.0, (), wall=6.0)


def test_chain_lays_joints_out_from_centre_to_centre() -> None:
    a = chain(10.0, [19.0, 21.0], [8.0, 6.0], [1.0, 2.0], [TOWARD, AWAY], end=4.0)
    assert a.length == 54.0
    assert [w.centre for w in a.windows] == [10.0, 29.0]
    assert [w.openF for w in a.windows] == [8.0, 6.0]
    assert [w.away for w in a.windows] == [False, True]
    assert a.wrapped == ((0.0, 6.0), (14.0, 26.0), (32.0, 53.0))
    assert a.in_plane
