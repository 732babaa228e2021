"""Row 2: a rigid motion on top of a deformation, for bricks, threads and the whole tube."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from fem import gauze, solid
from fem.assembly import System
from fem.element import Kind, natural_nodes, reference
from fem.gauze import Gauze, Threads
from fem.material import PAIRS, MooneyRivlin
from fem.sections import rotation_matrix
from tests.fem.tubes import COARSE, COARSE8, bent, mesh_of

FloatArray = NDArray[np.float64]

TURN = rotation_matrix(np.array([0.7, -1.1, 0.4]))
SHIFT = np.array([5.0, -3.0, 8.0])
RUBBER = MooneyRivlin(0.07, 0.06, 3.2)


def full(stiffness: FloatArray, n: int) -> FloatArray:
    """(6, n * n) as (3, 3, n, n)."""
    K = np.empty((3, 3, n, n))
    for m, (i, k) in enumerate(PAIRS):
        K[i, k] = stiffness[m].reshape(n, n)
        K[k, i] = stiffness[m].reshape(n, n).T
    return K


def brick(kind: Kind, x: FloatArray, mean: bool) -> tuple[float, FloatArray, FloatArray]:
    X = natural_nodes(kind).astype(float) * [1.0, 1.5, 1.0]
    n = len(X)
    S = np.empty((6, 1, 1, n * n))
    state = solid.respond(
        RUBBER,
        reference(kind, X[None], (2, 3, 2)),
        np.array([2.0]),
        np.ascontiguousarray(x.T[:, None, :, None]),
        solid.Workspace(),
        S,
        mean_dilatation=mean,
    )
    return state.energy, state.force[:, 0, :, 0].T, full(S[:, 0, 0], n)


CURES: list[tuple[Kind, bool]] = [("hex20", False), ("hex8", True), ("hex8", False)]


def deformed(kind: Kind) -> FloatArray:
    X = natural_nodes(kind).astype(float) * [1.0, 1.5, 1.0]
    x: FloatArray = X * [1.3, 0.9, 1.1] + np.random.default_rng(3).uniform(-0.15, 0.15, X.shape)
    return x


@pytest.mark.parametrize(("kind", "mean"), CURES)
def test_bricks(kind: Kind, mean: bool) -> None:
    x = deformed(kind)
    energy, force, K = brick(kind, x, mean)
    turned_energy, turned_force, turned_K = brick(kind, x @ TURN.T + SHIFT, mean)
    assert energy > 0.01
    assert turned_energy == pytest.approx(energy, rel=1e-10)
    np.testing.assert_allclose(turned_force, force @ TURN.T, atol=1e-10)
    np.testing.assert_allclose(turned_K, np.einsum("ip,kr,prab->ikab", TURN, TURN, K), atol=1e-10)


@pytest.mark.parametrize(("kind", "mean"), CURES)
def test_bricks_pull_with_no_net_force_or_moment(kind: Kind, mean: bool) -> None:
    x = deformed(kind)
    _, force, K = brick(kind, x, mean)
    np.testing.assert_allclose(force.sum(axis=0), 0.0, atol=1e-12)
    np.testing.assert_allclose(np.cross(x, force).sum(axis=0), 0.0, atol=1e-12)
    np.testing.assert_allclose(K.sum(axis=3), 0.0, atol=1e-11)


@pytest.mark.parametrize(("kind", "mean"), CURES)
def test_bricks_forces_and_stiffness_are_derivatives(kind: Kind, mean: bool) -> None:
    x, h = deformed(kind), 1e-5
    way = np.random.default_rng(4).normal(size=x.shape)
    _, force, K = brick(kind, x, mean)
    high, low = (brick(kind, x + s * h * way, mean) for s in (1.0, -1.0))
    assert (high[0] - low[0]) / (2 * h) == pytest.approx(float((force * way).sum()), rel=1e-7)
    slope = (high[1] - low[1]) / (2 * h)
    np.testing.assert_allclose(np.einsum("ikab,bk->ai", K, way), slope, atol=1e-7)


def test_height_stretches_the_reference() -> None:
    # A brick 5 mm high by its height is one whose nodes are 5 mm high.
    X = natural_nodes("hex20").astype(float)
    tall = X * [1.0, 1.0, 2.5]
    x = tall + np.random.default_rng(5).uniform(-0.1, 0.1, X.shape)
    found = []
    for nodes, height in ((X, 5.0), (tall, 2.0)):
        S = np.empty((6, 1, 1, 400))
        state = solid.respond(
            RUBBER, reference("hex20", nodes[None], (2, 3, 2)), np.array([height]),
            np.ascontiguousarray(x.T[:, None, :, None]), solid.Workspace(), S,
        )  # fmt: skip
        found.append((state.energy, state.force, S))
    for by_height, by_nodes in zip(*found, strict=True):
        np.testing.assert_allclose(by_height, by_nodes, atol=1e-12)


def test_threads() -> None:
    rng = np.random.default_rng(6)
    threads = Threads(rng.normal(size=(2, 3, 8)) * 0.2, rng.uniform(1.0, 2.0, (2, 3)))
    threads.gradient[...] -= threads.gradient.mean(axis=2, keepdims=True)  # blind to a shift
    law = Gauze(transition=0.05)
    x = 6.0 * rng.normal(size=(2, 8, 3))
    assert (gauze.stretch(threads, x) > 1.0).any()
    assert (gauze.stretch(threads, x) > 0.3).all()
    at = gauze.respond(law, threads, x, True)
    turned = gauze.respond(law, threads, x @ TURN.T + SHIFT, True)
    assert at.stiffness is not None
    assert turned.stiffness is not None
    np.testing.assert_allclose(turned.energy, at.energy, rtol=1e-10)
    np.testing.assert_allclose(turned.force, at.force @ TURN.T, atol=1e-10)
    for before, after in zip(at.stiffness, turned.stiffness, strict=True):
        expected = np.einsum("ip,kr,prab->ikab", TURN, TURN, full(before, 8))
        np.testing.assert_allclose(full(after, 8), expected, atol=1e-10)


@pytest.mark.parametrize("size", [COARSE, COARSE8])
@pytest.mark.parametrize("center", [270.0, 200.0])
def test_the_whole_tube_turned_about_its_root(size: object, center: float) -> None:
    # The root's section goes through the origin, so the enclosed volume stays as well. A half
    # model can turn within its plane only.
    system = System(mesh_of(center, size), 1)  # type: ignore[arg-type]
    pose = bent(system, 3)
    Q = rotation_matrix(np.array([0.6, 0.0, 0.0])) if system.mesh.half else TURN
    before, after = system.forces(pose.x), system.forces(pose.x @ Q.T)
    assert before.energy > 1.0
    assert after.energy == pytest.approx(before.energy, rel=1e-10)
    assert after.volume == pytest.approx(before.volume, rel=1e-10)
    assert after.least_J == pytest.approx(before.least_J, rel=1e-10)
