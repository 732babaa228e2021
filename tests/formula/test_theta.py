from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
import pytest

from formula.errors import BadFormula
from formula.files import campaign_of, load_formula, parse_formula, shipped
from formula.theta import beyond, paper_terms, theta_deg, widened

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


def test_files_of_any_polynomial() -> None:
    tree = {
        "schema": "profiletool.formula/2",
        "name": "mine",
        "terms": [[[1.0, 2.0, 3.0], [0.0, 0.5, 0.0]], [[0.0, 0.0, 1.0], [2.0, 0.0, 0.0]]],
        "domain": {
            **FILE["domain"],
            "rubber": {"name": "x", "C10_MPa": 0.1, "C01_MPa": 0.05, "K_MPa": 3.0},
        },
    }
    formula = parse_formula(json.dumps(tree).encode(), "x.json")
    a, o, P = 1.5, 3.0, 0.5
    by_hand = (1 + 2 * a + 3 * a * a) * P + 0.5 * a * P**2 + o * (a * a * P + 2 * P**2)
    assert theta_deg(formula, a, o, P) == pytest.approx(by_hand, rel=1e-14)
    assert formula.rubber is not None
    assert formula.rubber.constants == {"C10": 0.1, "C01": 0.05, "K": 3.0}
    assert formula.rubber.law == "mooney-rivlin"


@pytest.mark.parametrize(
    "terms",
    [None, [], [[]], [[[1.0, 2.0]]], [[[1.0, 2.0, "x"]]], [[[1, 2, 3]], [[1, 2, 3], [1, 2, 3]]]],
)
def test_terms_that_make_no_sense(terms: object) -> None:
    tree = {"schema": "profiletool.formula/2", "terms": terms, "domain": FILE["domain"]}
    with pytest.raises(BadFormula, match="terms"):
        parse_formula(json.dumps(tree).encode(), "x.json")


def test_a_rubber_by_its_law() -> None:
    rubber = {"name": "x", "law": "ogden", "constants": {"mu": [0.1, 0.2], "alpha": [2, 4], "K": 3}}
    domain = {**FILE["domain"], "rubber": rubber}
    formula = parse_formula(json.dumps({**FILE, "domain": domain}).encode(), "x.json")
    assert formula.rubber is not None
    assert formula.rubber.law == "ogden"
    assert formula.rubber.constants == {"mu": (0.1, 0.2), "alpha": (2.0, 4.0), "K": 3.0}


@pytest.mark.parametrize(
    "rubber",
    [
        {"name": "x", "C10_MPa": 0.1, "C01_MPa": 0.05},
        {"name": "x", "C10_MPa": True, "C01_MPa": 0.05, "K_MPa": 3.0},
        {"name": "x", "law": "yeoh"},
        {"name": "x", "law": 7, "constants": {}},
        {"name": "x", "law": "yeoh", "constants": {"C10": "much"}},
        {"name": "x", "law": "yeoh", "constants": {"C10": [1.0, None]}},
    ],
)
def test_rubber_that_makes_no_sense(rubber: dict[str, object]) -> None:
    with pytest.raises(BadFormula, match=r"rubber|finite"):
        parse_formula(
            json.dumps({**FILE, "domain": {**FILE["domain"], "rubber": rubber}}).encode(), "x.json"
        )


def test_formulas_that_come_along_go_by_their_names(tmp_path: Path) -> None:
    assert load_formula(Path("paper")) == PAPER
    assert "paper" in shipped()
    with pytest.raises(BadFormula, match=r"by name there are .*paper"):
        load_formula(Path("unknown"))


def test_a_file_called_paper_is_not_the_default(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "paper").write_text(json.dumps({**FILE, "name": "mine"}))
    monkeypatch.chdir(tmp_path)
    assert load_formula(Path("paper")).name == "mine"
    assert load_formula() == PAPER


def test_a_campaign_reads_back() -> None:
    campaign = {
        "alpha_closed_deg": [84, 120],
        "openF_mm": [8],
        "pressure_bar": [1.0, 2.0],
        "theta_deg": [[[10.0, 20.0]], [[5.0, None]]],
    }
    found = campaign_of(json.dumps({**FILE, "campaign": campaign}).encode(), "x.json")
    assert found is not None
    assert found.theta_deg[0, 0, 1] == 20.0
    assert np.isnan(found.theta_deg[1, 0, 1])
    assert campaign_of(json.dumps(FILE).encode(), "x.json") is None
    for change in (
        {"theta_deg": [[[1.0]]]},
        {"theta_deg": "x"},
        {"pressure_bar": [2.0, 1.0]},
        {"openF_mm": []},
        {"theta_deg": [[[10.0, 1e30]], [[5.0, 1.0]]]},
    ):
        broken = json.dumps({**FILE, "campaign": {**campaign, **change}}).encode()
        with pytest.raises(BadFormula):
            campaign_of(broken, "x.json")


def test_a_formula_that_may_be_extrapolated_says_where() -> None:
    wide = widened(PAPER)
    assert wide.openF_range_mm == (3.0, 21.0)
    assert wide.pressure_range_bar == (0.0, 3.0)
    assert theta_deg(wide, 100.0, 8.0, 1.0) == theta_deg(PAPER, 100.0, 8.0, 1.0)
    for formula in (PAPER, wide):
        out = beyond(
            formula, [84.0, 80.0, 100.0, 100.0], [6.0, 8.0, 15.0, 8.0], [2.0, 1.0, 1.0, 2.1]
        )
        assert out.tolist() == [False, True, True, True]
