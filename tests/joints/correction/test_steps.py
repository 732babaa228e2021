"""Steps of a linear model against closed forms and against trying everything."""

from __future__ import annotations

from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from profiletool.joints.correction.steps import Linear, built_step, free_step
from profiletool.joints.misfit import Deviation, objective_of
from profiletool.records.units import FloatArray

ANY = 1e9  # mm: as deep in the object as it likes
FREE, BUILT = 0.1, 0.05  # damping, mm


def linear(seed: int, size: int = 4, count: int = 60, **changes: object) -> Linear:
    """Distances that a vector far from its bounds could close to some part."""
    rng = np.random.default_rng(seed)
    scale = rng.uniform(0.02, 2.0, size)
    common = rng.normal(size=(count, 1))  # columns that are alike, as those of neighbours are
    jacobian = (rng.normal(size=(count, size)) + common) / scale
    vector = rng.uniform(5.0, 20.0, size)
    distance = jacobian @ (rng.uniform(-1.5, 1.5, size) * scale) + rng.normal(0.0, 0.2, count)
    fields: dict[str, object] = {
        "distance": distance, "jacobian": jacobian, "vector": vector, "low": np.full(size, -np.inf),
        "high": np.full(size, np.inf), "scale": scale, "objective": objective_of(ANY),
        "centre": vector + rng.uniform(-0.3, 0.3, size) * scale,
    }  # fmt: skip
    return Linear(**{**fields, **changes})  # type: ignore[arg-type]


def cost(model: Linear, distance: FloatArray) -> float:
    return float(model.objective.cost(Deviation(distance)))


def objective(model: Linear, vector: FloatArray, damping: float) -> float:
    far = damping * (vector - model.centre) / model.scale
    return cost(model, model.predicted(vector)) + float(far @ far)


def test_where_nothing_binds_it_is_damped_least_squares() -> None:
    model = linear(0)
    A = model.jacobian * model.scale
    normal = A.T @ A + FREE**2 * len(A) * np.eye(4)
    pull = FREE**2 * len(A) * (model.vector - model.centre) / model.scale
    expected = model.vector - np.linalg.solve(normal, A.T @ model.distance + pull) * model.scale
    assert free_step(model, np.full(4, np.inf)) == pytest.approx(expected, rel=1e-9)


def test_what_moves_nothing_stays_at_the_centre() -> None:
    model = linear(1)
    dead = model.jacobian * [1.0, 0.0, 1.0, 1.0]
    found = free_step(linear(1, jacobian=dead), np.full(4, np.inf))
    assert found[1] == pytest.approx(model.centre[1], abs=1e-12)
    assert np.abs(found - model.centre)[[0, 2, 3]].min() > 1e-3


@given(
    seed=st.integers(0, 10_000),
    share=st.floats(0.05, 2.0),
    held=st.lists(st.booleans(), min_size=4, max_size=4),
    depth=st.sampled_from([0.0, 0.3, ANY]),
)
def test_bounds_reach_and_held_numbers(
    seed: int, share: float, held: list[bool], depth: float
) -> None:
    rng = np.random.default_rng(seed)
    model = linear(seed)
    low, high = (model.centre + s * rng.uniform(0.1, 3.0, 4) * model.scale for s in (-1.0, 1.0))
    model = linear(seed, low=low, high=high, objective=objective_of(depth))
    reach, kept = share * model.scale, np.array(held)
    at = model.vector + rng.uniform(-0.1, 0.1, 4) * model.scale
    found = free_step(model, reach, kept, at)
    assert (found[kept] == at[kept]).all()
    least, most = np.maximum(low, model.centre - reach), np.minimum(high, model.centre + reach)
    assert (found[~kept] >= least[~kept] - 1e-12).all()
    assert (found[~kept] <= most[~kept] + 1e-12).all()
    # No other vector of the box is better.
    best = objective(model, found, FREE)
    for _ in range(50):
        other = np.where(kept, at, rng.uniform(least, most))
        near = found + 0.01 * (other - found)
        assert objective(model, other, FREE) >= best - 1e-9
        assert objective(model, near, FREE) >= best - 1e-9


