"""The trim table of a small actuator of two opposite joints, against FE at its own pressures."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fem.errors import NotConverged
from fem.loadpath import Options
from fem.solution import Solution
from profiletool.records.built import TrimPoint
from profiletool.records.design import Design
from profiletool.records.side import side_sign
from profiletool.verify import trim
from profiletool.verify.check import check
from profiletool.verify.run import Run, inflate, run_design
from profiletool.verify.trim import trim_of, trim_pressures
from profiletool.verify.tube import actuator_of
from tests.verify.test_sensitivity import BAR, two_joints


@pytest.fixture(scope="module")
def design(samples: Path) -> Design:
    return two_joints(samples)


@pytest.fixture(scope="module")
def run(design: Design) -> Run:
    return run_design(design, BAR)


@pytest.fixture(scope="module")
def table(design: Design, run: Run) -> tuple[TrimPoint, ...]:
    return trim_of(design, run)


def test_where_finite_elements_bend_it(design: Design, table: tuple[TrimPoint, ...]) -> None:
    """An independent run from rest, through pressures of the table."""
    assert len(table) == 9
    bars = [point.pressure_bar for point in table]
    sign = side_sign(design.source.side)
    real = inflate(actuator_of(design), bars, design.base_pose, sign).verification.states
    for point, state in zip(table, real, strict=True):
        assert point.pressure_bar == pytest.approx(state.pressure_bar)
        assert point.theta_deg == pytest.approx(state.theta_deg, abs=0.05)
        assert point.tip_mm == pytest.approx(state.shape.facing[-1], abs=0.05)
    # It tells states apart: from row to row the joints turn by more than that.
    assert np.abs(np.diff([point.theta_deg for point in table], axis=0)).max(axis=1).min() > 0.2


def test_the_planned_row_is_that_of_the_joints(
    design: Design, run: Run, table: tuple[TrimPoint, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    (planned,) = (point for point in table if point.pressure_bar == BAR)
    last = run.verification.last
    assert planned.theta_deg == pytest.approx(last.theta_deg, abs=1e-3)
    assert planned.theta_deg[0] > 0.0 > planned.theta_deg[1]
    assert planned.tip_mm == pytest.approx(last.shape.facing[-1], abs=1e-3)
    monkeypatch.setattr("profiletool.verify.check.run_design", lambda *_: run)
    checked = check(design, last.shape.facing).design.joints
    assert planned.theta_deg == pytest.approx(
        [joint.signed(joint.theta_fe_deg or 0.0) for joint in checked], abs=2e-3
    )


def test_as_far_as_there_are_stable_states(
    design: Design, run: Run, table: tuple[TrimPoint, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    further = trim.solve_onward(run.solution, 0.1057, Options(tolerance=3e-3))

    def ended(solution: Solution, *_: object) -> Solution:
        raise NotConverged("unstable", (), 0.1057, further)

    monkeypatch.setattr(trim, "solve_onward", ended)
    found = trim_of(design, run)
    assert found[-1].pressure_bar == 1.05

    def at_once(solution: Solution, *_: object) -> Solution:
        raise NotConverged("unstable", (), 0.1, replace(solution, failure="unstable"))

    monkeypatch.setattr(trim, "solve_onward", at_once)
    short = trim_of(design, run)
    assert short[-1].pressure_bar == BAR
    assert short[0].theta_deg == pytest.approx(table[0].theta_deg, abs=0.02)


@pytest.mark.parametrize("bar", [0.13, 0.42, 0.5, 1.0, 1.19, 1.67, 2.0, 3.7])
def test_pressures_of_a_table(bar: float) -> None:
    top = round(1.1 * bar + 0.004, 2)
    rows = trim_pressures(bar, top)
    assert 5 <= len(rows) <= 15
    assert list(rows) == sorted(set(rows))
    assert bar in rows
    assert 0.8 * bar <= rows[0] <= 0.85 * bar + 1e-9
    assert rows[-1] == top
    steps = np.diff(rows)
    assert np.ptp(steps[:-1]) < 1e-9
    assert 0.5 - 1e-6 <= steps[-1] / steps[0] <= 1.5 + 1e-6
    assert trim_pressures(bar, bar)[-1] == bar
