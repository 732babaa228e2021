"""The thread law and row 11; how much gauze covers what."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from fem import gauze
from fem.actuator import Actuator, Window
from fem.assembly import System
from fem.gauze import Gauze, Threads
from fem.mesh import Mesh, make_mesh
from fem.meshsize import MeshSize
from tests.fem.tubes import COARSE, mesh_of

FloatArray = NDArray[np.float64]

STRICT = Gauze(slack=0.0)
LAWS = [STRICT, Gauze(), Gauze(slack=1.0), Gauze(slack=0.3, transition=0.1)]


def at(law: Gauze, *lam: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    return gauze.tension_law(law, np.array(lam))


def test_compressed_threads_carry_nothing() -> None:
    for value in at(STRICT, 0.2, 0.9, 0.999999, 1.0):
        np.testing.assert_array_equal(value, 0.0)


def test_taut_threads_by_hand() -> None:
    # Beyond the transition d the force is e - d / 2; the ramp before it stores d^2 / 6.
    law = Gauze(slack=0.0, transition=0.02)
    energy, force, tangent = at(law, 1.01, 1.02, 1.05)
    np.testing.assert_allclose(tangent, [0.5, 1.0, 1.0])
    np.testing.assert_allclose(force, [0.0025, 0.01, 0.04])
    np.testing.assert_allclose(energy, [0.01**3 / 0.12, 0.02**2 / 6, 0.02**2 / 6 + 0.03 * 0.025])


def test_bars_are_linear() -> None:
    energy, force, tangent = at(Gauze(slack=1.0), 0.9, 1.1)
    np.testing.assert_allclose(force, [-0.1, 0.1])
    np.testing.assert_allclose(energy, [0.005, 0.005])
    np.testing.assert_array_equal(tangent, 1.0)


@pytest.mark.parametrize("law", LAWS)
def test_force_and_tangent_are_derivatives(law: Gauze) -> None:
    d = law.transition
    lam = 1.0 + d * np.array([-50.0, -0.7, 0.0, 0.3, 0.9, 1.0, 1.4, 60.0])
    h = 1e-3 * d
    (E1, f1, _), (E0, f0, _) = gauze.tension_law(law, lam + h), gauze.tension_law(law, lam - h)
    _, force, tangent = gauze.tension_law(law, lam)
    np.testing.assert_allclose((E1 - E0) / (2 * h), force, atol=1e-6 * d)
    np.testing.assert_allclose((f1 - f0) / (2 * h), tangent, atol=3e-4)  # kinks: h / 4 d


@pytest.mark.parametrize("law", LAWS)
def test_the_law_has_no_jump(law: Gauze) -> None:
    for place in (1.0, 1.0 + law.transition):
        low, high = at(law, place - 1e-12), at(law, place + 1e-12)
        np.testing.assert_allclose(low, high, atol=1e-7)


def test_threads_forces_and_stiffness_are_derivatives() -> None:
    mesh, h = mesh_of(gauze=Gauze(transition=0.05)), 1e-6
    law, faces = mesh.actuator.gauze, slice(0, 3)
    threads = Threads(mesh.axial.gradient[faces], mesh.axial.weight[faces])
    rng = np.random.default_rng(1)
    flat = mesh.X.reshape(-1, 3)
    x = flat[mesh.outer] * [1.02, 0.97, 1.03] + rng.uniform(-0.1, 0.1, (3, 8, 3))
    way = rng.normal(size=x.shape)
    state = gauze.respond(law, threads, x, True)
    high, low = (gauze.respond(law, threads, x + s * h * way, False) for s in (1.0, -1.0))
    assert high.stiffness is None
    slope = float((high.energy - low.energy).sum()) / (2 * h)
    assert float((state.force * way).sum()) == pytest.approx(slope, rel=1e-6)
    assert state.stiffness is not None
    K = state.stiffness.reshape(3, 6, 8, 8)
    for e in range(3):
        moved = np.zeros((8, 3))
        for m, (i, k) in enumerate(((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))):
            moved[:, i] += K[e, m] @ way[e, :, k]
            if i != k:
                moved[:, k] += K[e, m].T @ way[e, :, i]
        slopes = (high.force[e] - low.force[e]) / (2 * h)
        np.testing.assert_allclose(moved, slopes, atol=1e-6 * np.abs(slopes).max())


@pytest.mark.parametrize("center", [270.0, 200.0])
def test_a_slack_tube_still_has_a_regular_tangent(center: float) -> None:
    # Pushed together by 1 % and a little narrower, no thread is taut: the rubber is all there is.
    mesh = mesh_of(center, gauze=STRICT)
    x = mesh.X * [0.999, 0.999, 0.99]
    flat = x.reshape(-1, 3)
    first = np.arange(mesh.layers)[:, None, None] * (mesh.ring + mesh.mid)
    outer = flat[(first + mesh.outer).reshape(-1, 8)]
    for family in (mesh.axial, mesh.hoop):
        state = gauze.respond(STRICT, family, outer, True)
        assert state.stiffness is not None
        for value in (state.energy, state.force, state.stiffness):
            np.testing.assert_array_equal(value, 0.0)
    system = System(mesh, 1)
    forces, inverse = system.factor(x, 0.0)
    assert inverse is not None
    assert inverse.negative == 0
    du = inverse.solve(-forces.internal)
    assert np.isfinite(du).all()
    assert np.abs(du).max() < 1.0
    bare = System(mesh_of(center, gauze=replace(STRICT, stiffness=1e-12)), 1).forces(x)
    np.testing.assert_allclose(forces.internal, bare.internal, atol=1e-11)


@pytest.mark.parametrize(
    "wrong",
    [{"stiffness": 0.0}, {"slack": -0.1}, {"slack": 1.1}, {"transition": 0.0}, {"pitch": 0.0},
     {"allowance": -0.1}, {"allowance": 3.2}],
)  # fmt: skip
def test_no_such_gauze(wrong: dict[str, float]) -> None:
    with pytest.raises(ValueError, match="a gauze needs"):
        Gauze(**wrong)


def in_window(mesh: Mesh, number: int = 0) -> FloatArray:
    """Weights of the axial threads in a window's layers."""
    w = mesh.actuator.windows[number]
    middle = 0.5 * (mesh.z[1:] + mesh.z[:-1])
    inside = np.repeat((middle > w.start) & (middle < w.end), mesh.around)
    return mesh.axial.weight[inside]


