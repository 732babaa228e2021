"""Neighbours of a design: by the model that it was chosen by, and by finite elements."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from profiletool import design
from profiletool.joints.correction.correct import CannotBend
from profiletool.pipeline import Result
from profiletool.records.profile import DrawnLine
from profiletool.verdict import around
from profiletool.verdict.around import with_neighbours

ANGLE = np.linspace(0.0, 0.5 * np.pi, 60)
ARC = DrawnLine(60.0 * np.column_stack([-np.sin(ANGLE), np.cos(ANGLE)]), False)


@pytest.fixture(scope="module")
def result() -> Result:
    return design(ARC, verify=False)


@pytest.mark.slow
def test_finite_elements_are_said_where_they_corrected_a_neighbour(
    result: Result, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert {one.by for one in result.design.neighbours} == {"joint response"}
    asked: list[str] = []

    def by_fe(found: Any, *_: object) -> Any:
        asked.append(found.what)
        return replace(found, by="FE")

    monkeypatch.setattr(around, "_by_fe", by_fe)
    known = result.plan.choice.neighbours
    lower = known[0][1]
    choice = replace(result.plan.choice, neighbours=(*known[:2], ("lower pressure", lower)))
    checked: Any = type("Checked", (), {"run": object()})()
    verified = replace(
        result, plan=replace(result.plan, choice=choice), check=checked,
        design=replace(result.design, verified=True),
    )  # fmt: skip
    by = {one.what: one.by for one in with_neighbours(verified).design.neighbours}
    assert asked == ["lower pressure"]
    assert by["lower pressure"] == "FE"
    assert by["as chosen"] == "joint response"
    # Far off by the joint response: no finite elements are wasted on it.
    far = replace(lower, misfit=replace(lower.misfit, rms_mm=9.0))
    choice = replace(choice, neighbours=(("lower pressure", far),))
    other = replace(verified, plan=replace(result.plan, choice=choice))
    (one,) = with_neighbours(other).design.neighbours
    assert one.by == "joint response"


@pytest.mark.slow
def test_a_neighbour_that_cannot_be_bent_stays_by_the_model(
    result: Result, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fails(*_: object) -> None:
        raise CannotBend("no equilibrium", 0.1)

    monkeypatch.setattr(around, "correction", fails)
    what, polished = result.plan.choice.neighbours[0]
    found = around._by_model(what, polished, result)
    run: Any = type("Run", (), {"solution": None})()
    assert around._by_fe(found, polished, result, run) == found


@pytest.mark.slow
def test_the_neighbour_at_less_pressure_by_finite_elements() -> None:
    made = design(ARC)
    assert made.design.verified
    (lower,) = (one for one in made.design.neighbours if one.what == "lower pressure")
    assert lower.by == "FE"
    assert lower.pressure_bar <= 0.9 * made.design.neighbours[0].pressure_bar + 1e-9
    assert made.design.fit.fe.rms_mm < lower.rms_mm < 2.0  # less pressure reaches less far
    assert round(100.0 * lower.pressure_bar, 6) % 1.0 == pytest.approx(0.0)
