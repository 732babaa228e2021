"""Tables and assignments as text, JSON and CSV."""

from __future__ import annotations

import csv
import io
import json

import numpy as np

from formula.table import Assignment, Table
from profiletool.report.text import (
    EXTRAPOLATED,
    assignment_json,
    assignment_text,
    theta_csv,
    theta_json,
    theta_text,
)

THETA = np.array([[[1.0, 2.04], [3.0, 4.06]], [[5.0, 6.0], [7.0, 8.0]]])
INSIDE = Table((0.5, 1.0), (6.0, 8.0), (84.0, 120.0), THETA, np.zeros((2, 2, 2), bool))
BEYOND = Table(
    (0.5, 1.0), (6.0, 8.0), (84.0, 120.0), THETA, np.arange(8).reshape(2, 2, 2) == 5
)  # fmt: skip


def test_a_table_has_a_block_for_each_openF_and_marks_what_is_beyond() -> None:
    assert theta_text(INSIDE).splitlines() == [
        "theta (deg) at openF 6 mm",
        "   bar     84    120  alpha deg",
        "  0.50    1.0    2.0",
        "  1.00    5.0    6.0",
        "theta (deg) at openF 8 mm",
        "   bar     84    120  alpha deg",
        "  0.50    3.0    4.1",
        "  1.00    7.0    8.0",
    ]
    marked = theta_text(BEYOND).splitlines()
    assert marked[3] == "  1.00    5.0   6.0*"
    assert marked[-1] == f"* {EXTRAPOLATED}"


def test_csv_and_json_hold_the_same_cells() -> None:
    for table in (INSIDE, BEYOND):
        rows = list(csv.DictReader(io.StringIO(theta_csv(table))))
        cells = json.loads(theta_json(table))
        assert len(rows) == len(cells) == 8
        for row, cell in zip(rows, cells, strict=True):
            assert float(row["theta_deg"]) == cell["theta_deg"]
            assert float(row["openF_mm"]) == cell["openF_mm"]
            assert row.get("extrapolated", "0") == ("1" if "extrapolated" in cell else "0")
    assert "extrapolated" not in theta_csv(INSIDE)
    assert [c for c in json.loads(theta_json(BEYOND)) if "extrapolated" in c] == [
        {"pressure_bar": 1.0, "openF_mm": 6.0, "alpha_closed_deg": 120.0, "theta_deg": 6.0,
         "extrapolated": True},
    ]  # fmt: skip


def test_an_assignment_names_the_joints_beyond() -> None:
    found = Assignment(1.9, (132.0, 108.0), (30.5, 45.25), (False, True))
    lines = assignment_text((8.0, 10.0), (30.0, 45.0), found).splitlines()
    assert lines[0] == "pressure 1.90 bar"
    assert lines[2].split() == ["1", "8", "30", "132", "30.5"]
    assert lines[-1] == f"note: joint 2: {EXTRAPOLATED}"
    assert json.loads(assignment_json(found))["warnings"] == [f"joint 2: {EXTRAPOLATED}"]
