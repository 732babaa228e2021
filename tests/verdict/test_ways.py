"""Ways out of an infeasible design: other options that were tried, and work."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from profiletool import design
from profiletool.errors import Infeasible
from profiletool.files.formula import formula_for
from profiletool.records.design import Misfit
from profiletool.records.making import changed_request, request_of
from profiletool.records.options import in_flags
from profiletool.records.profile import DrawnLine
from profiletool.records.request import Request
from profiletool.records.way import Way, WaysOut
from profiletool.subject.find import find_subject
from profiletool.verdict import ways
from profiletool.verdict.trials import Family, Situation, Trial, alone, promising, together
from tests.calls import call, error_of
from tests.curves import turning_line

S_CURVE = turning_line((37.5 * np.pi, 270.0), (37.5 * np.pi, -270.0))


def situation(points: np.ndarray, **asked: Any) -> Situation:
    request = replace(
        request_of(Path("line.csv"), {"verify": False, **asked}), given=DrawnLine(points, False)
    )
    subject = find_subject(request, lambda line: None)
    return Situation(request, subject, formula_for(request), 3.21)


def test_a_way_out_in_words() -> None:
    way = Way((("outer_diameter_mm", 16), ("wall_mm", 1.6)), 0.9, "FE")
    assert in_flags(str(way)) == "--diameter 16 --wall 1.6 reaches 0.90 mm RMS by FE"
    none = WaysOut((), ("a longer tube", "the other side"))
    assert str(none) == "nothing that was tried works: a longer tube, the other side"


def test_values_of_a_request_by_name() -> None:
    request = changed_request(Request(Path("a")), {"start_pct": 12, "wall_mm": 1.6})
    assert request == replace(
        Request(Path("a")), start_pct=12, tube=replace(Request(Path("a")).tube, wall_mm=1.6)
    )


def test_the_least_trial_of_a_family_that_is_enough() -> None:
    looked: list[float] = []

    class Known(Situation):
        def promising(self, trial: Trial) -> bool:
            looked.append(trial.much)
            return trial.much >= 0.5

    family = Family("numbers", tuple(Trial({}, 0.1 * k) for k in range(1, 8)))
    at = Known(Request(Path("a")), None, None, None)  # type: ignore[arg-type]
    left = promising(at, family)
    assert [trial.much for trial in left.trials] == pytest.approx([0.5, 0.6, 0.7])
    assert len(looked) <= 3
    none = Family("numbers", (Trial({}, 0.1), Trial({}, 0.2)))
    assert promising(at, none).trials == ()


@pytest.mark.parametrize(
    ("asked", "first", "absent"),
    [
        ({"joints": 2}, {"joints": 3}, "tolerance_mm"),
        ({"tolerance_mm": 0.1}, {"tolerance_mm": 3.25}, "joints"),
        ({"pressure_bar": 1.0}, {"pressure_bar": 1.1}, "max_pressure_bar"),
        ({"max_length_mm": 200.0}, {"max_length_mm": 260.0}, "pressure_bar"),
        ({"method": "paper"}, {"method": "optimal"}, "pressure_bar"),
        ({"start_pct": 10.0}, {"start_pct": 14}, "pressure_bar"),
    ],
)
def test_trials_follow_from_what_was_asked(
    asked: dict[str, Any], first: dict[str, Any], absent: str
) -> None:
    at = situation(S_CURVE, **asked)
    found = [trial.changes for family in alone(at) for trial in family.trials]
    assert first in found
    assert not any(absent in changes for changes in found)
    # An open line has one side, and two changes at once are larger than each.
    assert not any("side" in changes for changes in found)
    assert all(len(t.changes) >= 2 for family in together(at) for t in family.trials)


def test_a_rough_search_tells_what_is_worth_trying() -> None:
    at = situation(S_CURVE)
    assert not at.promising(Trial({"start_pct": 4}, 0.04))
    assert at.promising(Trial({"outer_diameter_mm": 10, "wall_mm": 1.0, "pitch_mm": 1.0}, 0.5))
    assert not at.promising(Trial({"start_pct": 100}, 1.0))  # refused is no way out


@pytest.mark.trials
def test_trials_end_though_none_works(monkeypatch: pytest.MonkeyPatch) -> None:
    chosen: list[Trial] = []
    monkeypatch.setattr(Situation, "promising", lambda *_: True)
    monkeypatch.setattr(ways, "_way", lambda _at, trial, _bend: chosen.append(trial))
    found = ways.ways_out(situation(S_CURVE), lambda line: None, None)
    assert found.ways == ()
    assert len(chosen) == 8
    assert "tubes of down to 10 mm" in found.tried
    first = [trial.much for trial in chosen[:4]]
    assert first == sorted(first)


@pytest.mark.trials
def test_no_attempt_at_all_is_refused_with_what_was_tried(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Situation, "promising", lambda *_: False)

    def fails(*_: object, **__: object) -> None:
        raise Infeasible("no joints follow")

    monkeypatch.setattr("profiletool.pipeline.optimal_plan", fails)
    with pytest.raises(Infeasible, match="no joints follow; nothing that was tried works"):
        design(DrawnLine(S_CURVE, False), verify=False)


@pytest.mark.slow
@pytest.mark.trials
def test_the_option_that_a_refusal_ends_with_works(tmp_path: Path) -> None:
    np.savetxt(tmp_path / "s.csv", S_CURVE, delimiter=",", fmt="%.4f")
    out = ("--no-verify", "--quiet", "--out", tmp_path / "out", "--force")
    refused = call("design", tmp_path / "s.csv", *out)
    assert refused.exit_code == 6
    way = re.search(r"tried, and it works: (--.*?) reaches ([0-9.]+) mm", error_of(refused))
    assert way is not None
    shown = call("design", tmp_path / "s.csv", *way[1].split(), *out)
    assert shown.exit_code == 0
    assert f"by the joint response off the profile: {way[2]} mm RMS" in shown.stdout


def test_finite_elements_are_claimed_only_where_they_ran(monkeypatch: pytest.MonkeyPatch) -> None:
    points = turning_line((30.0, 0.0), (40.0, 40.0), (20.0, 0.0))
    at = situation(points, verify=True, method="paper", tolerance_mm=3.0)  # quick to plan
    trial = Trial({"start_pct": 4}, 0.04)
    alone_way = ways._way(at, trial, None)
    assert alone_way is not None
    assert alone_way.by == "the formula alone"

    def bend(request: Request, subject: Any) -> Any:
        draft = ways._planned(at, request, subject)
        fit = replace(draft.design.fit, fe=Misfit(0.5, 0.6))
        return replace(draft, design=replace(draft.design, fit=fit, verified=verified))

    verified = True
    by_fe = ways._way(at, trial, bend)
    assert by_fe == Way((("start_pct", 4),), 0.5, "FE")
    verified = False
    assert ways._way(at, trial, bend) is None
