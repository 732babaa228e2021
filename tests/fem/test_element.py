"""Shape functions, Gauss points, reference bricks and the volume form."""

from __future__ import annotations

import numpy as np
import pytest

from fem.element import (
    Kind,
    face_nodes,
    gauss,
    natural_nodes,
    reference,
    shape,
    volume_form,
)
from tests.fem.general import enclosed, grid

KINDS: list[Kind] = ["hex20", "hex8"]
POINTS = np.random.default_rng(0).uniform(-1.0, 1.0, (6, 3))


@pytest.mark.parametrize(("kind", "count", "face"), [("hex20", 20, 8), ("hex8", 8, 4)])
def test_nodes(kind: Kind, count: int, face: int) -> None:
    nodes = natural_nodes(kind)
    assert nodes.shape == (count, 3)
    assert len({tuple(row) for row in nodes.tolist()}) == count
    assert face_nodes(kind) == face
    assert (nodes[:face, 0] == -1).all()  # inner face first
    assert (nodes[-face:, 0] == 1).all()
    np.testing.assert_array_equal(nodes[:face, 1:], nodes[-face:, 1:])


@pytest.mark.parametrize("kind", KINDS)
def test_each_shape_function_is_one_at_its_node_and_zero_at_the_others(kind: Kind) -> None:
    nodes = natural_nodes(kind)
    np.testing.assert_allclose(shape(nodes, nodes)[0], np.eye(len(nodes)), atol=1e-15)


@pytest.mark.parametrize("kind", KINDS)
def test_partition_of_unity(kind: Kind) -> None:
    N, dN = shape(natural_nodes(kind), POINTS)
    np.testing.assert_allclose(N.sum(axis=1), 1.0, atol=1e-14)
    np.testing.assert_allclose(dN.sum(axis=1), 0.0, atol=1e-14)


def test_twenty_nodes_reproduce_all_quadratics() -> None:
    nodes = natural_nodes("hex20")
    N, dN = shape(nodes, POINTS)

    def f(p: np.ndarray) -> np.ndarray:
        x, y, z = p.T
        return 2.0 - x + 3.0 * y * z + x * z - 4.0 * x**2 + y**2 + 0.5 * z**2 + x * y * z

    np.testing.assert_allclose(N @ f(nodes), f(POINTS), atol=1e-13)
    x, _, z = POINTS.T
    by_y = 3.0 * z + 2.0 * POINTS[:, 1] + x * z
    np.testing.assert_allclose(dN[:, :, 1] @ f(nodes), by_y, atol=1e-13)


@pytest.mark.parametrize("kind", KINDS)
def test_slopes_are_derivatives(kind: Kind) -> None:
    nodes, h = natural_nodes(kind), 1e-6
    dN = shape(nodes, POINTS)[1]
    for k in range(3):
        step = h * np.eye(3)[k]
        high, low = (shape(nodes, POINTS + s * step)[0] for s in (1.0, -1.0))
        np.testing.assert_allclose(dN[:, :, k], (high - low) / (2.0 * h), atol=1e-9)


def test_gauss_integrates_its_degree_exactly() -> None:
    points, w = gauss((2, 3, 2))
    assert w.sum() == pytest.approx(8.0, rel=1e-15)
    x, y, z = points.T
    assert w @ (x**2 * y**4 * z**2) == pytest.approx(2 / 3 * 2 / 5 * 2 / 3, rel=1e-14)
    assert w @ (x**3 + y**5 + z) == pytest.approx(0.0, abs=1e-15)
    assert abs(w @ x**4 - 8.0 / 5.0) > 0.1  # two points are not exact for the fourth degree
    assert points[0, 2] != points[1, 2]  # the last coordinate runs fastest
    assert points[0, 1] == points[1, 1]


@pytest.mark.parametrize("kind", KINDS)
def test_reference_of_a_block(kind: Kind) -> None:
    sides = np.array([1.0, 2.0, 3.0])
    X = natural_nodes(kind) * sides + [5.0, 6.0, 7.0]
    ref = reference(kind, np.stack([X, 2.0 * X]), (2, 3, 2))
    np.testing.assert_allclose(ref.weights.sum(axis=1), [8.0 * 6.0, 8.0 * 48.0], rtol=1e-14)
    # A linear field has its own gradient at every point.
    gradient = (ref.dN[0] @ (X @ [3.0, -2.0, 0.5])).reshape(3, -1)
    np.testing.assert_allclose(gradient, np.array([[3.0], [-2.0], [0.5]]) * np.ones(12), atol=1e-13)
    np.testing.assert_allclose(ref.dN[1], 0.5 * ref.dN[0])
    np.testing.assert_allclose(ref.weighted[1], ref.dN[1] * np.tile(ref.weights[1], 3)[:, None])
    n, q = len(X), 12
    pairs = ref.pairs[1].reshape(3, 3, q, n, n)
    a, b = ref.dN[1].reshape(3, q, n)[1, 4, 2], ref.dN[1].reshape(3, q, n)[2, 4, 5]
    assert pairs[1, 2, 4, 2, 5] == pytest.approx(ref.weights[1, 4] * a * b, rel=1e-14)


def test_a_brick_inside_out_is_refused() -> None:
    X = natural_nodes("hex20") * [1.0, 1.0, -1.0]
    with pytest.raises(ValueError, match="inside out"):
        reference("hex20", X[None], (2, 3, 2))


@pytest.mark.parametrize("face", [8, 4])
def test_volume_form_is_antisymmetric(face: int) -> None:
    S = volume_form(face)
    np.testing.assert_allclose(S, -S.transpose(1, 0, 2), atol=1e-15)
    np.testing.assert_allclose(S, -S.transpose(0, 2, 1), atol=1e-15)
    assert np.abs(S).max() > 0.01


@pytest.mark.parametrize("kind", KINDS)
def test_faces_around_a_brick_enclose_what_its_points_weigh(kind: Kind) -> None:
    # Two ways to one volume: Gauss points inside, the divergence theorem on six curved faces.
    rng = np.random.default_rng(7)
    mesh = grid(kind, (1, 1, 1), lambda u: u * [2.0, 3.0, 4.0] + rng.uniform(-0.2, 0.2, u.shape))
    inside = reference(kind, mesh.X[mesh.bricks[:1]], (3, 3, 3)).weights.sum()
    sides = [(axis, end) for axis in range(3) for end in range(2)]
    around = sum(
        (1.0 if end else -1.0) * enclosed(mesh.X + 50.0, mesh.faces(axis, end), False)[0]
        for axis, end in sides
    )
    assert around == pytest.approx(inside, rel=1e-9)
