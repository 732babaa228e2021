"""The objective: its terms by hand, its Jacobian by Taylor remainders, one for all who ask."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from formula.files import load_formula
from profiletool.bending.constant_curvature import FormulaModel
from profiletool.joints import misfit
from profiletool.joints.bounds import cuts_of, limits_of
from profiletool.joints.correction.parameters import PosedChain, parameters_of
from profiletool.joints.correction.steps import Linear, free_step
from profiletool.joints.expected import Aim
from profiletool.joints.misfit import Deviation, Objective, Term, is_good, objective_of, score
from profiletool.joints.optimal.lines import Discretisation
from profiletool.joints.optimal.polish import goal_of, polish
from profiletool.joints.optimal.search import search
from profiletool.profile.target import Reach, profile_of_line
from profiletool.records.design import Misfit
from profiletool.records.request import TubeSpec
from profiletool.records.units import FloatArray

MODEL = FormulaModel(load_formula(), 10.0)


def test_the_cost_by_hand() -> None:
    objective = objective_of(0.3)
    # 0.2 and 0.7 mm too deep, weighing four times.
    distance = np.array([0.1, -0.5, -1.0, -0.3])
    density = [0.01, 0.25 + 4.0 * 0.04, 1.0 + 4.0 * 0.49, 0.09]
    assert objective.density(Deviation(distance)) == pytest.approx(density)
    assert float(objective.cost(Deviation(distance))) == pytest.approx(np.mean(density))
    two = np.stack([distance, 0.0 * distance])
    assert objective.cost(Deviation(two)) == pytest.approx([np.mean(density), 0.0])


def test_single_precision_stays_single() -> None:
    distance = np.array([0.5, -0.7], dtype=np.float32)
    assert objective_of(0.3).density(Deviation(distance)).dtype == np.float32


@given(
    distance=st.lists(st.floats(-3.0, 3.0), min_size=1, max_size=9),
    length=st.floats(50.0, 300.0),
)
def test_residuals_are_the_cost(distance: list[float], length: float) -> None:
    objective = objective_of(0.3, 250.0)
    at = Deviation(np.array(distance), length=length)
    residuals = objective.residuals(at)
    shape, (long, any_) = residuals[:-2], residuals[-2:]
    assert shape @ shape == pytest.approx(len(distance) * float(objective.cost(at)), abs=1e-12)
    assert long == pytest.approx(max(length - 250.0, 0.0))
    assert any_ == pytest.approx(0.01 * length)


def state(x: FloatArray, derivatives: bool = True) -> Deviation:
    """Distances and a length that are no linear functions of two numbers."""
    a = np.linspace(-2.0, 2.0, 12)
    distance = a * np.exp(0.3 * x[0]) + x[1] ** 2 - 0.1
    jacobian = np.column_stack([0.3 * a * np.exp(0.3 * x[0]), np.full(len(a), 2.0 * x[1])])
    length, slope = 250.0 + np.sinh(x[0]), np.array([np.cosh(x[0]), 0.0])
    if not derivatives:
        return Deviation(distance, length=length)
    return Deviation(distance, jacobian, length, slope)


def test_the_jacobian_leaves_remainders_of_second_order() -> None:
    objective = objective_of(0.3, 250.0)
    x, direction = np.array([0.4, 0.5]), np.array([0.8, -0.6])
    base, slope = objective.residuals(state(x)), objective.jacobian(state(x)) @ direction
    active = [term.active(state(x)).sum() for term in objective.shape]
    assert active[0] == 12
    assert 0 < active[1] < 12  # some lie too deep, some do not
    left = [
        np.linalg.norm(objective.residuals(state(x + h * direction, False)) - base - h * slope)
        for h in 0.02 * 0.5 ** np.arange(5)
    ]
    assert left[0] > 1e-5
    assert np.log2(np.divide(left[:-1], left[1:])) == pytest.approx(2.0, abs=0.05)


def test_scores_and_verdicts() -> None:
    fit = Misfit(0.2, 0.9)
    assert score(fit, 0.3, 0.3) == 0.2
    assert score(fit, 0.8, 0.3) == pytest.approx(0.2 + 0.1 * 0.5)
    assert is_good(fit, 0.39, 0.2, 0.3)
    assert not is_good(fit, 0.41, 0.2, 0.3)
    assert not is_good(fit, 0.0, 0.19, 0.3)


def test_a_term_added_in_one_place_counts_for_all_who_ask(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    # A third term: 2 mm off the object everywhere. With the first one, 1 mm is best.
    terms = misfit.shape_terms

    def more(interference_mm: float) -> tuple[Term, ...]:
        first, *others = terms(interference_mm)
        return (first, *others, replace(first, goal=2.0))

    down = np.column_stack([np.zeros(3), np.linspace(0.0, -20.0, 3)])
    turn = np.linspace(0.0, 1.2, 60)
    arc = [20.0, -20.0] + 25.0 * np.column_stack([-np.cos(turn), -np.sin(turn)]) + [5.0, 0.0]
    profile = profile_of_line(np.concatenate([down, arc[1:]]), Reach("left", 10.0))
    spec = TubeSpec()
    limits, cuts = limits_of(MODEL, spec), cuts_of(MODEL, spec)
    grid = Discretisation(6.0, (0.0,), (0.0, 1.0), 0.1, 0.16)

    def searched() -> PosedChain:
        found = search(profile, MODEL, cuts, limits, 0.3, grid, 3)
        pressure = int(np.argmin(found.cost[:, 2]))
        return found.posed_chain(pressure, 3, MODEL, profile, limits)

    def mean_distance(objective: Objective) -> float:
        linear = Linear(
            distance=np.zeros(5), jacobian=np.ones((5, 1)), vector=np.zeros(1),
            centre=np.zeros(1), low=np.full(1, -9.0), high=np.full(1, 9.0), scale=np.ones(1),
            objective=objective,
        )  # fmt: skip
        return float(free_step(linear, np.full(1, 9.0), damping_mm=1e-6)[0])

    goal = goal_of(profile, limits, Aim(0.3))
    plain, start = searched(), searched()
    on = polish(start, MODEL, goal)
    assert mean_distance(objective_of(0.3)) == pytest.approx(0.0, abs=1e-9)
    monkeypatch.setattr(misfit, "shape_terms", more)
    assert mean_distance(objective_of(0.3)) == pytest.approx(1.0, abs=1e-6)
    off = polish(start, MODEL, goal)
    assert off.misfit.rms_mm > on.misfit.rms_mm + 0.2
    changed = searched()
    numbers = [parameters_of(a.chain, profile, limits).pack(a) for a in (plain, changed)]
    assert not np.allclose(*numbers)