def test_no_number_free() -> None:
    model = linear(2)
    at = model.vector + 1.0
    assert (free_step(model, np.ones(4), np.ones(4, dtype=bool), at) == at).all()


def test_depth_pulls_out_of_the_object() -> None:
    # Ten points on a line that shifts: half of them 1 mm out, half 1 mm in.
    one = np.ones(10)
    model = Linear(
        distance=np.repeat([1.0, -1.0], 5), jacobian=one[:, None], vector=np.zeros(1),
        centre=np.zeros(1), low=np.full(1, -9.0), high=np.full(1, 9.0), scale=np.ones(1),
        objective=objective_of(ANY),
    )  # fmt: skip
    assert free_step(model, np.full(1, 5.0)) == pytest.approx([0.0], abs=1e-9)
    strict = replace(model, objective=objective_of(0.3))
    # d/dt of (1 + t)^2 + (t - 1)^2 + 4 (t - 0.7)^2 + 2 (0.1 t)^2
    assert free_step(strict, np.full(1, 5.0)) == pytest.approx([2.8 / 6.02], rel=1e-6)
    assert cost(strict, np.array([-0.5, 0.1])) == pytest.approx((0.26 + 4.0 * 0.04) / 2.0)


def steps_of(model: Linear, free: int = 1) -> FloatArray:
    """Coarse steps, and none for the last numbers."""
    step = 0.8 * model.scale
    step[len(step) - free :] = 0.0
    return step


def refitted(model: Linear, vector: FloatArray, step: FloatArray) -> float:
    """Cost of the numbers that have steps, with the others where they are best."""
    discrete = step > 0.0
    distance = model.predicted(vector)
    rest = model.jacobian[:, ~discrete]
    distance = distance - rest @ np.linalg.lstsq(rest, distance, rcond=None)[0]
    far = (BUILT * (vector - model.centre) / model.scale)[discrete]
    return cost(model, distance) + float(far @ far)


@pytest.mark.parametrize("seed", range(12))
def test_built_numbers_are_multiples_within_bounds(seed: int) -> None:
    model = linear(seed, 7)
    step, reach = steps_of(model), 3.0 * model.scale
    low, high = model.centre - 1.3 * model.scale, model.centre + 1.7 * model.scale
    found = built_step(linear(seed, 7, low=low, high=high), step, reach)
    whole = found[:-1] / step[:-1]
    assert whole == pytest.approx(np.round(whole), abs=1e-9)
    assert ((found >= low - 1e-9) & (found <= high + 1e-9)).all()
    assert found[-1] / model.scale[-1] % 0.8 > 1e-6  # has no step


@pytest.mark.parametrize("seed", range(12))
def test_never_worse_than_rounding_and_fitting_the_rest_again(seed: int) -> None:
    model = linear(seed, 7)
    step, reach = steps_of(model), 3.0 * model.scale
    found = built_step(model, step, reach)
    free = free_step(model, reach)
    naive = np.where(step > 0.0, np.round(free / np.where(step > 0.0, step, 1.0)) * step, free)
    assert refitted(model, found, step) <= refitted(model, naive, step) + 1e-9


@pytest.mark.parametrize("seed", range(12))
def test_as_good_as_trying_everything(seed: int) -> None:
    model = linear(seed, 4)
    step, reach = steps_of(model), 3.0 * model.scale
    found = built_step(model, step, reach)
    numbers = [
        np.arange(np.ceil((v - r) / s), np.floor((v + r) / s) + 1.0) * s
        for v, r, s in zip(model.centre[:3], reach[:3], step[:3], strict=True)
    ]
    tried = [np.array([*some, model.vector[3]]) for some in product(*numbers)]
    assert len(tried) >= 7**3
    best = min(tried, key=lambda vector: refitted(model, vector, step))
    assert found[:3] == pytest.approx(best[:3], abs=1e-9)
    # And the number without steps is fitted to them.
    discrete = np.array([True, True, True, False])
    assert found == pytest.approx(free_step(model, reach, discrete, found), abs=1e-12)


def test_without_steps_all_is_free() -> None:
    model = linear(3)
    reach = 0.5 * model.scale
    assert (built_step(model, np.zeros(4), reach) == free_step(model, reach)).all()