def coverage(alpha: float, center: float, whole: bool, allowance: float = np.radians(6.0)) -> float:
    """Axial stiffness times length in the window, over that of a full turn."""
    law = Gauze(allowance=allowance)
    actuator = Actuator(22.0, (Window(10.0, 5.0, alpha, center),), gauze=law)
    mesh = make_mesh(actuator, COARSE, whole)
    share = 2.0 if mesh.half else 1.0
    return share * float(in_window(mesh).sum()) / (law.stiffness * 5.0 * 10.0)


@given(st.floats(0.05, 5.7), st.floats(0.0, 2.0 * np.pi))
@settings(max_examples=25)
def test_a_sector_anywhere_is_covered_by_its_angle(alpha: float, center: float) -> None:
    assert coverage(alpha, center, True) == pytest.approx(alpha + np.radians(6.0), rel=1e-10)


@pytest.mark.parametrize("center", [270.0, 90.0])
@pytest.mark.parametrize("alpha", [10.0, 84.0, 132.0, 180.0, 300.0, 330.0])
@pytest.mark.parametrize("whole", [False, True])
def test_half_models_have_half_of_it(alpha: float, center: float, whole: bool) -> None:
    a = np.radians(alpha)
    found = coverage(a, np.radians(center), whole)
    assert found == pytest.approx(np.radians(alpha + 6.0), rel=1e-10)
    without = coverage(a, np.radians(center), whole, allowance=0.0)
    assert without == pytest.approx(a, rel=1e-10)


