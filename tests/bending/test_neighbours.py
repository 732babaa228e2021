"""What neighbours do to a joint: nothing from afar, the same on both sides, whoever is beside."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from profiletool.bending.model import Chain, centers_of
from profiletool.bending.neighbours import PLUG_MM, Neighbours, batch, first_guess, log_factors
from profiletool.bending.response import Response

PRESSURE = 0.15


def chain(gap: float, *senses: float) -> Chain:
    """Joints of 10 mm and 120 deg, ``gap`` mm apart and from both ends."""
    n = len(senses)
    centre = gap + 5.0 + (gap + 10.0) * np.arange(n)
    length = centre[-1] + 5.0 + gap + PLUG_MM
    center = centers_of(np.array(senses))
    return Chain(centre, np.full(n, 10.0), np.full(n, np.radians(120.0)), center, length)


@pytest.fixture(scope="module", params=["guess", "fitted"])
def modes(request: pytest.FixtureRequest) -> np.ndarray:
    return first_guess() if request.param == "guess" else Response.load().table.neighbours.modes


def test_a_joint_far_from_all_is_as_if_alone(modes: np.ndarray) -> None:
    near, far = (Neighbours(modes).log_factors(chain(gap, 1.0, 1.0), PRESSURE) for gap in (5, 900))
    assert np.abs(far).max() < 2e-3
    assert np.abs(near).max() > 5.0 * np.abs(far).max()


def test_turning_all_joints_to_the_other_side_changes_nothing(modes: np.ndarray) -> None:
    one, other = (
        Neighbours(modes).log_factors(chain(8.0, *(side * np.array([1.0, -1.0, 1.0]))), PRESSURE)
        for side in (1.0, -1.0)
    )
    np.testing.assert_allclose(one, other, atol=1e-12)
    alike = Neighbours(modes).log_factors(chain(8.0, 1.0, 1.0, 1.0), PRESSURE)
    assert np.abs(alike - one).max() > 1e-3  # but which side a neighbour bends to does


def test_a_chain_turned_end_for_end_is_the_same_chain(modes: np.ndarray) -> None:
    some = chain(9.0, 1.0, -1.0, 1.0)
    shifted = replace(some, centre=some.centre - [5.0, 2.0, 0.0])
    turned = replace(
        shifted,
        centre=(shifted.length - PLUG_MM - shifted.centre)[::-1],
        alpha_center=shifted.alpha_center[::-1],
    )
    one, other = (Neighbours(modes).log_factors(c, PRESSURE) for c in (shifted, turned))
    np.testing.assert_allclose(one, other[::-1], atol=1e-10)
    assert np.abs(one - one[::-1]).max() > 1e-3


def test_ends_alike_see_the_chain_from_both_sides(modes: np.ndarray) -> None:
    """The clamped end and the plug hold alike."""
    factors = Neighbours(modes).log_factors(chain(9.0, 1.0, -1.0, 1.0), PRESSURE)
    np.testing.assert_allclose(factors, factors[::-1], atol=1e-10)


def test_a_chain_in_a_batch_is_the_chain_alone(modes: np.ndarray) -> None:
    chains = [chain(8.0, 1.0), chain(6.0, 1.0, -1.0, 1.0), chain(12.0, -1.0, -1.0)]
    pressures = [0.1, 0.15, 0.19]
    together = log_factors(modes, batch(chains, pressures))
    for row, one, pressure in zip(together, chains, pressures, strict=True):
        alone = Neighbours(modes).log_factors(one, pressure)
        np.testing.assert_allclose(row[: len(alone)], alone, atol=1e-10)


def test_without_modes_there_is_no_influence(modes: np.ndarray) -> None:
    some = chain(5.0, 1.0, 1.0)
    np.testing.assert_array_equal(Neighbours(modes).none().log_factors(some, PRESSURE), 0.0)
    nobody = replace(some, centre=some.centre[:0], openF=some.openF[:0], alpha=some.alpha[:0])
    assert Neighbours(modes).none().log_factors(nobody, PRESSURE).shape == (0, 2)
