"""Runs against an obstacle: balance, energy, independence of penalty and steps, closed forms."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from fem.actuator import Actuator, chain
from fem.against import solve_against
from fem.contact import Contact, Surface, pressed_of
from fem.element import face_nodes, gauss, natural_nodes, shape
from fem.gap import Gap, Obstacle, Plane, Sphere
from fem.gauze import Gauze
from fem.grasp import Contacts
from fem.meshsize import MeshSize
from fem.solution import Solution
from fem.solver import solve
from tests.fem.tubes import COARSE, mesh_of

FloatArray = NDArray[np.float64]
FLOOR = Plane(np.array([0.0, -10.5, 0.0]), np.array([0.0, 1.0, 0.0]))


def joint() -> Actuator:
    return chain(12.0, [26.0], [8.0], [np.radians(90.0)])


@pytest.fixture(scope="module")
def free() -> Solution:
    return solve(joint(), [0.02, 0.04, 0.06], COARSE)


def normal(run: Contacts, k: int = -1) -> float:
    pressed = run.touches[k].pressed
    return (2.0 if run.mesh.half else 1.0) * float((pressed.area * pressed.pressure).sum())


class Everywhere:
    """An obstacle that is everywhere 0.1 mm above the surface, pushing one way."""

    def gap(self, x: FloatArray) -> Gap:
        up = np.broadcast_to([0.0, 1.0, 0.0], x.shape)
        return Gap(np.full(len(x), -0.1), up, np.zeros((*x.shape, 3)))

    def near(self, x: FloatArray) -> NDArray[np.bool_]:
        return np.ones(len(x), dtype=bool)


def test_a_uniform_pressure_makes_the_consistent_forces_of_its_faces() -> None:
    mesh = mesh_of()
    contact = Contact(Everywhere(), penalty=1.0, ramp=0.02)
    pressed = pressed_of(contact, mesh, mesh.X)
    np.testing.assert_allclose(pressed.pressure, 0.09, rtol=1e-12)
    surface = Surface.of(mesh)
    found = np.einsum("qm,lcq->lcm", surface.N, pressed.area * pressed.pressure)
    m = face_nodes(mesh.size.kind)
    points, w = gauss((12, 12))
    N, dN = shape(natural_nodes(mesh.size.kind)[-m:, 1:], points)
    along = np.einsum("qnd,lcni->lcqdi", dN, mesh.X.reshape(-1, 3)[surface.nodes])
    area = w * np.linalg.norm(np.cross(along[..., 0, :], along[..., 1, :]), axis=-1)
    wanted = 0.09 * np.einsum("qm,lcq->lcm", N, area)
    np.testing.assert_allclose(found, wanted, atol=1e-10)
    assert wanted.min() < 0.0  # at the corners it pulls, and that is right


def test_forces_balance_and_energy_is_kept(free: Solution) -> None:
    run = solve_against(free, FLOOR, [0.05, 0.06], tolerance=3e-10)
    assert run.failure is None
    for state, touch in zip(run.states, run.touches, strict=True):
        # The air pushes on the clamped opening as it does on the closed end.
        opening = state.pressure * _bore(run)
        total = touch.clamp - touch.force + [0.0, 0.0, opening]
        np.testing.assert_allclose(total, 0.0, atol=1e-8)
        assert touch.depth <= 0.01
        assert state.energy_error < 1e-3
    assert run.touches[-1].force[1] < -0.1
    assert run.first_touch is not None
    assert 0.0 < run.first_touch < 0.06


def _bore(run: Contacts) -> float:
    """Area of the clamped opening, as the faces of the mesh enclose it."""
    inner = run.mesh.X[0, : run.mesh.ring, :2]
    radius = run.mesh.actuator.radius - run.mesh.actuator.wall
    on = np.abs(np.hypot(*inner.T) - radius) < 1e-9
    ring = inner[on][np.argsort(np.arctan2(inner[on, 1], inner[on, 0] + 1e-12))]
    area = 0.0
    for a, b, c in zip(ring[:-2:2], ring[1::2], ring[2::2], strict=False):
        x, w = np.polynomial.legendre.leggauss(4)
        N = np.stack([0.5 * x * (x - 1.0), 1.0 - x**2, 0.5 * x * (x + 1.0)])
        dN = np.stack([x - 0.5, -2.0 * x, x + 0.5])
        p, t = np.stack([a, b, c]).T @ N, np.stack([a, b, c]).T @ dN
        area += 0.5 * float(w @ (p[0] * t[1] - p[1] * t[0]))
    return 2.0 * area


def test_the_penalty_does_not_matter(free: Solution) -> None:
    forces = [
        normal(solve_against(free, Contact(FLOOR, penalty=eps), [0.06])) for eps in (3.0, 30.0)
    ]
    assert forces[0] == pytest.approx(forces[1], rel=0.01)


@pytest.mark.slow
def test_more_pressures_asked_change_nothing(free: Solution) -> None:
    few = solve_against(free, FLOOR, [0.05, 0.06])
    many = solve_against(free, FLOOR, [0.045, 0.05, 0.055, 0.06])
    assert normal(many) == pytest.approx(normal(few), rel=0.005)
    tips = [run.states[-1].shape.centre[-1] for run in (few, many)]
    np.testing.assert_allclose(*tips, atol=0.01)  # the depth that is let pass


def test_where_nothing_is_in_the_way_the_tube_is_free(free: Solution) -> None:
    far = Plane(np.array([0.0, -80.0, 0.0]), np.array([0.0, 1.0, 0.0]))
    run = solve_against(free, far, [0.06])
    assert run.first_touch is None
    assert normal(run) == 0.0
    np.testing.assert_allclose(run.states[-1].theta, free.states[-1].theta, atol=1e-5)


@pytest.mark.parametrize(
    ("obstacle", "told"),
    [
        (Plane(np.array([0.0, -7.0, 0.0]), np.array([0.0, 1.0, 0.0])), "clamped end lies 3.0 mm"),
        (Sphere(np.array([0.0, -19.0, 2.0]), 12.0), "clamped end lies 2.8 mm"),
    ],
)
def test_a_scene_that_cannot_be_is_told(free: Solution, obstacle: Obstacle, told: str) -> None:
    run = solve_against(free, obstacle, [0.06])
    assert run.failure is not None
    assert told in run.failure
    assert run.states == ()


@pytest.mark.slow
def test_an_object_in_the_way_at_rest_comes_to_its_place(free: Solution) -> None:
    run = solve_against(free, Sphere(np.array([0.0, -19.0, 24.0]), 11.0), [0.04])
    assert run.failure is None
    assert run.touches[-1].depth < 0.02
    assert run.first_touch is None or run.first_touch < 1e-3


def test_half_a_tube_meets_no_lopsided_object(free: Solution) -> None:
    beside = Sphere(np.array([4.0, -40.0, 20.0]), 20.0)
    with pytest.raises(ValueError, match="not symmetric"):
        solve_against(free, beside, [0.06])
    whole = solve(joint(), [0.02, 0.04, 0.06], COARSE, whole=True)
    beside = replace(beside, centre=np.array([4.0, -31.0, 26.0]))
    run = solve_against(whole, beside, [0.06])
    assert run.failure is None
    assert abs(run.touches[-1].force[0]) > 0.01


class Slot:
    """What lies above and below a slot along the tube."""

    def __init__(self, half: float) -> None:
        self._half = half

    def gap(self, x: FloatArray) -> Gap:
        normal = np.zeros_like(x)
        normal[:, 1] = np.where(x[:, 1] > 0.0, -1.0, 1.0)
        return Gap(self._half - np.abs(x[:, 1]), normal, np.zeros((*x.shape, 3)))

    def near(self, x: FloatArray) -> NDArray[np.bool_]:
        return np.asarray(np.abs(x[:, 1]) > self._half - 1.0)


@pytest.mark.slow
@pytest.mark.parametrize(("alpha", "blocked"), [(84.0, 344.0), (156.0, 267.0)])
def test_a_blocked_joint_pushes_with_more_than_its_pressure_about_its_uncut_threads(
    alpha: float, blocked: float
) -> None:
    """Moment P pi r^2 e of the pressure about the middle of the uncut sector's threads, N mm.

    A slot holds the tube straight but for what the wrapped sectors give way by, so the joint
    keeps a part of its free angle, and loses as much of its moment.
    """
    tube = chain(30.0, [30.0], [10.0], [np.radians(alpha)])
    free = solve(tube, np.linspace(0.019, 0.19, 10).tolist())
    run = solve_against(free, Slot(10.05), [0.19])
    assert run.failure is None
    pressed = run.touches[-1].pressed
    beyond = pressed.points[..., 2] > 30.0
    arm = pressed.points[..., 2] - 30.0
    moment = -2.0 * float((pressed.force[..., 1] * arm)[beyond].sum())
    kept = float(run.states[-1].theta[0] / free.states[-1].theta[0])
    assert kept < 0.5
    assert blocked * (1.0 - kept) < moment < 1.5 * blocked


class Plates(Slot):
    """A slot of two plates that ends before a tube of 140 mm does."""

    def gap(self, x: FloatArray) -> Gap:
        found = super().gap(x)
        return replace(found, distance=np.where(self._between(x), found.distance, 1e3))

    def near(self, x: FloatArray) -> NDArray[np.bool_]:
        return super().near(x) & self._between(x)

    @staticmethod
    def _between(x: FloatArray) -> NDArray[np.bool_]:
        return np.asarray((x[:, 2] > 20.0) & (x[:, 2] < 120.0))


@pytest.mark.slow
def test_a_hoop_between_plates() -> None:
    """Of a hoop of threads, pressed to h: a stadium of width b, flat over b - h; force P (b - h).

    The wall's own bending adds a force that does not depend on the pressure.
    """
    gauze = Gauze(stiffness=400.0, slack=0.0)
    tube = Actuator(140.0, (), diameter=20.0, wall=0.8, gauze=gauze)
    free = solve(tube, [0.05, 0.1], MeshSize(around=12, beside=0.0, edge=4.0))
    run = solve_against(free, Plates(9.0), [0.05, 0.1])
    assert run.failure is None
    middle = free.mesh.layers // 2
    force = []
    for touch in run.touches:
        push = (touch.pressed.area * touch.pressed.pressure).sum(axis=(1, 2))
        force.append(push[middle] / free.mesh.heights[middle])  # half a tube, two plates
    width = 2.0 * np.abs(run.states[-1].x[middle, :, 0]).max()
    assert (force[1] - force[0]) / 0.05 == pytest.approx(width - 18.0, rel=0.02)
    assert force[1] == pytest.approx(0.1 * (width - 18.0), rel=0.05)


def test_asked_pressures_must_be_pressures(free: Solution) -> None:
    bad: Sequence[Sequence[float]] = ([], [0.0], [-0.1], [np.nan])
    for pressures in bad:
        with pytest.raises(ValueError, match="above 0"):
            solve_against(free, FLOOR, pressures)
