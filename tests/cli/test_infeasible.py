"""Designs that fall short: exit 6 and the best attempt, exit 7 and the design not verified."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.calls import call, error_of
from tests.cli.inputs import REST, arc, ending_early, never_converging, unverified


@pytest.mark.usefixtures("few_files")
def test_exit_6_writes_the_best_attempt(tmp_path: Path) -> None:
    (tmp_path / "corner.csv").write_text("0,80\n0,0\n80,0\n")
    result = unverified("corner.csv", "--method", "paper")
    assert result.exit_code == 6
    assert "marked infeasible" in error_of(result)
    written = json.loads((tmp_path / "corner_design" / "design.json").read_text())
    assert written["feasible"] is False
    assert "INFEASIBLE" in (tmp_path / "corner_design" / "template.svg").read_text()


@pytest.mark.usefixtures("few_files")
@pytest.mark.parametrize(
    ("options", "says"),
    [(("--diameter", "16"), "--formula"), (("--max-length", "60"), "--max-length")],
)
def test_exit_6_for_other_limits(
    options: tuple[str, ...], says: str, samples: Path, tmp_path: Path
) -> None:
    result = unverified(samples / "egg.png", "--method", "paper", *options)
    assert result.exit_code == 6
    assert says in error_of(result)


@pytest.mark.slow
@pytest.mark.usefixtures("few_files")
def test_exit_6_for_a_shape_that_is_not_good_enough(tmp_path: Path) -> None:
    (tmp_path / "corner.csv").write_text("0,80\n0,0\n80,0\n")
    result = unverified("corner.csv", "--tolerance", "0.1", "--joints", "1")
    assert result.exit_code == 6
    assert "more than 0.10 mm RMS" in error_of(result)
    written = json.loads((tmp_path / "corner_design" / "design.json").read_text())
    assert written["method"] == "optimal"
    assert written["feasible"] is False
    assert written["fit"]["response"]["rms_mm"] > 0.1
    assert "INFEASIBLE" in (tmp_path / "corner_design" / "template.svg").read_text()


@pytest.mark.usefixtures("few_files", "coarse_mesh")
@pytest.mark.parametrize(
    ("failing", "says"),
    [
        pytest.param(ending_early, "limit point", marks=pytest.mark.slow),
        (never_converging, "no equilibrium found"),
    ],
)
@pytest.mark.parametrize("method", [pytest.param("paper", marks=pytest.mark.slow), "optimal"])
def test_exit_7_writes_the_design_marked_not_verified(
    failing: Callable[[pytest.MonkeyPatch], None],
    says: str,
    method: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    failing(monkeypatch)
    result = call("design", arc(tmp_path), "--method", method, "--no-refine")
    assert result.exit_code == 7
    assert says in error_of(result)
    folder = tmp_path / "arc_design"
    design = json.loads((folder / "design.json").read_text())
    assert design["verified"] is False
    assert design["fit"]["fe"] is None
    assert all(joint["theta_fe_deg"] is None for joint in design["joints"])
    assert any(w.startswith("NOT VERIFIED: finite elements: ") for w in design["warnings"])
    assert "NOT VERIFIED" in (folder / "template.svg").read_text()
    assert not (folder / "actuator.vtu").exists()
    # What there is of the angles is worth having.
    assert (folder / "theta_vs_pressure.csv").exists() == (failing is ending_early)
    assert "FE deg" not in result.stdout


@pytest.mark.slow
@pytest.mark.usefixtures("few_files")
def test_exit_7_where_no_choice_of_joints_stands(
    samples: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    never_converging(monkeypatch)
    result = call("design", samples / REST)  # with refinement, which cannot even begin
    assert result.exit_code == 7
    assert "no equilibrium found beyond 0.01 bar" in error_of(result)
    design = json.loads((tmp_path / "finger_rest_design" / "design.json").read_text())
    (note,) = (w for w in design["warnings"] if "did not stand by FE" in w)
    assert note == (
        "the first choice of joints did not stand by FE: no equilibrium found beyond 0.01 bar"
    )
    assert design["method"] == "optimal"
    assert design["verified"] is False
    assert design["feasible"] is True
    assert design["sensitivity"] == []


@pytest.mark.usefixtures("few_files")
@pytest.mark.parametrize("method", ["paper", pytest.param("optimal", marks=pytest.mark.slow)])
def test_exit_6_wins_over_exit_7(
    method: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    never_converging(monkeypatch)
    (tmp_path / "corner.csv").write_text("0,80\n0,0\n80,0\n")
    result = call("design", "corner.csv", "--method", method, "--tolerance", "0.1")
    assert result.exit_code == 6
    design = json.loads((tmp_path / "corner_design" / "design.json").read_text())
    assert design["verified"] is False
    assert any("NOT VERIFIED" in warning for warning in design["warnings"])
