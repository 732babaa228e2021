from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
import pytest

from formula.errors import BadFormula
from formula.files import load_formula, parse_formula
from formula.theta import paper_terms, theta_deg

PAPER = load_formula()
FILE = json.loads(
    (Path(__file__).parents[2] / "formula" / "coefficients" / "paper.json").read_text()
)


def test_one_angle_by_hand() -> None:
    # alpha 108, openF 10, 1.9 bar, worked out from Table 3 term by term.
    m = (-0.000166 * 108**2 + 0.031915 * 108 - 0.856229) * 1.9**2
    m += (-0.000009 * 108**2 - 0.000689 * 108 + 0.991593) * 1.9
    c = (-0.007112 * 108 + 4.051633) * 1.9
    assert theta_deg(PAPER, 108, 10, 1.9) == pytest.approx(10 * m + c, abs=1e-12)


def test_no_pressure_no_bending() -> None:
    assert np.all(theta_deg(PAPER, [84, 120, 168], [[6], [14]], 0.0) == 0.0)


def test_broadcasts() -> None:
    assert theta_deg(PAPER, np.ones(3), np.ones((2, 1)), np.ones((4, 1, 1))).shape == (4, 2, 3)


def test_coefficients_are_the_published_ones(shared: Path) -> None:
    with (shared / "reference" / "table3_coefficients.csv").open() as file:
        row = next(csv.DictReader(file))
    assert PAPER.terms == paper_terms([float(value) for value in row.values()])


def test_linear_in_openF() -> None:
    theta = theta_deg(PAPER, 100.0, [6.0, 10.0, 14.0], 1.5)
    assert theta[1] - theta[0] == pytest.approx(theta[2] - theta[1], abs=1e-12)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"schema": "other/1"}, "schema"),
        ({"coefficients": {}}, "c11"),
        ({"coefficients": None}, "coefficients"),
        ({"domain": {**FILE["domain"], "wall_mm": "two"}}, "wall_mm"),
        ({"domain": {**FILE["domain"], "openF_mm": [14, 6]}}, "empty"),
        ({"domain": {**FILE["domain"], "openF_mm": [6]}}, "pair"),
        ({"domain": {**FILE["domain"], "wall_mm": float("nan")}}, "wall_mm"),
    ],
)
def test_broken_formula_files_are_refused(change: dict[str, object], says: str) -> None:
    with pytest.raises(BadFormula, match=says):
        parse_formula(json.dumps({**FILE, **change}).encode(), "x.json")


def test_not_json_and_not_there(tmp_path: Path) -> None:
    with pytest.raises(BadFormula, match="not JSON"):
        parse_formula(b"\xff{", "x.json")
    with pytest.raises(BadFormula, match="cannot read"):
        load_formula(tmp_path / "absent.json")


def test_a_written_formula_reads_back(tmp_path: Path) -> None:
    path = tmp_path / "mine.json"
    path.write_text(json.dumps({**FILE, "name": "mine"}))
    mine = load_formula(path)
    assert mine.name == "mine"
    assert mine.terms == PAPER.terms
    assert mine.sha256 != PAPER.sha256


@pytest.mark.parametrize("text", ["[" * 100_000, '{"schema": "profiletool.formula/1"}'])
def test_hostile_formula_files(text: str) -> None:
    with pytest.raises(BadFormula):
        parse_formula(text.encode(), "x.json")


def test_numbers_beyond_reason_are_refused() -> None:
    huge = {**FILE, "domain": {**FILE["domain"], "wall_mm": 10**400}}
    with pytest.raises(BadFormula, match="wall_mm"):
        parse_formula(json.dumps(huge).encode(), "x.json")
    same = {**FILE, "domain": {**FILE["domain"], "openF_mm": [8, 8]}}
    with pytest.raises(BadFormula, match="empty"):
        parse_formula(json.dumps(same).encode(), "x.json")
