"""Closest points and signed distances: closed forms, and derivatives by Taylor remainders."""

from __future__ import annotations

import numpy as np
import pytest

from profiletool.joints.closest import closest_points, distance_jacobian, target_points
from profiletool.profile.target import Reach, profile_of_line
from profiletool.records.units import FloatArray


def test_closest_points_of_a_straight_line() -> None:
    line = np.column_stack([np.linspace(0.0, 10.0, 11), np.zeros(11)])
    points = np.array([[2.25, 1.0], [3.0, -0.5], [4.4, 0.0], [13.0, 4.0], [-3.0, -4.0]])
    closest = closest_points(line, points, 1.0)  # the object to the left, above the line
    assert closest.distance == pytest.approx([1.0, -0.5, 0.0, 5.0, 5.0])
    assert closest.at(line)[:, 0] == pytest.approx([2.25, 3.0, 4.4, 10.0, 0.0])
    assert closest.normal[:3] == pytest.approx(np.array([[0.0, -1.0]] * 3))
    assert closest_points(line, points, -1.0).distance[:2] == pytest.approx([-1.0, 0.5])


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_distances_to_a_circle(sign: float) -> None:
    angle = sign * np.linspace(0.0, 1.5, 400)
    line = 30.0 * np.column_stack([np.cos(angle), np.sin(angle)])
    seen = sign * np.array([0.2, 0.7, 1.3])
    at, radius = np.column_stack([np.cos(seen), np.sin(seen)]), np.array([[31.5], [30.0], [28.0]])
    closest = closest_points(line, radius * at, sign)  # the object lies inside the circle
    # Chords of 0.11 mm run 5e-5 mm inside the arc.
    assert closest.distance == pytest.approx(30.0 - radius[:, 0], abs=1e-4)


def remainders(sign: float, kind: str) -> FloatArray:
    """What first order leaves of the change of distances, at steps that are halved: (5, M)."""
    rng = np.random.default_rng(3)
    s = np.linspace(0.0, 40.0, 9)  # long straight steps: no closest point leaves its own
    line = np.column_stack([s, 0.01 * s**2])
    normal = np.column_stack([-0.02 * s, np.ones(len(s))]) / np.hypot(1.0, 0.02 * s)[:, None]
    middles = 0.5 * (line[1:] + line[:-1]) + rng.uniform(-1.5, 1.5, (8, 1)) * normal[1:]
    beyond = line[-1:] + np.array([[4.0, 1.0]])
    points = {"steps": middles, "end": beyond}[kind]
    motion = rng.normal(size=(3, *line.shape))
    direction = rng.normal(size=3)
    base = closest_points(line, points, sign)
    slope = distance_jacobian(base, motion) @ direction
    left = []
    for h in 0.2 * 0.5 ** np.arange(5):
        moved = line + h * np.einsum("q,qnk->nk", direction, motion)
        left.append(closest_points(moved, points, sign).distance - base.distance - h * slope)
    return np.abs(left)


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("kind", ["steps", "end"])
def test_the_jacobian_leaves_remainders_of_second_order(sign: float, kind: str) -> None:
    left = np.linalg.norm(remainders(sign, kind), axis=1)
    assert left[0] > 1e-3  # the distances are not linear
    assert np.log2(left[:-1] / left[1:]) == pytest.approx(2.0, abs=0.15)


def test_target_points_keep_both_ends() -> None:
    profile = profile_of_line(np.array([[0.0, 0.0], [0.0, -60.0]]), Reach("left", 10.0))
    points = target_points(profile)
    assert points[[0, -1]] == pytest.approx(profile.points[[0, -1]])
    assert len(points) == round(profile.length_mm / 0.5) + 1
