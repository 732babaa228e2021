import numpy as np
import pytest
from numpy.testing import assert_allclose

from profiletool.bending.model import Chain
from profiletool.bending.response import Response
from profiletool.campaign import response_runs as campaign
from profiletool.campaign.response_fit import Lines, check, factors_in, fields

RADIUS = 10.0


def an_arc(turn, length=30.0):
    """Lines of a tube bent to an arc toward the object, the axis keeping its length."""
    along = np.linspace(0.0, length, 121)
    angle = turn * along / length
    rho = length / turn
    axis = np.column_stack([rho * np.sin(angle), RADIUS - rho * (1.0 - np.cos(angle))])
    across = RADIUS * np.column_stack([np.sin(angle), np.cos(angle)])
    none = np.empty(0)
    chain = Chain(none, none, none, none, length)
    return Lines(
        "arc", chain, np.array([0.1]), along, (axis - across)[None], (axis + across)[None], None
    )


def test_fields_of_an_arc():
    arc = an_arc(0.8)
    turn, stretch, shift, height = fields(arc)[0]
    assert_allclose(turn, 0.8 * arc.along / 30.0, atol=1e-12)
    assert_allclose(stretch, 0.0, atol=1e-9)
    assert_allclose(shift, 0.0, atol=1e-9)
    assert_allclose(height, 2.0 * RADIUS)


def test_random_actuators_are_the_same_every_time_and_can_be_modelled():
    first, again = (campaign.actuators(12, 3, (1.0,)) for _ in range(2))
    for a, b in zip(first, again, strict=True):
        assert_allclose(a.chain.centre, b.chain.centre)
        end = a.chain.centre + 0.5 * a.chain.openF
        start = a.chain.centre - 0.5 * a.chain.openF
        gaps = np.append(start, a.chain.length - 1.0) - np.append(0.0, end)
        assert gaps.min() >= 1.99
        assert 2 <= len(end) <= 7
        assert a.chain.length <= 125.0


def test_factors_of_a_predicted_shape_are_found_again():
    response, (plan,) = Response.load(), campaign.actuators(1, 7, (1.5,))
    wanted = response.factors(plan.chain, 0.15) * 1.05
    shape = response.shape_by(wanted, plan.chain, 0.15, campaign.BASE, campaign.SIGN)
    lines = Lines(
        "own", plan.chain, np.array([0.15]), shape.along, shape.facing[None], shape.far[None], None
    )
    assert_allclose(factors_in(lines, response)[0], wanted, atol=1e-3)
    assert 0.0 < check([lines], response).rms[0] < 5.0


@pytest.mark.slow
def test_the_shipped_response_predicts_finite_elements_of_random_actuators():
    plans = campaign.actuators(4, 11, (1.0, 1.5, 2.0))
    runs = [lines for lines in map(campaign.run, plans) if lines is not None]
    assert len(runs) == len(plans)
    assert check(runs, Response.load()).summary()["rms_mm_per_100mm"] < 1.5
