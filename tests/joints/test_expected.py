"""Expected errors in the choice of joints: against whole shapes, and the rows' derivatives."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from profiletool.bending.model import Chain, centers_of
from profiletool.bending.response import Response
from profiletool.joints.bounds import Limits
from profiletool.joints.closest import ClosestPoints, closest_points
from profiletool.joints.correction.parameters import Parameters, PosedChain
from profiletool.joints.expected import (
    BUILT_WEIGHT,
    ErrorSizes,
    Expected,
    angle_variance,
    error_sizes,
    levers,
    slopes_of,
)
from profiletool.records.built import BuildErrors
from profiletool.records.frames import Pose, Shape
from profiletool.records.request import TubeSpec
from profiletool.records.units import FloatArray

MODEL = Response.load()
CHAIN = Chain(
    np.array([15.0, 75.0]), np.array([10.0, 8.0]), np.radians([130.0, 110.0]),
    centers_of(np.array([1.0, -1.0])), 170.0,
)  # fmt: skip
POSED = PosedChain(CHAIN, 0.14, Pose(0.0, 0.0, -90.0))
NOTHING = BuildErrors(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


def bent(posed: PosedChain = POSED) -> Shape:
    return MODEL.shape(posed.chain, posed.pressure, posed.pose, 1.0)


def closest_to_itself(shape: Shape) -> ClosestPoints:
    return closest_points(shape.facing, shape.facing[4:-4:3], 1.0)


def off(posed: PosedChain) -> FloatArray:
    """Distances of a changed actuator's line from points of the one that is not."""
    return closest_points(bent(posed).facing, bent().facing[4:-4:3], 1.0).distance


def with_alpha(k: int, by: float) -> PosedChain:
    alpha = CHAIN.alpha.copy()
    alpha[k] += by
    return replace(POSED, chain=replace(CHAIN, alpha=alpha))


def test_slopes_are_those_of_the_response() -> None:
    by_openF, by_alpha, by_pressure = MODEL.theta_slopes(CHAIN.openF, CHAIN.alpha, 0.14)
    found = slopes_of(MODEL, CHAIN.openF, CHAIN.alpha, 0.14)
    assert found.alpha == pytest.approx(by_alpha, rel=1e-3)
    assert found.openF == pytest.approx(by_openF, rel=1e-3)
    assert found.pressure == pytest.approx(by_pressure, rel=1e-3)


def test_at_the_models_bounds_slopes_are_one_sided() -> None:
    low, high = MODEL.alpha
    found = slopes_of(MODEL, MODEL.openF[1], np.array([low, high]), MODEL.pressure[1])
    assert np.isfinite([found.alpha, found.openF, found.pressure]).all()
    assert np.all(found.pressure > 0.0)


@pytest.mark.parametrize("k", [0, 1])
def test_a_lever_is_the_motion_by_a_joints_angle(k: int) -> None:
    """A sector 0.01 rad wider, and the whole tube bent again."""
    shape = bent()
    arms = levers(POSED, shape, closest_to_itself(shape))[k]
    slope = CHAIN.sense[k] * slopes_of(MODEL, CHAIN.openF, CHAIN.alpha, 0.14).alpha[k]
    moved = off(with_alpha(k, 0.01)) - off(POSED)
    predicted = 0.01 * slope * arms
    # A joint bends along its cut, not in a point, and its neighbour feels it a little.
    assert np.linalg.norm(moved) > 0.02
    assert np.linalg.norm(moved - predicted) < 0.15 * np.linalg.norm(moved)


def test_a_sector_that_the_angle_hardly_depends_on_costs_little() -> None:
    sizes = ErrorSizes(alpha=0.1, openF=0.0, pressure=0.0)
    steep, flat = (
        angle_variance(slopes_of(MODEL, 10.0, np.radians(alpha), 0.16), sizes)
        for alpha in (150.0, 88.0)
    )
    assert flat < 0.05 * steep


def test_rows_add_to_the_expected_square_and_differentiate_it() -> None:
    limits = Limits(MODEL.alpha, (0.02, 0.2), 2.0, 4.0, 10.0, 250.0)
    numbers = Parameters(CHAIN.openF, CHAIN.alpha_center, 91.0, (0.0, 0.0), -np.pi / 2, 1.0, limits)
    vector = numbers.pack(POSED)
    sizes = error_sizes(BuildErrors(), TubeSpec())
    assert sizes is not None
    expected, shape = Expected(MODEL, sizes), bent()
    closest = closest_to_itself(shape)
    rows = expected.rows(numbers, vector, shape, closest)
    rms = expected.rms_mm(POSED, shape, closest)
    assert rows.cost == pytest.approx(BUILT_WEIGHT * rms**2)
    assert rms > 0.3
    for k in (0, 1, 4):  # both sectors and the pressure; the levers held
        step = 1e-3 * numbers.scale()[k]
        ahead, behind = (
            expected.rows(numbers, vector + sign * step * np.eye(5)[k], shape, closest).values
            for sign in (1.0, -1.0)
        )
        slope = (ahead - behind) / (2.0 * step)
        assert rows.jacobian[:, k] == pytest.approx(slope, rel=0.05, abs=1e-3 * np.abs(slope).max())


def test_sectors_off_together_are_one_row() -> None:
    sizes = ErrorSizes(alpha=0.1, openF=0.0, pressure=0.0)
    shape = bent()
    closest = closest_to_itself(shape)
    limits = Limits(MODEL.alpha, (0.02, 0.2), 2.0, 4.0, 10.0, 250.0)
    numbers = Parameters(CHAIN.openF, CHAIN.alpha_center, 91.0, (0.0, 0.0), -np.pi / 2, 1.0, limits)
    rows = Expected(MODEL, sizes, 1.0).rows(numbers, numbers.pack(POSED), shape, closest)
    slopes = CHAIN.sense * slopes_of(MODEL, CHAIN.openF, CHAIN.alpha, 0.14).alpha
    moved = 0.1 * slopes @ levers(POSED, shape, closest)
    assert rows.values[-1] == pytest.approx(np.sqrt(np.mean(moved**2)), rel=1e-6)
    assert rows.values[-2] < 1e-6  # the pressure is as it should be


def test_setting_the_pressure_takes_its_direction_out() -> None:
    """Of many builds at random, each shifted along the pressure's field as fits best."""
    shape = bent()
    closest, rng = closest_to_itself(shape), np.random.default_rng(3)
    arms = levers(POSED, shape, closest)
    slopes = slopes_of(MODEL, CHAIN.openF, CHAIN.alpha, 0.14)
    field = (CHAIN.sense * slopes.pressure) @ arms
    unit = field / np.linalg.norm(field)
    sigma = np.sqrt(0.1**2 * slopes.alpha**2 + 0.5**2 * slopes.openF**2)
    moved = (rng.standard_normal((40_000, 2)) * sigma) @ arms
    moved -= np.outer(moved @ unit, unit)
    moved += rng.standard_normal((40_000, 1)) * (0.002 * field)
    expected = Expected(MODEL, ErrorSizes(alpha=0.1, openF=0.5, pressure=0.002))
    found = expected.trimmed_mm(POSED, shape, closest)
    assert found == pytest.approx(np.sqrt(np.mean(moved**2)), rel=0.02)
    assert found < 0.9 * expected.rms_mm(POSED, shape, closest)


def test_nothing_off_is_no_errors() -> None:
    assert error_sizes(NOTHING, TubeSpec()) is None
    rubber = replace(NOTHING, rubber=10.0, wall=3.0)  # set away with the pressure
    assert error_sizes(rubber, TubeSpec()) is None
