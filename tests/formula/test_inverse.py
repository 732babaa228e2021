from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from formula.errors import OutOfRange
from formula.files import load_formula
from formula.inverse import alpha_branch_deg, alpha_deg, theta_range_deg
from formula.theta import theta_deg

PAPER = load_formula()


@given(st.floats(6, 14), st.floats(0.2, 2.0), st.floats(0, 1))
def test_theta_of_the_inverse_is_what_was_wanted(openF: float, P: float, share: float) -> None:
    least, most = theta_range_deg(PAPER, openF, P)
    wanted = float(least + share * (most - least))
    alpha = alpha_deg(PAPER, wanted, openF, P)
    assert 84 <= alpha <= 180
    assert theta_deg(PAPER, alpha, openF, P) == pytest.approx(wanted, abs=1e-6)


@given(st.floats(6, 14), st.floats(0.2, 2.0))
def test_theta_falls_all_along_the_branch(openF: float, P: float) -> None:
    low, high = alpha_branch_deg(PAPER, openF, P)
    assert np.all(np.diff(theta_deg(PAPER, np.linspace(low, high, 50), openF, P)) < 0)


def test_the_branch_starts_at_the_vertex_where_it_lies_inside() -> None:
    low, _ = alpha_branch_deg(PAPER, 8.0, 2.0)
    assert 84 < low < 96
    assert theta_deg(PAPER, low, 8, 2) > theta_deg(PAPER, 84, 8, 2)


def test_vectorised() -> None:
    alpha = alpha_deg(PAPER, [20.0, 25.0, 30.0], 8.0, 1.9)
    assert alpha.shape == (3,)
    assert np.all(np.diff(alpha) < 0)


def test_no_pressure() -> None:
    assert alpha_deg(PAPER, 0.0, 8.0, 0.0) == 180


@pytest.mark.parametrize(
    ("theta", "openF", "P", "says"),
    [
        (60.0, 8.0, 2.0, r"beyond 42\.\d\d deg, the most that openF 8 mm gives at 2 bar"),
        (0.1, 6.0, 1.9, r"beyond 1\.22 deg, the least that openF 6 mm gives at 1\.9 bar"),
        (-1.0, 14.0, 2.0, "the least"),
        (30.0, 5.0, 2.0, "openF 5 mm is outside"),
        (30.0, 8.0, 2.5, "pressure 2.5 bar is outside"),
        (float("nan"), 8.0, 1.0, "theta nan"),
    ],
)
def test_out_of_range_says_which_limit(theta: float, openF: float, P: float, says: str) -> None:
    with pytest.raises(OutOfRange, match=says):
        alpha_deg(PAPER, theta, openF, P)


def test_a_formula_that_rises_with_alpha_has_no_inverse() -> None:
    rising = replace(PAPER, terms=(((0.0, 0.2, 0.0),),))
    with pytest.raises(OutOfRange, match="no inverse"):
        alpha_deg(rising, 20.0, 8.0, 1.5)
