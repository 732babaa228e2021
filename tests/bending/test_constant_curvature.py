from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from formula.files import load_formula
from formula.theta import theta_deg
from profiletool.bending.constant_curvature import FormulaModel
from profiletool.bending.kinematics import PIVOT_SHARE
from profiletool.bending.model import Chain, Model, centers_of
from profiletool.records.frames import Pose

FORMULA = load_formula()
MODEL: Model = FormulaModel(FORMULA, 10.0)


def test_theta_is_the_formula_in_radians_and_megapascal() -> None:
    theta = MODEL.theta([6.0, 10.0], np.radians([100.0, 132.0]), 0.12)
    assert np.degrees(theta) == pytest.approx(theta_deg(FORMULA, [100, 132], [6, 10], 1.2))


def test_its_ranges_are_the_formulas() -> None:
    assert MODEL.pressure == pytest.approx(np.array(FORMULA.pressure_range_bar) / 10.0)
    assert np.degrees(MODEL.alpha) == pytest.approx(FORMULA.alpha_range_deg)


@given(
    openF=st.sampled_from([6.0, 8.0, 14.0]),
    alpha_deg=st.floats(100.0, 150.0),
    bar=st.floats(0.4, 2.0),
)
def test_alpha_for_is_the_inverse_of_theta(openF: float, alpha_deg: float, bar: float) -> None:
    alpha = np.radians(alpha_deg)
    theta = MODEL.theta(openF, alpha, bar / 10.0)
    assert MODEL.alpha_for(openF, theta, bar / 10.0) == pytest.approx(alpha, abs=1e-6)


def test_alpha_for_says_what_no_joint_gives() -> None:
    most = MODEL.theta(10.0, MODEL.alpha[0], 0.2)
    found = MODEL.alpha_for(10.0, np.array([0.5, 1.0, 1.001]) * most, [[0.2], [0.05]])
    assert np.isnan(found).tolist() == [[False, False, True], [True, True, True]]


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_line_is_an_arc_that_turns_toward_the_object_below(sense: float) -> None:
    theta = float(MODEL.theta(8.0, 1.9, 0.18))
    x, y, heading = MODEL.line(8.0, 1.9, 0.18, sense).T
    assert (x[0], y[0], heading[0]) == (0.0, 0.0, 0.0)
    assert heading[-1] == pytest.approx(-sense * theta)
    radius = 8.0 / theta + (PIVOT_SHARE - sense) * 10.0
    assert x[-1] == pytest.approx(radius * np.sin(theta))
    assert y[-1] == pytest.approx(-sense * radius * (1.0 - np.cos(theta)))


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_the_shape_of_one_joint_holds_its_line(sense: float, sign: float) -> None:
    one = np.ones(1)
    chain = Chain(30.0 * one, 8.0 * one, 1.9 * one, centers_of(sense * one), 60.0)
    shape = MODEL.shape(chain, 0.18, Pose(0.0, 0.0, 0.0), sign)
    line = MODEL.line(8.0, 1.9, 0.18, sense)
    window = [np.interp([26.0, 34.0], shape.along, part) for part in shape.facing.T]
    assert window[0] == pytest.approx(26.0 + line[[0, -1], 0])
    assert window[1] == pytest.approx(-sign * line[[0, -1], 1])