def test_the_sector_lies_where_it_should() -> None:
    # Threads of 40 + 6 degrees around 110: all within, and their mean is there.
    window = Window(10.0, 5.0, np.radians(40.0), np.radians(110.0))
    mesh = make_mesh(Actuator(22.0, (window,)), COARSE)
    x = mesh.X.reshape(-1, 3)
    k = int(np.flatnonzero(mesh.z > window.start + 1e-6)[0]) - 1
    faces = slice(k * mesh.around, (k + 1) * mesh.around)
    weight = mesh.axial.weight[faces].sum(axis=1)
    nodes = mesh.outer + k * (mesh.ring + mesh.mid)
    middle = x[nodes].mean(axis=1)
    phi = np.degrees(np.arctan2(middle[:, 1], middle[:, 0]))
    off = np.abs((phi - 110.0 + 180.0) % 360.0 - 180.0)
    assert (weight[off > 23.0 + 30.0] == 0.0).all()
    assert float(weight @ off) / float(weight.sum()) < 30.0


def test_wrapped_sectors_are_covered_all_around() -> None:
    mesh = mesh_of(200.0)
    total = mesh.actuator.gauze.stiffness * 2.0 * np.pi * 10.0
    covered = mesh.axial.weight.sum() - in_window(mesh).sum()
    assert covered == pytest.approx(total * (21.0 - 5.0), rel=1e-12)
    # Hoop threads stay everywhere, the window included; they are as long as the faces' parabolas.
    fine = mesh_of(200.0, replace(COARSE, around=10))
    assert fine.hoop.weight.sum() == pytest.approx(total * 21.0, rel=1e-4)


def test_axial_gradients_measure_the_axial_stretch() -> None:
    mesh = mesh_of(200.0)
    first = np.arange(mesh.layers)[:, None, None] * (mesh.ring + mesh.mid)
    outer = (first + mesh.outer).reshape(-1, 8)
    x = (mesh.X * [1.2, 1.2, 0.8]).reshape(-1, 3)[outer]
    np.testing.assert_allclose(gauze.stretch(mesh.axial, x), 0.8, rtol=1e-12)
    np.testing.assert_allclose(gauze.stretch(mesh.hoop, x), 1.2, rtol=1e-12)


def single(alpha: float, pitch: float, whole: bool, size: MeshSize = COARSE) -> Mesh:
    law = Gauze(pitch=pitch, allowance=0.0)
    window = Window(10.0, 5.0, np.radians(alpha))
    return make_mesh(Actuator(22.0, (window,), gauze=law), size, whole)


@pytest.mark.parametrize("whole", [False, True])
@pytest.mark.parametrize(("alpha", "count"), [(80.0, 9), (99.0, 9), (101.0, 11), (5.0, 1)])
def test_single_threads_are_counted(alpha: float, count: int, whole: bool) -> None:
    # 36 threads of 10 degrees, one of them facing the object: 9 within 40 degrees to each side.
    mesh = single(alpha, 2.0 * np.pi * 10.0 / 36.0, whole)
    each = mesh.actuator.gauze.stiffness * 2.0 * np.pi * 10.0 / 36.0
    share = 2.0 if mesh.half else 1.0
    assert share * in_window(mesh).sum() / (each * 5.0) == pytest.approx(count, rel=1e-12)
    wrapped = mesh.axial.weight.sum() - in_window(mesh).sum()
    assert share * wrapped / (each * 16.0) == pytest.approx(36.0, rel=1e-12)


def test_single_rings_are_counted() -> None:
    mesh = single(80.0, 2.0, True, replace(COARSE, around=10))
    # 21 mm at a pitch of 2: at 1, 3 ... 21, the last beyond the end; each with its width of 2.
    each = mesh.actuator.gauze.stiffness * 2.0 * 2.0 * np.pi * 10.0
    assert mesh.hoop.weight.sum() / each == pytest.approx(10.0, rel=1e-4)


def test_weights_do_not_hang_on_the_mesh() -> None:
    fine = MeshSize(around=11, beside=0.0, edge=0.7, window=1.3, wrapped=3.0, end=1.1)
    window = Window(10.0, 5.0, np.radians(70.0))
    actuator = Actuator(22.0, (window,))
    totals = [make_mesh(actuator, size).axial.weight.sum() for size in (COARSE, fine)]
    assert totals[0] == pytest.approx(totals[1], rel=1e-12)
