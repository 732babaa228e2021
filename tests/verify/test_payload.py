"""Payload of fingers around an object, against closed forms."""

from __future__ import annotations

import numpy as np
import pytest

from profiletool.records.grip import Pad
from profiletool.records.units import FloatArray
from profiletool.verify.payload import around, least_tilt, most_load, payload_of

N = 2.3


def pressing(*latitudes_deg: float, radius: float = 30.0) -> tuple[FloatArray, FloatArray]:
    """Points of a finger at -x on a ball, pressing with N each, below its equator."""
    lat = np.radians(latitudes_deg)
    normal = np.stack([-np.cos(lat), -np.sin(lat), np.zeros_like(lat)], axis=1)
    return radius * normal, -N * normal


@pytest.mark.parametrize("fingers", [2, 3, 5])
@pytest.mark.parametrize("mu", [0.0, 0.3, 1.0])
def test_closed_forms(fingers: int, mu: float) -> None:
    upright = around(*pressing(0.0), fingers)
    assert most_load(*upright, mu) == pytest.approx(fingers * mu * N, abs=1e-9)
    lat = np.radians(25.0)
    below = around(*pressing(25.0), fingers)
    carried = fingers * N * (np.sin(lat) + mu * np.cos(lat))  # of a cone, and of a ball at mu = 0
    assert most_load(*below, mu) == pytest.approx(carried, abs=1e-9)
    both = around(*pressing(25.0, -10.0), fingers)
    carried += fingers * N * (-np.sin(np.radians(10.0)) + mu * np.cos(np.radians(10.0)))
    assert most_load(*both, mu) == pytest.approx(carried, abs=1e-9)


def test_what_is_pushed_out_carries_nothing() -> None:
    above = around(*pressing(-30.0), 3)
    assert most_load(*above, 0.5) == 0.0
    assert most_load(*above, 0.8) > 0.0  # beyond tan 30 deg


def test_a_finger_alone_pushes_the_object_away() -> None:
    assert most_load(*around(*pressing(0.0), 1), 0.9) == 0.0


def test_tilting_is_borne_by_friction_across_the_grip() -> None:
    # Four fingers: the two off the axis bear mu N R each, tangentially up and down.
    assert least_tilt(*around(*pressing(0.0, radius=10.0), 4), 0.5) == pytest.approx(
        2.0 * 0.5 * N * 10.0, rel=1e-6
    )
    # Two fingers bear nothing about the axis through both.
    assert least_tilt(*around(*pressing(0.0), 2), 0.5) == pytest.approx(0.0, abs=1e-9)


def test_many_points_count_as_patches() -> None:
    rng = np.random.default_rng(2)
    points, force = pressing(*rng.uniform(5.0, 40.0, 300))
    pad = Pad(points, force / 300.0, np.ones(300))
    found = payload_of(pad, 3, (0.0, 0.5), 1.2)
    assert found is not None
    lat = np.arcsin(-points[:, 1] / 30.0)
    exact = [3.0 * N * float(np.mean(np.sin(lat) + mu * np.cos(lat))) for mu in (0.0, 0.5)]
    np.testing.assert_allclose(found.load_N, exact, rtol=2e-3)
    assert found.undercut_N == pytest.approx(exact[0], rel=2e-3)
    assert payload_of(Pad(points, 0.0 * force, np.zeros(300)), 3, (0.5,), 1.2) is None
