"""Contact of belts, beams and rings: what closed forms say of their forces and places."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from fem.actuator import Actuator
from fem.contact import Contact
from fem.gap import Cylinder
from fem.items import ThreadFamily
from fem.material import MooneyRivlin
from fem.mesh import make_mesh
from fem.meshsize import MeshSize
from tests.fem.strips import STEEL, WIDE, Bench, stiffness_in_plane, strip
from tests.fem.test_against import Slot

FloatArray = NDArray[np.float64]
DRUM, PULL = 20.0, 4.0  # mm, N
ACROSS = np.array([1.0, 0.0, 0.0])


def belt_on_a_drum(friction: float) -> tuple[Bench, Contact, FloatArray]:
    """Lay a belt over a quarter of a drum; give its first state.

    The pull is in threads on the face that lies on the drum. The belt comes in level, and hangs
    down behind the drum.
    """
    radius, tail = DRUM, 6.0
    arc = 0.5 * np.pi * radius
    soft = MooneyRivlin.from_poisson(0.5, 0.0, 0.3)
    mesh = strip(arc + 2.0 * tail, 0.5, 1.0, soft, threads=4000.0)
    drum = Contact(Cylinder(np.array([0.0, -radius, 0.0]), ACROSS, radius), friction=friction)
    held = np.zeros(mesh.X.shape, dtype=bool)
    held[..., 0] = True
    held[-1, mesh.outer_ring, 2] = True
    bench = Bench(mesh, [lambda m: ThreadFamily(m, m.axial), drum], held)
    x = mesh.X.copy()
    along, up = mesh.X[..., 2] - tail - arc, mesh.X[..., 1]
    turn = np.clip(-along / radius, 0.0, 0.5 * np.pi)
    x[..., 1] = (radius + up) * np.cos(turn) - radius
    x[..., 2] = np.maximum(along, 0.0) - (radius + up) * np.sin(turn)
    x[..., 1] -= np.maximum(-along - arc, 0.0)
    x[-1, mesh.ring :] = 0.0
    edge = mesh.X[0, mesh.outer_ring, 0]
    share = np.where(np.abs(edge) < 0.1 * WIDE, 4.0, 1.0) / 6.0
    bench.load[0, mesh.outer_ring, 1] = -PULL * share
    return bench, drum, x


def test_a_belt_presses_on_a_drum_with_its_pull_over_the_radius() -> None:
    bench, drum, x = belt_on_a_drum(0.0)
    pressed = bench.settled(x, drum)
    per_length = (pressed.area * pressed.pressure).sum(axis=(1, 2)) / bench.mesh.heights
    np.testing.assert_allclose(per_length[12:-12], PULL / DRUM, rtol=0.002)
    assert bench.reactions(x)[-1, :, 2].sum() == pytest.approx(PULL, rel=1e-3)


@pytest.mark.slow
def test_a_belt_that_slips_is_held_by_the_capstan_rule() -> None:
    friction = 0.4
    bench, drum, x = belt_on_a_drum(friction)
    x = bench.find(x)
    drum.take_hold(bench.mesh, x)
    for _ in range(3):
        x[-1, bench.mesh.outer_ring, 2] += 0.06
        x = bench.find(x)
        for _ in range(2):
            drum.take_hold(bench.mesh, x, slip=False)
            x = bench.find(x)
        drum.take_hold(bench.mesh, x)
    pull = bench.reactions(x)[-1, :, 2].sum()
    assert pull == pytest.approx(PULL * np.exp(friction * 0.5 * np.pi), rel=0.02)


@pytest.mark.slow
def test_a_cantilever_lifts_off_a_circle_where_its_moment_is_that_of_the_curve() -> None:
    """The moment is E I / R all along the circle, so nearly all of the force acts at its end."""
    radius, length, thick, arm = 100.0, 30.0, 1.0, 12.0
    mesh = strip(length, thick, 0.5, STEEL, threads=1.0)
    circle = Contact(
        Cylinder(np.array([0.0, -radius, 0.0]), ACROSS, radius), penalty=3000.0, ramp=5e-4
    )
    held = np.zeros(mesh.X.shape, dtype=bool)
    held[..., 0] = True
    held[0, : mesh.ring] = True
    bench = Bench(mesh, [circle], held)
    middle = radius + 0.5 * thick
    force = stiffness_in_plane(STEEL) * WIDE * thick**3 / 12.0 / (middle * arm)
    x = mesh.X.copy()
    for share in (0.3, 0.6, 1.0):
        bench.load[-1, : mesh.ring, 1] = -share * force / mesh.ring
        pressed = bench.settled(x, circle)
    push = (pressed.area * pressed.pressure)[mesh.z[:-1] > 0.4 * length]
    z = pressed.points[mesh.z[:-1] > 0.4 * length, ..., 2]
    off = middle / radius * float((push * z).sum() / push.sum())  # of the beam's middle line
    tip = float(x[-1, : mesh.ring, 2].mean())
    assert tip - off == pytest.approx(arm, rel=0.01)


def test_a_thin_ring_between_plates_gives_way_by_its_bending() -> None:
    """By 0.1488 F R^3 / (E' I); half of it, at x > 0, is modelled."""
    outer, thick, wide, pinch = 10.0, 0.4, 4.0, 0.1
    tube = Actuator(wide, (), wall=thick, plug=0.0, rubber=STEEL)
    mesh = make_mesh(tube, MeshSize(around=24, beside=0.0, wrapped=2.0, end=2.0, edge=2.0))
    plates = Contact(Slot(outer - 0.5 * pinch))
    held = np.zeros(mesh.X.shape, dtype=bool)
    held[:, : mesh.ring], held[:, mesh.ring :] = mesh.fixed_ring, mesh.fixed_mid
    held[..., 2] = True
    x = mesh.X.copy()
    pressed = Bench(mesh, [plates], held).settled(x, plates)
    force = float((pressed.area * pressed.pressure).sum())  # half a ring, two plates
    bending = stiffness_in_plane(STEEL) * wide * thick**3 / 12.0
    wanted = 0.1488 * force * (outer - 0.5 * thick) ** 3 / bending
    assert 2.0 * outer - np.ptp(x[..., 1]) == pytest.approx(wanted, rel=0.02)
