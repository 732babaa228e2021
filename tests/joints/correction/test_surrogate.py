"""A cheap model shifted onto a dear one: what it knows, it must not get wrong."""

from __future__ import annotations

import numpy as np
import pytest

from profiletool.bending.model import Model
from profiletool.bending.response import Response
from profiletool.joints.closest import closest_points, distance_jacobian
from profiletool.joints.correction.parameters import facing_motion
from profiletool.joints.correction.steps import Linear
from profiletool.joints.correction.surrogate import Surrogate
from profiletool.joints.misfit import Deviation, objective_of
from profiletool.records.units import FloatArray
from tests.joints.correction.test_correct import FORMULA, OFF, TRUE, bent, numbers, profile_along

PARAMETERS = numbers()
POINTS = profile_along(bent(FORMULA, PARAMETERS, TRUE), "left").points[::20]
START = TRUE + OFF


def by(model: Model, vector: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Distances and derivatives by a model itself."""
    shape = bent(model, PARAMETERS, vector)
    closest = closest_points(shape.facing, POINTS, PARAMETERS.sign)
    motion = facing_motion(PARAMETERS, model, vector, shape)
    return closest.distance, distance_jacobian(closest, motion)


def surrogate(forward: Model, model: Model) -> Surrogate:
    distance, jacobian = by(forward, START)
    low, high = PARAMETERS.bounds()
    linear = Linear(
        distance, jacobian, START, START, low, high, PARAMETERS.scale(), objective_of(1e9)
    )
    return Surrogate(linear, PARAMETERS, model, POINTS)


def promised(known: Surrogate, vector: FloatArray) -> FloatArray:
    return known._near(known._bent(vector), vector).distance


def test_it_is_exact_where_the_model_is_the_forward_model() -> None:
    known = surrogate(FORMULA, FORMULA)
    np.testing.assert_allclose(promised(known, TRUE), by(FORMULA, TRUE)[0], atol=1e-9)
    vector, cost = known.free(1.0)
    found = by(FORMULA, vector)[0]
    assert cost == pytest.approx(float(known.linear.objective.cost(Deviation(found))))
    assert np.sqrt(np.mean(found**2)) < 0.2 * np.sqrt(np.mean(known.linear.distance**2))


def test_by_another_model_it_agrees_at_the_iterate_with_its_slopes() -> None:
    known = surrogate(Response.load(), FORMULA)
    distance, jacobian = by(Response.load(), START)
    there = known._near(known._bent(START), START)
    np.testing.assert_allclose(there.distance, distance, atol=1e-12)
    np.testing.assert_allclose(there.jacobian, jacobian, atol=1e-12)
    for k, scale in enumerate(PARAMETERS.scale()):
        step = 1e-4 * scale * np.eye(len(START))[k]
        slope = (promised(known, START + step) - promised(known, START - step)) / (2e-4 * scale)
        # Where the line has a kink, at a cut's edge, a closest point passes it within the step.
        off = np.abs(slope - jacobian[:, k]) / np.abs(jacobian[:, k]).max()
        assert np.median(off) < 5e-3
        assert off.max() < 0.1


def test_an_update_agrees_where_it_was_told_and_changes_nothing_across() -> None:
    known = surrogate(Response.load(), FORMULA)
    scale = PARAMETERS.scale()
    way = scale * np.array([1.0, -0.5, 0.3, 0.2, 0.0, 0.4, 0.1])
    there = START + way
    distance = by(Response.load(), there)[0]
    assert np.abs(promised(known, there) - distance).max() > 1e-3
    told = known.broyden_update(there, distance)
    np.testing.assert_allclose(promised(told, there), distance, atol=1e-9)
    across = scale * np.array([0.5, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    assert float((across / scale) @ (way / scale)) == pytest.approx(0.0)
    np.testing.assert_allclose(
        promised(told, START + across), promised(known, START + across), atol=1e-9
    )


def test_built_vectors_are_multiples_of_the_steps() -> None:
    known = surrogate(FORMULA, FORMULA)
    step = np.array([0.2, 0.2, 0.2, 1.0, 1.0, 0.0, 0.0])[: len(START)]
    vector, _ = known.built(step)
    for value, size in zip(vector, step, strict=True):
        if size:
            assert value / size == pytest.approx(round(value / size), abs=1e-9)
