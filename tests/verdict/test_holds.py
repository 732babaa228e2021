"""Designs whose numbers do not hold: off the steps asked for, or a tube that runs into itself."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from profiletool.pipeline import Result, run
from profiletool.records.design import Design
from profiletool.records.fe import CriticalPoint, FeState, Verification
from profiletool.records.request import Request
from profiletool.verdict.holds import broken, holding, off_steps
from profiletool.verdict.reasons import WORST, far_off, not_good
from profiletool.verify.check import Check
from profiletool.verify.run import Run

THREAD = float(np.degrees(0.2))


@pytest.fixture(scope="module")
def result(samples: Path) -> Result:
    return run(Request(samples / "finger_rest.csv", verify=False), lambda line: None)


def changed(design: Design, number: int, **change: float) -> Design:
    joints = [replace(j, **change) if j.number == number else j for j in design.joints]
    return replace(design, joints=tuple(joints))


def test_a_plan_is_in_steps_that_can_be_built(result: Result) -> None:
    assert off_steps(result.design, result.request) == ()
    assert result.reasons == ()


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (
            {"alpha_closed_deg": 139.04},
            r"alpha_closed of joint 2 (139.04 deg) is not in whole threads",
        ),
        ({"centre_mm": 33.349863}, "the place of joints 2 and 3 is not in steps of 2 or 1 mm"),
    ],
)
def test_numbers_that_cannot_be_built(result: Result, change: dict[str, float], says: str) -> None:
    design = changed(result.design, 2, **change)
    (said,) = off_steps(design, result.request)
    assert said == says
    anything = replace(result.request, alpha_step_deg=0.0, place_step_mm=0.0)
    assert off_steps(design, anything) == ()
    (reason,) = broken(replace(result, design=design))
    assert says in reason
    assert "`max_pressure_bar`" in reason


def test_a_pressure_that_no_gauge_can_be_set_to(result: Result) -> None:
    fine = replace(result.design, pressure_bar=0.481487)
    assert off_steps(fine, result.request) == ("the pressure, 0.4815 bar, is finer than 0.01 bar",)
    assert off_steps(replace(fine, pressure_bar=0.48), result.request) == ()


def test_steps_of_the_users_own(result: Result) -> None:
    twelve = replace(result.request, alpha_step_deg=12.0)
    design = result.design
    for joint in design.joints:
        design = changed(design, joint.number, alpha_closed_deg=132.0)
    assert off_steps(design, twelve) == ()
    off = changed(design, 1, alpha_closed_deg=12.0 * THREAD)
    assert "steps of 12 deg" in off_steps(off, twelve)[0]


def test_the_papers_method_has_steps_of_its_own(result: Result) -> None:
    design = changed(result.design, 2, centre_mm=33.35)
    assert off_steps(design, replace(result.request, method="paper")) == ()


def checked(result: Result, **state: object) -> Result:
    """The result as if finite elements had bent it as its model does."""
    design, shape = result.design, result.plan.bent
    none = tuple(0.0 for _ in design.joints)
    ones = tuple(1.5 for _ in design.joints)
    bent = FeState(
        design.pressure_bar, none, shape, shape.axis, 1.0, ones, 1.5, 0.9, 0.0, 5.0, 0.0, 0.0, False
    )
    found = Verification(bent, (replace(bent, **state),), 1.0, None, 1, 1, 1, 1, 1.0)
    design = replace(design, verified=True)
    return replace(result, design=design, check=Check(design, Run(found, None), None))


def test_a_tube_that_runs_into_itself_is_no_design(result: Result) -> None:
    good = checked(result)
    assert holding(good) is good
    assert broken(good) == ()
    curled = checked(result, touches=True, overlap_mm=2.06)
    held = holding(curled)
    assert held.design.verified is False
    assert held.check is not None
    assert held.check.design == held.design
    assert held.check.failure == "the bent tube runs into itself by 2.1 mm"
    (reason,) = broken(held)
    assert reason.startswith("the bent tube runs into itself by 2.1 mm: leave out")
    # A run that ended early says nothing of the tube at its pressure.
    ended = replace(curled.check.run.verification, critical=CriticalPoint("limit point", 0.5))
    early = replace(curled, check=replace(curled.check, run=Run(ended, None), failure="ended"))
    assert holding(early) is early


def test_numbers_that_cannot_be_built_are_not_verified(result: Result) -> None:
    good = checked(result)
    off = replace(good, design=changed(good.design, 2, alpha_closed_deg=139.04))
    held = holding(off)
    assert held.design.verified is False
    assert "139.04 deg" in held.check.failure


def test_a_place_too_far_off(result: Result) -> None:
    profile, request = result.profile, replace(result.request, tolerance_mm=0.5)

    def judged(most: float) -> tuple[str, ...]:
        fit = result.design.fit
        off = replace(fit.response or fit.formula, rms_mm=0.4, max_mm=most)
        design = replace(result.design, fit=replace(fit, response=off))
        assert not_good(design, profile, request, ()) == ()
        return far_off(design, profile, request, ())

    assert judged(0.99 * WORST * 0.5) == ()
    (reason,) = judged(1.01 * WORST * 0.5)
    assert "more than 3 times the 0.50 mm" in reason
