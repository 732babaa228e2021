"""Contact with obstacles: gaps, forces, tangent, and what closed forms say."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import quad

from fem import blas
from fem.actuator import chain
from fem.assembly import System
from fem.contact import Contact, pressed_of
from fem.gap import Cylinder, Obstacle, Plane, Sphere
from fem.gauze import Gauze
from fem.material import MooneyRivlin
from fem.meshsize import MeshSize
from fem.outline import Extruded, Outline, Revolved
from fem.solver import solve
from tests.fem.test_tangent import CASES, SOFT, differences, factored, turning
from tests.fem.tubes import COARSE, bent, mesh_of, shifted

FloatArray = NDArray[np.float64]
RADIUS = 20.0


@pytest.fixture
def _one_thread() -> Iterator[None]:
    with blas.one_thread():
        yield


def arc(first: float, last: float) -> FloatArray:
    """Circle of 20 mm about (30, -25) in (u, v), clockwise: its body is on the right."""
    phi = np.linspace(first, last, 4001)
    return np.column_stack([30.0 + RADIUS * np.cos(phi), -25.0 + RADIUS * np.sin(phi)])


def near_a_sphere(flat: bool) -> FloatArray:
    rng = np.random.default_rng(1)
    way = rng.normal(size=(300, 3))
    way /= np.linalg.norm(way[:, 1:] if flat else way, axis=1)[:, None]
    way = way[np.hypot(way[:, 0], way[:, 1]) > 0.2]
    return np.array([0.0, -25.0, 30.0]) + way * (RADIUS + rng.uniform(-0.5, 0.5, (len(way), 1)))


@pytest.mark.parametrize("turned", [False, True])
def test_an_outline_of_arcs_is_a_cylinder_or_a_ball(turned: bool) -> None:
    centre = np.array([0.0, -25.0, 30.0])
    x = near_a_sphere(not turned)
    known: Obstacle
    made: Obstacle
    if turned:
        known = Sphere(centre, RADIUS)
        half = Outline(arc(np.pi, 0.0), smooth_mm=0.0)
        axis, out = np.array([1.0, 0.0]), np.array([0.0, 1.0])
        made = Revolved(half, np.array([0.0, -25.0]), axis, out)
    else:
        known = Cylinder(centre, np.array([1.0, 0.0, 0.0]), RADIUS)
        made = Extruded(Outline(arc(0.0, -2.0 * np.pi), closed=True, smooth_mm=0.0))
    a, b = made.gap(x), known.gap(x)
    np.testing.assert_allclose(a.distance, b.distance, atol=2e-4)
    np.testing.assert_allclose(a.normal, b.normal, atol=2e-3)
    np.testing.assert_allclose(a.bend, b.bend, atol=5e-3)


def test_normal_and_bend_are_derivatives_of_the_distance() -> None:
    u = np.linspace(0.0, 60.0, 601)
    outline = Outline(np.column_stack([u, -22.0 + 4.0 * np.sin(u / 8.0)]))
    rng = np.random.default_rng(3)
    along = rng.uniform(5.0, 55.0, 100)
    x = np.column_stack([
        rng.uniform(-4.0, 4.0, 100), -22.0 + 4.0 * np.sin(along / 8.0), along,
    ])  # fmt: skip
    for obstacle in (
        Extruded(outline),
        Revolved(outline, np.array([0.0, -60.0]), np.array([1.0, 0.0]), np.array([0.0, 1.0])),
    ):
        gap, h = obstacle.gap(x), 1e-4
        for k in range(3):
            step = h * np.eye(3)[k]
            high, low = obstacle.gap(x + step), obstacle.gap(x - step)
            slope = (high.distance - low.distance) / (2.0 * h)
            np.testing.assert_allclose(gap.normal[:, k], slope, atol=1e-5)
            slope = (high.normal - low.normal) / (2.0 * h)
            np.testing.assert_allclose(gap.bend[:, :, k], slope, atol=1e-4)


def below(angle: float) -> Contact:
    """Contact of a bent tube with a slanted plane under its free half; a wide ramp is smooth."""
    normal = np.array([0.0, np.cos(angle), np.sin(angle)])
    return Contact(Plane(np.array([0.0, -11.0, 18.0]), normal), penalty=0.05, ramp=3.0)


@pytest.mark.usefixtures("_one_thread")
@pytest.mark.parametrize(("center", "size"), CASES)
def test_contact_is_in_the_tangent(center: float, size: MeshSize) -> None:
    ball = Contact(Sphere(np.array([0.0, -19.0, 12.0]), 11.0), penalty=2.0, ramp=3.0)
    system = System(mesh_of(center, size, SOFT), 1, [ball])
    pose = bent(system, 6)
    inverse = factored(system, pose)
    values = np.random.default_rng(12).uniform(-1.0, 1.0, system.unknowns.count)
    slope = differences(system, pose, values, 1e-5)
    slope -= turning(system, pose, values, 0.15)
    np.testing.assert_allclose(inverse.solve(slope), values, rtol=0.0, atol=1e-6)
    plain = System(mesh_of(center, size, SOFT), 1)
    without = differences(plain, pose, values, 1e-5)
    assert np.linalg.norm(without - slope) > 1e-4 * np.linalg.norm(slope)


@pytest.mark.usefixtures("_one_thread")
def test_forces_are_the_gradient_of_the_energy() -> None:
    system = System(mesh_of(270.0, COARSE), 1, [below(0.2)])
    pose, h = bent(system, 24), 1e-6
    internal = system.forces(pose.x).internal
    for way in np.random.default_rng(4).uniform(-1.0, 1.0, (3, len(internal))):
        high, low = (system.forces(shifted(system, pose, s * h * way)).energy for s in (1.0, -1.0))
        assert (high - low) / (2.0 * h) == pytest.approx(float(internal @ way), rel=1e-6)


@pytest.mark.slow
def test_a_tube_in_a_sleeve_passes_on_what_it_does_not_bear_itself() -> None:
    """A thick tube of Mooney-Rivlin, no gauze to speak of, in a sleeve with a gap.

    The wall bears the integral of (sigma_theta - sigma_r) / r, which its axial stretch and the
    sleeve's radius give in closed form; the sleeve bears the rest.
    """
    A, B, gap, C10, C01 = 7.0, 10.0, 0.4, 0.0694, 0.0628
    tube = chain(
        60.0, [30.0], [2.0], [np.radians(300.0)], wall=B - A, gauze=Gauze(stiffness=1e-4),
        rubber=MooneyRivlin(C10, C01, 60.0),
    )  # fmt: skip
    sleeve = Contact(Cylinder(np.zeros(3), np.array([0.0, 0.0, 1.0]), B + gap, inside=True))
    size = MeshSize(around=8, beside=0.0, wrapped=5.0, edge=2.0)
    run = solve(tube, [0.05], size, extra=[sleeve])
    assert run.converged
    z, x = run.mesh.z, run.states[-1].x
    pressed = pressed_of(sleeve, run.mesh, x)
    inside = np.flatnonzero((z > 15.0) & (z < 27.0))
    first, last = inside[0], inside[-1]
    height = x[:, : run.mesh.ring, 2].mean(axis=1)
    lz = (height[last] - height[first]) / (z[last] - z[first])
    b = B + gap

    def shear(R: float) -> float:
        r = np.sqrt(b**2 - (B**2 - R**2) / lz)
        theta, radial = r / R, R / (r * lz)
        stress = 2.0 * C10 * (theta**2 - radial**2) + 2.0 * C01 * (radial**-2 - theta**-2)
        return float(stress / r * R / (r * lz))

    borne = quad(shear, A, B)[0]
    layers = slice(first, last)
    mean = float((pressed.pressure * pressed.area)[layers].sum() / pressed.area[layers].sum()) / (
        lz * b / B
    )  # over the area in contact
    assert borne > 0.01
    assert mean == pytest.approx(0.05 - borne, rel=0.02)
    assert run.states[-1].energy_error < 1e-3


@pytest.mark.slow
def test_a_multiplier_takes_the_depth_away() -> None:
    joint = chain(12.0, [26.0], [8.0], [np.radians(90.0)])
    contact = Contact(Plane(np.array([0.0, -10.5, 0.0]), np.array([0.0, 1.0, 0.0])), penalty=3.0)
    depths, forces = [], []
    for _ in range(3):
        run = solve(joint, [0.06], COARSE, extra=[contact])
        pressed = pressed_of(contact, run.mesh, run.states[-1].x)
        forces.append(float(pressed.force[..., 1].sum()))
        depths.append(pressed.depth)
        contact.update(pressed)
    assert depths[0] > 0.01
    assert depths[-1] < 0.35 * depths[0]
    assert forces[-1] == pytest.approx(forces[0], rel=0.05)
    assert forces[0] < 0.0
