"""The commands `table` and `assign`."""

from __future__ import annotations

import csv
import io
import json

import pytest

from tests.calls import call, error_of


def test_table_as_csv_json_and_text() -> None:
    rows = list(csv.DictReader(io.StringIO(call("table", "--csv").stdout)))
    assert len(rows) == 336
    assert rows[0] == {
        "pressure_bar": "0.20", "openF_mm": "6", "alpha_closed_deg": "84", "theta_deg": "1.89",
    }  # fmt: skip
    cells = json.loads(call("table", "--json").stdout)
    assert [round(cell["theta_deg"], 2) for cell in cells] == [float(r["theta_deg"]) for r in rows]
    assert call("table").stdout.count("theta (deg)") == 3
    assert call("table", "--openF", "20").exit_code == 2


def test_assign_the_papers_bulb() -> None:
    options = ("--openF", "8,8,8,8,6,10", "--theta", "30,30,30,25,20,45")
    found = json.loads(call("assign", *options, "--json").stdout)
    assert found["pressure_bar"] == 1.9
    assert found["alpha_closed_deg"] == [132, 132, 132, 144, 144, 108]
    assert "pressure 1.90 bar" in call("assign", *options).stdout


@pytest.mark.parametrize(
    ("openF", "theta", "code"),
    [("8,8", "30", 2), ("8,x", "30,30", 2), ("8", "-30", 2), ("8", "60", 6), ("20", "30", 6)],
)
def test_assign_refuses(openF: str, theta: str, code: int) -> None:
    result = call("assign", "--openF", openF, "--theta", theta)
    assert result.exit_code == code
    error_of(result)
