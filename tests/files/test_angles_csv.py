"""Measured angles as a table, with as many columns as somebody has."""

from __future__ import annotations

from pathlib import Path

import pytest

from profiletool.errors import UnreadableInput
from profiletool.files.angles_csv import COLUMNS, read_angles
from profiletool.records.setting import AngleReading


def written(folder: Path, text: str) -> Path:
    (folder / "angles.csv").write_text(text)
    return folder / "angles.csv"


def test_all_columns_and_lost_rows(tmp_path: Path) -> None:
    head = ",".join(COLUMNS)
    file = written(
        tmp_path,
        f"{head}\na.png,1.6,1,20.5,0.4,measured\na.png,1.6,2,99,0.4,lost\n"
        "b.png,1.67,2,-8.25,,by hand\nb.png,1.67,3,,,lost\n",
    )
    assert read_angles(file) == (
        AngleReading(1.6, 1, 20.5, 0.4),
        AngleReading(1.67, 2, -8.25, 1.0),
    )


def test_three_columns_in_any_order_as_a_spreadsheet_has_them(tmp_path: Path) -> None:
    file = written(tmp_path, '"theta_deg";Joint;pressure_bar\n"20,5";1;1,6\n# a remark\n8;2;1,6\n')
    assert read_angles(str(file)) == (AngleReading(1.6, 1, 20.5), AngleReading(1.6, 2, 8.0))


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "no column pressure_bar"),
        ("1.6,1,20\n", "no column pressure_bar"),
        ("pressure_bar,joint\n1.6,1\n", "no column theta_deg"),
        ("pressure_bar,joint,theta_deg\n", "no angle"),
        ("pressure_bar,joint,theta_deg,state\n1.6,1,2,lost\n", "no angle"),
        ("pressure_bar,joint,theta_deg\n1.6,1\n", "line 2 has 2 fields"),
        ("pressure_bar,joint,theta_deg\n1.6,1,x\n", "line 2: theta_deg 'x' is no number"),
        ("pressure_bar,joint,theta_deg\n1.6,1,1e999\n", "is no number"),
        ("pressure_bar,joint,theta_deg\n1.6,1.5,3\n", "joints are counted"),
        ("pressure_bar,joint,theta_deg\n1.6,0,3\n", "joints are counted"),
        ("pressure_bar,joint,theta_deg\n-1,1,3\n", "a pressure of -1 bar"),
        ("pressure_bar,joint,theta_deg,sigma_deg\n1,1,3,0\n", "sigma_deg must be above 0"),
    ],
)
def test_refused(tmp_path: Path, text: str, said: str) -> None:
    with pytest.raises(UnreadableInput, match=said) as caught:
        read_angles(written(tmp_path, text))
    assert "angles.csv" in str(caught.value)
    with pytest.raises(UnreadableInput, match="no such file"):
        read_angles(tmp_path / "absent.csv")
