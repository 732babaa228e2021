from __future__ import annotations

import csv
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from formula.errors import OutOfRange
from formula.files import load_formula
from formula.table import Table, assign, make_table

PAPER = load_formula()
WIDE = make_table(PAPER, openF_mm=(6, 8, 10, 12, 14))


def test_table_4_but_for_its_misprint(shared: Path) -> None:
    table = make_table(PAPER)
    with (shared / "reference" / "table4_theta.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == table.theta_deg.size == 336
    off = []
    for row in rows:
        key = [float(row[c]) for c in ("pressure_bar", "openF_mm", "alpha_closed_deg")]
        axes = (table.pressures_bar, table.openF_mm, table.alpha_deg)
        cell = tuple(axis.index(value) for axis, value in zip(axes, key, strict=True))
        if abs(table.theta_deg[cell] - float(row["theta_deg"])) > 0.06:
            off.append((key, float(row["theta_deg"])))
    assert off == [([2.0, 10.0, 120.0], 44.9)]


def test_table_5_by_the_look_up(shared: Path) -> None:
    with (shared / "reference" / "table5_bulb.csv").open() as file:
        rows = list(csv.DictReader(file))
    result = assign(
        WIDE, [float(r["openF_mm"]) for r in rows], [float(r["theta_deg"]) for r in rows]
    )
    assert result.pressure_bar == 1.9
    assert result.alpha_closed_deg == tuple(float(r["alpha_closed_deg"]) for r in rows)


def small(theta: list[list[list[float]]]) -> Table:
    array = np.array(theta)
    inside = np.zeros_like(array, dtype=bool)
    return Table((1.0, 2.0), (6.0, 8.0)[: array.shape[1]], (90.0, 120.0), array, inside)


def test_least_excess_over_all_rows() -> None:
    table = small([[[20.0, 12.0]], [[40.0, 15.0]]])
    assert assign(table, [6], [13.0]).pressure_bar == 2.0
    assert assign(table, [6], [16.0]).pressure_bar == 1.0


def test_equal_excess_takes_the_lower_pressure() -> None:
    assert assign(small([[[20.0, 12.0]], [[40.0, 20.0]]]), [6], [20.0]).pressure_bar == 1.0


def test_a_row_that_leaves_another_joint_short_is_passed_over() -> None:
    table = small([[[10.0, 5.0], [30.0, 20.0]], [[25.0, 9.0], [60.0, 31.0]]])
    result = assign(table, [8, 6], [30.0, 20.0])
    assert result == type(result)(2.0, (120.0, 90.0), (31.0, 25.0), (False, False))


def test_out_of_reach_names_the_joint_and_the_limit() -> None:
    with pytest.raises(OutOfRange, match=r"joint 2: 60\.0 deg .* 8 mm .* 2 bar \(41\.9 deg\)"):
        assign(WIDE, [8, 8], [30.0, 60.0])


def test_no_row_for_all() -> None:
    table = small([[[30.0, 5.0], [8.0, 7.0]], [[10.0, 9.0], [31.0, 20.0]]])
    with pytest.raises(OutOfRange, match="no single pressure"):
        assign(table, [6, 8], [29.0, 30.0])


def test_openF_outside_the_table() -> None:
    with pytest.raises(OutOfRange, match="openF 7 mm is not in the table"):
        assign(WIDE, [7], [30.0])


@pytest.mark.parametrize(
    ("axis", "value"), [("openF_mm", 16.0), ("pressures_bar", 2.3), ("alpha_deg", 60.0)]
)
def test_rows_and_columns_outside_the_formula(axis: str, value: float) -> None:
    with pytest.raises(OutOfRange, match="outside"):
        make_table(PAPER, **{axis: (value,)})


def test_of_equal_leads_the_shortest_cut_sets_the_pressure() -> None:
    table = small([[[20.0, 12.0], [20.0, 12.0]], [[30.0, 20.0], [40.0, 25.0]]])
    # At 1 bar both reach 20 exactly; only the 6 mm cut has 20 in the second row too.
    assert assign(table, [8, 6], [19.0, 19.0]).pressure_bar == 1.0
    apart = small([[[15.0, 12.0], [20.0, 12.0]], [[30.0, 20.0], [40.0, 25.0]]])
    assert assign(apart, [8, 6], [20.0, 20.0]).pressure_bar == 2.0


def test_default_rows_follow_the_range_of_the_formula() -> None:
    narrow = replace(
        PAPER,
        alpha_range_deg=(90.0, 150.0),
        openF_range_mm=(8.0, 12.0),
        pressure_range_bar=(0.0, 1.5),
    )
    table = make_table(narrow)
    assert (table.alpha_deg[0], table.alpha_deg[-1]) == (96.0, 144.0)
    assert table.openF_mm == (8.0, 10.0)
    assert table.pressures_bar[-1] == 1.5
    with pytest.raises(OutOfRange, match="none of"):
        make_table(replace(PAPER, openF_range_mm=(20.0, 30.0)))


def test_of_equal_leads_the_row_of_the_shortest_cut_is_taken() -> None:
    table = small([[[20.5, 12.0], [22.0, 13.0]], [[21.0, 15.0], [20.1, 16.0]]])
    assert assign(table, [8, 6], [20.0, 20.0]).pressure_bar == 1.0
