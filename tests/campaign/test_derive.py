"""From runs to a formula file, with runs that a formula makes up in no time."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fem.material import PAPER_RUBBER, MooneyRivlin
from formula.files import load_formula, parse_formula
from formula.theta import theta_deg
from profiletool.campaign.derive import Base, CampaignPlan, check_plan, derive, load_base, similar
from profiletool.campaign.formula_file import formula_file
from profiletool.campaign.runs import Outcome, Task
from profiletool.errors import NotVerified, UnreadableInput, UsageError
from profiletool.report.derivation import derivation_files, derivation_text
from profiletool.rubber.presets import PRESETS, Rubber

PAPER = load_formula()
PLAN = CampaignPlan(
    diameter_mm=20.0,
    wall_mm=2.0,
    rubber=PRESETS["paper"],
    alpha_deg=(84.0, 108.0, 120.0, 132.0, 156.0),
    openF_mm=(6.0, 8.0, 10.0, 12.0, 14.0),
    pressures_bar=tuple(round(0.2 * k, 9) for k in range(1, 11)),
)
SMALL = replace(
    PLAN, diameter_mm=16.0, wall_mm=1.6, openF_mm=(4.8, 8.0, 11.2), alpha_deg=(84.0, 110.0, 156.0)
)


class Made:
    """Runs by formula (9) and similarity, times a factor; the tasks are kept."""

    def __init__(self, factor: float = 1.0, reached: int = 10) -> None:
        self.tasks: list[Task] = []
        self.factor, self.reached = factor, reached

    def __call__(self, tasks: Sequence[Task]) -> list[Outcome]:
        self.tasks += tasks
        return [self.outcome(task) for task in tasks]

    def outcome(self, task: Task) -> Outcome:
        law = task.rubber
        stiffness = (law.C10 + law.C01) / (PAPER_RUBBER.C10 + PAPER_RUBBER.C01)
        all_of_it = task.alpha_deg > 84.0
        pressures = task.pressures_bar if all_of_it else task.pressures_bar[: self.reached]
        theta = self.factor * theta_deg(
            PAPER,
            task.alpha_deg,
            task.openF_mm * 20.0 / task.diameter_mm,
            np.array(pressures) / stiffness,
        )
        values = tuple(theta.tolist())
        failure = None if len(pressures) == len(task.pressures_bar) else "limit point at 1.7 bar"
        return Outcome(pressures, values, values, values, failure)


def base() -> Base:
    data = formula_file(derive(PLAN, Made()), "whole")
    return Base(parse_formula(data, "whole.json"), derive(PLAN, Made()).data)


def test_a_campaign_runs_every_pair_once_and_gives_its_formula_back() -> None:
    made = Made()
    found = derive(PLAN, made)
    assert len(made.tasks) == len(set(made.tasks)) == 25
    assert {task.pressures_bar for task in made.tasks} == {PLAN.pressures_bar}
    formula = parse_formula(formula_file(found, "mine"), "mine.json")
    at = (np.linspace(84, 156, 7), np.linspace(6, 14, 7), 1.7)
    np.testing.assert_allclose(theta_deg(formula, *at), theta_deg(PAPER, *at), atol=1e-9)
    assert formula.alpha_range_deg == (84.0, 156.0)
    assert formula.openF_range_mm == (6.0, 14.0)
    assert formula.pressure_range_bar == (0.0, 2.0)
    assert formula.rubber is not None
    assert formula.rubber.constants == PAPER_RUBBER.constants


def test_the_file_says_how_good_it_is_and_holds_the_campaign(tmp_path: Path) -> None:
    found = derive(PLAN, Made())
    data = formula_file(found, "mine")
    assert data == formula_file(derive(PLAN, Made()), "mine")
    tree = json.loads(data)
    assert tree["fit"]["cross_validated_rms_deg"] == pytest.approx(0.0, abs=1e-6)
    assert tree["paper_form"]["coefficients"]["c32"] == pytest.approx(4.051633, rel=1e-6)
    assert tree["paper_form"]["R2"]["theta_openF_least"] == 1.0
    assert tree["campaign"]["runs"] == 25
    path = tmp_path / "mine.json"
    path.write_bytes(data)
    again = load_base(str(path))
    np.testing.assert_allclose(again.data.theta_deg, found.data.theta_deg, atol=1e-6)


def test_runs_that_end_early_are_left_out_and_told() -> None:
    found = derive(PLAN, Made(reached=8))
    assert len(found.failures) == 5
    assert found.failures[0] == (84.0, 6.0, "limit point at 1.7 bar")
    assert np.isnan(found.data.theta_deg[0, :, 8:]).all()
    tree = json.loads(formula_file(found, "x"))
    assert tree["failures"][0]["reason"] == "limit point at 1.7 bar"
    assert tree["campaign"]["theta_deg"][0][0][9] is None
    assert "limit point at 1.7 bar" in derivation_text(found)


def test_nothing_that_runs() -> None:
    def none(tasks: Sequence[Task]) -> list[Outcome]:
        return [Outcome((), (), (), (), "not converged beyond 0 bar") for _ in tasks]

    with pytest.raises(NotVerified, match="25 runs ended early"):
        derive(PLAN, none)


def test_another_tube_by_five_runs() -> None:
    made = Made(factor=1.07)
    found = derive(SMALL, made, base())
    assert len(made.tasks) == 5
    assert {task.diameter_mm for task in made.tasks} == {16.0}
    whole = derive(SMALL, Made(factor=1.07))
    np.testing.assert_allclose(found.data.theta_deg, whole.data.theta_deg, rtol=2e-3)
    tree = json.loads(formula_file(found, "small"))
    assert tree["base"]["name"] == "whole"
    assert tree["campaign"]["runs"] == 5
    assert similar(SMALL, base())


def test_a_harder_rubber_by_five_runs() -> None:
    twice = Rubber("twice", MooneyRivlin(0.1388, 0.1256, 2.0 * PAPER_RUBBER.K), "made up")
    plan = replace(PLAN, rubber=twice)
    found = derive(plan, Made(), base())
    np.testing.assert_allclose(found.data.theta_deg, derive(plan, Made()).data.theta_deg, rtol=2e-3)
    assert similar(plan, base())


def test_what_the_known_campaign_does_not_reach() -> None:
    soft = Rubber("soft", MooneyRivlin(0.0347, 0.0314, 0.5 * PAPER_RUBBER.K), "made up")
    with pytest.raises(UsageError, match="lower `max_pressure_bar`"):
        derive(replace(PLAN, rubber=soft), Made(), base())
    with pytest.raises(UsageError, match="alphas"):
        derive(replace(PLAN, alpha_deg=(60.0, 84.0, 120.0)), Made(), base())


def test_another_shape_is_not_similar() -> None:
    assert not similar(replace(PLAN, wall_mm=2.5), base())
    hard = Rubber("neo", MooneyRivlin(0.1322, 0.0, PAPER_RUBBER.K), "made up")
    assert not similar(replace(PLAN, rubber=hard), base())


def test_bases_that_are_none(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="holds no campaign"):
        load_base("paper")
    (tmp_path / "x.json").write_text("{}")
    with pytest.raises(UnreadableInput, match="no formula file"):
        load_base(str(tmp_path / "x.json"))


def test_joints_that_cannot_be_are_refused_before_any_run() -> None:
    with pytest.raises(UsageError, match="wall"):
        check_plan(replace(PLAN, wall_mm=11.0))
    check_plan(PLAN)


def test_few_runs_leave_out_the_papers_steps() -> None:
    found = derive(replace(PLAN, alpha_deg=(100.0,), openF_mm=(8.0, 10.0)), Made())
    assert found.paper is None
    files = derivation_files(found)
    assert "coefficients_vs_alpha.png" not in files
    assert b"too few runs" in files["report.txt"]


@pytest.mark.slow
def test_figures_and_residuals() -> None:
    files = derivation_files(derive(PLAN, Made(reached=8)))
    pictures = [name for name in files if name.endswith(".png")]
    assert len(pictures) == 5
    assert all(files[name].startswith(b"\x89PNG") for name in pictures)
    rows = files["residuals.csv"].decode().splitlines()
    assert len(rows) == 251
    head = rows[0].split(",")
    for row in (rows[1], rows[-1]):
        cells = dict(zip(head, row.split(","), strict=True))
        assert float(cells["theta_formula_deg"]) == pytest.approx(
            float(cells["theta_fe_deg"]), abs=2e-4
        )
    assert rows[10].split(",")[3] == ""  # alpha 84, openF 6, 2.0 bar was not reached
