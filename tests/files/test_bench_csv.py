"""Pressures over time, and lines drawn by hand, as tables."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from profiletool.errors import UnreadableInput
from profiletool.files.angles_csv import read_angles, write_angles
from profiletool.files.bench_csv import read_hand_lines, read_times
from profiletool.records.bench import Angle, Seen


def written(folder: Path, text: str) -> Path:
    (folder / "a.csv").write_text(text)
    return folder / "a.csv"


def test_times_and_lines(tmp_path: Path) -> None:
    file = written(tmp_path, "time_s,pressure_bar\n0.5,0\n2,0.4\n")
    assert read_times(file) == ((0.5, 0.0), (2.0, 0.4))
    head = "picture,sector,x1_px,y1_px,x2_px,y2_px\n"
    found = read_hand_lines(written(tmp_path, head + "a.png,2,1,2,30,40\n"))
    assert list(found) == [("a.png", 1)]
    assert found["a.png", 1].tolist() == [[1.0, 2.0], [30.0, 40.0]]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("time_s,bar\n1,2\n", "no column pressure_bar"),
        ("time_s,pressure_bar\n", "nothing in it"),
        ("time_s,pressure_bar\n1,0.2\n1,0.4\n", "line 3: times must rise"),
        ("time_s,pressure_bar\n1,0.2,3\n", "line 2 has 3 fields"),
        ("time_s,pressure_bar\n1,x\n", "pressure_bar 'x' is no number"),
        ("time_s,pressure_bar\n1,-0.2\n", "a pressure of -0.2 bar"),
    ],
)
def test_bad_times(text: str, said: str, tmp_path: Path) -> None:
    with pytest.raises(UnreadableInput, match=said):
        read_times(written(tmp_path, text))


@pytest.mark.parametrize(
    ("row", "said"), [("a.png,0,1,2,3,4", "counted from 1"), ("a.png,1,1,2,1,2", "one point")]
)
def test_bad_lines(row: str, said: str, tmp_path: Path) -> None:
    head = "picture,sector,x1_px,y1_px,x2_px,y2_px\n"
    with pytest.raises(UnreadableInput, match=said):
        read_hand_lines(written(tmp_path, f"{head}{row}\n"))


@pytest.mark.parametrize("time_s", [None, 12.5])
def test_measured_angles_come_back(time_s: float | None, tmp_path: Path) -> None:
    angles = (
        Angle(20.5, 0.4, "measured"),
        Angle(np.nan, np.nan, "lost"),
        Angle(-8.0, 1.2, "by hand"),
    )
    none = np.zeros((0, 2))
    seen = Seen("a, b.png", 1.2, angles, none, none, none, none, none, 0.1, 0.2, time_s)
    (tmp_path / "a.csv").write_bytes(write_angles([seen]))
    more = "" if time_s is None else ",12.5"
    assert (tmp_path / "a.csv").read_text().splitlines()[2] == f'"a, b.png",1.2,2,,,lost{more}'
    found = read_angles(tmp_path / "a.csv")
    assert [(one.joint, one.theta_deg, one.sigma_deg, one.time_s) for one in found] == [
        (1, 20.5, 0.4, time_s), (3, -8.0, 1.2, time_s),
    ]  # fmt: skip
