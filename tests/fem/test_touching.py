"""Tubes that run into themselves, and others that nearly do, against another way of telling."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from fem.actuator import Actuator, Window
from fem.mesh import make_mesh
from fem.meshsize import MeshSize
from fem.sections import rotation_matrix
from fem.touching import outer_rings, overlap
from tests.fem.winding import Arc, depth_by_sections, wound

SURE_MM = 0.1  # surfaces are facets here and there
HAIRPIN = (Arc(40.0, 0.0), Arc(12.0 * np.pi, np.pi), Arc(35.0, 0.0))


def rings(arcs, radius, around=40):
    length = sum(arc.length for arc in arcs)
    places = np.linspace(0.0, length, int(np.ceil(8.0 * length / radius)) + 1)
    return wound(arcs, places).surface(radius, around)


def random_tube(seed):
    """Arcs and a radius: every other tube in space, every other one near to its threshold."""
    rng = np.random.default_rng(seed)
    radius = rng.uniform(4.0, 12.0)
    arcs = []
    for _ in range(rng.integers(3, 6)):
        length = rng.uniform(4.0, 9.0) * radius
        turn = min(rng.uniform(0.6, 1.0) * length / (1.8 * radius), 4.0)
        axis = rng.uniform(0.0, 2.0 * np.pi) if seed % 2 else rng.choice([0.0, 0.0, np.pi])
        arcs.append(Arc(length, turn, axis))
    return tuple(arcs), radius, rng


def check(arcs, radius):
    truth = depth_by_sections(arcs, radius)
    if abs(truth) > SURE_MM:
        assert (overlap(rings(arcs, radius)) > 0.0) == (truth > 0.0), truth
    return truth


def check_random(seed):
    """Check a random tube, then thicker ones until it touches, or does not quite."""
    arcs, radius, rng = random_tube(seed)
    tightest = min(arc.length / abs(arc.turn) for arc in arcs)
    found = [check(arcs, radius)]
    while found[-1] < -0.5 and len(found) < 5:
        radius += -0.5 * found[-1] + rng.choice([-0.1, 0.1])
        if radius > 0.95 * tightest:
            break
        found.append(check(arcs, radius))
    return found


def test_random_tubes():
    found = [truth for seed in (1, 3) for truth in check_random(seed)]
    assert min(found) < -SURE_MM < SURE_MM < max(found)


@pytest.mark.slow
def test_forty_random_tubes_and_their_nearest_misses():
    found = [truth for seed in range(40) for truth in check_random(seed)]
    assert sum(truth > SURE_MM for truth in found) > 20
    assert sum(truth < -SURE_MM for truth in found) > 20
    assert sum(SURE_MM < abs(truth) < 0.5 for truth in found) > 5


@pytest.mark.parametrize("gap", [-3.0, -0.4, -0.1, 0.1, 0.4])
def test_turns_of_a_helix(gap):
    # Turns lie 2 pi R sin(slope) apart where they are nearest: cos(slope) times the pitch.
    radius, about = 10.0, 25.0
    slope = np.arcsin((2.0 * radius + gap) / (2.0 * np.pi * about))
    turn = np.linspace(0.0, 4.4 * np.pi, 220)[:, None, None]
    out = np.concatenate([np.cos(turn), np.sin(turn), 0.0 * turn], axis=2)
    side = np.concatenate([-np.sin(turn), np.cos(turn), 0.0 * turn], axis=2)
    up = np.array([0.0, 0.0, 1.0])
    across = np.cos(slope) * up - np.sin(slope) * side
    centre = about * out + about * np.tan(slope) * turn * up
    phi = np.linspace(0.0, 2.0 * np.pi, 48, endpoint=False)[:, None]
    found = overlap(centre + radius * (np.cos(phi) * out + np.sin(phi) * across))
    assert found == pytest.approx(max(0.0, -gap), abs=0.06)
    assert (found > 0.0) == (gap < 0.0)


@pytest.mark.parametrize(("gap", "depth"), [(0.2, 0.0), (-0.2, 0.2), (-2.0, 2.0)])
def test_a_closed_end_that_runs_into_a_wall(gap, depth):
    """Three quarters of a turn, and the end's flat face before the straight root."""
    bend, radius = 30.0, 10.0
    turned = Arc(1.5 * np.pi * bend, 1.5 * np.pi)
    end = Arc(bend - radius - gap, 0.0)
    found = overlap(rings((Arc(60.0, 0.0), turned, end), radius))
    assert found == pytest.approx(depth, abs=0.05)


@settings(max_examples=15, deadline=None)
@given(
    st.lists(st.floats(-1.0, 1.0), min_size=6, max_size=6),
    st.sampled_from([HAIRPIN, (*HAIRPIN[:2], replace(HAIRPIN[2], turn=0.8))]),
    st.booleans(),
    st.floats(0.3, 3.0),
)
def test_where_a_tube_lies_how_large_it_is_and_its_hand_do_not_matter(numbers, arcs, mirror, scale):
    tube = rings(arcs, 8.0)
    moved = scale * (
        tube @ rotation_matrix(np.array(numbers[:3]) * np.pi) + 50.0 * np.array(numbers[3:])
    )
    if mirror:
        moved = moved * [1.0, -1.0, 1.0]
    assert overlap(moved) == pytest.approx(scale * overlap(tube), abs=0.02)
    assert overlap(moved[::-1]) == pytest.approx(scale * overlap(tube), abs=0.02)


@settings(max_examples=12, deadline=None)
@given(
    st.lists(
        st.tuples(st.floats(10.0, 30.0), st.floats(0.0, 1.0), st.floats(0.0, 6.28)),
        min_size=2,
        max_size=4,
    ),
    st.floats(3.0, 6.0),
)
def test_any_chain_of_arcs(rows, radius):
    arcs = tuple(Arc(length, share * length / (1.3 * radius), axis) for length, share, axis in rows)
    truth = depth_by_sections(arcs, radius)
    assume(abs(truth) > SURE_MM)
    assert (overlap(rings(arcs, radius)) > 0.0) == (truth > 0.0)


@pytest.mark.parametrize("center", [270.0, 200.0])
@pytest.mark.parametrize(("bend", "meets"), [(10.4, False), (9.7, True)])
def test_a_mesh_is_read_whole(center, bend, meets):
    """A hairpin whose legs lie 2 bends apart; in half of the tube, and in all of it."""
    arcs = (Arc(35.0, 0.0), Arc(np.pi * bend, np.pi), Arc(40.0, 0.0))
    length = sum(arc.length for arc in arcs)
    actuator = Actuator(length, (Window(50.0, 8.0, 2.0, np.radians(center)),))
    mesh = make_mesh(actuator, MeshSize(beside=0.0, wrapped=2.0))
    z = mesh.X[..., 2]
    curve = wound(arcs, z.ravel())
    x = curve.centre + np.einsum(
        "nij,nj->ni", curve.rotation, mesh.X.reshape(-1, 3) * [1.0, 1.0, 0.0]
    )
    seen = outer_rings(mesh, x.reshape(mesh.X.shape))
    assert mesh.half == (center == 270.0)
    places = np.append(np.linspace(0.0, length - 1.0, len(seen) - 1), length)
    away = np.linalg.norm(seen - wound(arcs, places).centre[:, None], axis=2)
    np.testing.assert_allclose(away, 10.0, atol=0.03)
    assert (overlap(seen) > 0.0) == meets
