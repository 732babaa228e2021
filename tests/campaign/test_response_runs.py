"""Runs for the joint response: tasks, keys, files, and the fit's ingredients."""

import json
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from fem.errors import NotConverged
from profiletool.bending.model import Chain
from profiletool.bending.response import Response
from profiletool.campaign import response_kind
from profiletool.campaign.keys import seal
from profiletool.campaign.response_fit import BASE, SIGN, Lines, check, factors_in, fields
from profiletool.campaign.response_kind import RESPONSE_RUN, from_json, key, run, to_json
from profiletool.campaign.response_runs import run_group
from profiletool.campaign.response_tasks import actuators, pairs, singles
from profiletool.campaign.store import Store
from profiletool.verify.run import inflate

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
    first, again = (actuators(12, 3, (1.0,)) for _ in range(2))
    for a, b in zip(first, again, strict=True):
        assert_allclose(a.chain.centre, b.chain.centre)
        end = a.chain.centre + 0.5 * a.chain.openF
        start = a.chain.centre - 0.5 * a.chain.openF
        gaps = np.append(start, a.chain.length - 1.0) - np.append(0.0, end)
        assert gaps.min() >= 1.99
        assert 2 <= len(end) <= 7
        assert a.chain.length <= 125.0


def test_factors_of_a_predicted_shape_are_found_again():
    response, (task,) = Response.load(), actuators(1, 7, (1.5,))
    wanted = response.factors(task.chain, 0.15) * 1.05
    shape = response.shape_by(wanted, task.chain, 0.15, BASE, SIGN)
    lines = Lines(
        "own", task.chain, np.array([0.15]), shape.along, shape.facing[None], shape.far[None], None
    )
    assert_allclose(factors_in(lines, response)[0], wanted, atol=1e-3)
    assert 0.0 < check([lines], response).rms[0] < 5.0


def a_task():
    return next(task for task in singles() if task.name == "s144_6")


def same(first, second):
    """Whether two lines are the same to the last bit."""
    return to_json(first) == to_json(second) and all(
        getattr(first, name).tobytes() == getattr(second, name).tobytes()
        for name in ("pressure", "along", "facing", "far")
    )


def test_lines_come_back_to_the_last_bit():
    arc = replace(an_arc(1.0 / 3.0), chain=a_task().chain, ended="limit point at 1.00 bar")
    again = from_json(to_json(arc))
    assert same(again, arc)
    assert (again.name, again.ended) == ("arc", "limit point at 1.00 bar")
    for name in ("centre", "openF", "alpha", "alpha_center"):
        assert_array_equal(getattr(again.chain, name), getattr(arc.chain, name))
    assert again.chain.length == 81.0
    nothing = RESPONSE_RUN.died(a_task())
    assert same(from_json(to_json(nothing)), nothing)
    assert from_json(to_json(nothing)).facing.shape == (0, 0, 2)


def test_damaged_lines_are_noticed():
    data = to_json(an_arc(0.5, 0.5))
    for k in range(0, len(data), 29):
        with pytest.raises(ValueError, match=r"."):
            from_json(data[:k])
        with pytest.raises(ValueError, match=r"."):
            from_json(data[:k] + bytes([data[k] ^ 1]) + data[k + 1 :])
    tree = json.loads(data)["outcome"]
    for wrong in (
        {"facing": tree["facing"][0][1:]},
        {"chain": {}},
        {"chain": None},
        {"along": [1.0]},
    ):
        with pytest.raises(ValueError, match="run"):
            from_json(seal("profiletool.response_run/1", tree | wrong))


def test_every_task_of_the_campaign_has_a_key_of_its_own():
    tasks = [*singles(), *pairs(), *actuators(20, 1, (1.0,)), *actuators(20, 2, (1.0,))]
    assert len({key(task) for task in tasks}) == len(tasks)
    task = a_task()
    assert key(task) == key(a_task())
    others = [
        replace(task, name="other"),
        replace(task, pressures_bar=task.pressures_bar[:-1]),
        *(
            replace(task, chain=replace(task.chain, **{name: getattr(task.chain, name) * 1.001}))
            for name in ("centre", "openF", "alpha", "alpha_center", "length")
        ),
    ]
    assert len({key(other) for other in [task, *others]}) == len(others) + 1


def test_runs_are_kept_and_those_without_a_state_left_out(tmp_path, monkeypatch, capsys):
    begun = []

    def made_up(task):
        begun.append(task.name)
        if task.name == "none":
            return RESPONSE_RUN.died(task)
        return replace(an_arc(0.1 + 0.01 * len(task.name)), name=task.name, chain=task.chain)

    kind = replace(RESPONSE_RUN, run=made_up)
    tasks = singles()[:4]
    found = run_group(tasks, Store(tmp_path, kind), 1)
    assert [lines.name for lines in found] == [task.name for task in tasks[1:]]
    assert capsys.readouterr().out.splitlines()[-2:] == ["4/4", "none its process died"]
    again = run_group(tasks, Store(tmp_path, kind), 1)
    assert len(begun) == 4
    assert all(map(same, found, again))


@pytest.mark.slow
def test_real_lines_are_the_same_bit_for_bit_on_processes(tmp_path):
    tasks = [replace(task, pressures_bar=(0.2,)) for task in singles()[:2]]
    found = run_group(tasks, Store(tmp_path, RESPONSE_RUN), 2)
    assert all(map(same, found, map(run, tasks)))


def test_what_does_not_converge(monkeypatch):
    asked = replace(a_task(), pressures_bar=(0.2, 0.4))

    def stuck(actuator, pressures, *rest, **more):
        whole = inflate(actuator, pressures[:1], *rest, **more)
        why = "no equilibrium found beyond 0.31 bar"
        return replace(whole, verification=replace(whole.verification, failure=why))

    monkeypatch.setattr(response_kind, "inflate", stuck)
    reached = run(asked)
    assert reached.pressure.tolist() == [0.02]
    assert reached.ended == "no equilibrium found beyond 0.31 bar"

    def never(*_, **__):
        raise NotConverged("", (), 0.0)

    monkeypatch.setattr(response_kind, "inflate", never)
    lines = run(asked)
    assert len(lines.pressure) == 0
    assert lines.ended == "no equilibrium found beyond 0.00 bar"


@pytest.mark.slow
def test_the_shipped_response_predicts_finite_elements_of_random_actuators():
    runs = [run(task) for task in actuators(4, 11, (1.0, 1.5, 2.0))]
    assert all(len(lines.pressure) == 3 for lines in runs)
    assert check(runs, Response.load()).summary()["rms_mm_per_100mm"] < 1.5
