"""The command `trim`."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest

from profiletool.files.design_json import to_json
from profiletool.records.seal import sealed
from tests.calls import call, error_of
from tests.verify.test_setting import PLANNED, made_up, read, tip


@pytest.fixture
def file(samples: Path, tmp_path: Path) -> Path:
    (tmp_path / "design.json").write_text(to_json(made_up(samples)))
    return tmp_path / "design.json"


def at(bar: float) -> str:
    return "{:.4f},{:.4f}".format(*tip(bar))


def angles(folder: Path, stiffness: float, off: float = 0.0) -> Path:
    rows = [
        f"a.png,{r.pressure_bar},{r.joint},{r.theta_deg + off * (r.joint == 1)},0.5,measured"
        for r in read(stiffness, PLANNED)
    ]
    head = "picture,pressure_bar,joint,theta_deg,sigma_deg,state"
    (folder / "a.csv").write_text("\n".join([head, *rows, "a.png,1.67,3,,,lost"]) + "\n")
    return folder / "a.csv"


def test_from_the_tip(file: Path) -> None:
    result = call("trim", file, "--tip", at(PLANNED / 1.08), "--at", PLANNED)
    assert result.exit_code == 0, result.stderr
    assert result.stdout.splitlines() == [
        "set 1.80 bar (planned: 1.67): this actuator is 1.080 times as stiff as planned",
        "its tip lies 0.0 mm off the way of the planned one",
    ]
    told = json.loads(call("trim", file, "--tip", at(1.95), "--at", PLANNED, "--json").stdout)
    assert list(told) == [
        "pressure_bar", "planned_bar", "operate_bar", "stiffness", "off_mm", "rms_deg",
        "joints_off", "beyond", "notes",
    ]  # fmt: skip
    assert told["beyond"] is True
    assert told["pressure_bar"] == 1.52
    assert told["rms_deg"] is None


def test_from_angles(file: Path, tmp_path: Path) -> None:
    told = json.loads(call("trim", file, "--angles", angles(tmp_path, 1.06), "--json").stdout)
    assert told["pressure_bar"] == 1.77
    assert told["stiffness"] == pytest.approx(1.06, abs=1e-3)
    assert told["off_mm"] is None
    assert told["joints_off"] == []
    said = call("trim", file, "--angles", angles(tmp_path, 1.0, 7.0)).stdout
    assert "deg RMS off those of the planned one" in said
    assert "note: joint 1 is +7.0 deg off by itself" in said


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ((), "give one of --tip, --angles and --tube"),
        (("--tip", "1,2"), "--tip and --at go together"),
        (("--at", "1"), "give one of --tip, --angles and --tube"),
        (("--tip", "1,2", "--at", "1", "--angles", "a.csv"), "give one of"),
        (("--angles", "a.csv", "--at", "1"), "--tip and --at go together"),
        (("--tip", "1", "--at", "1"), "expected 2 numbers"),
        (("--tip", "1,2", "--at", "0"), "not at 0"),
        (("--tip", "1,2", "--at", "nan"), "not at nan"),
    ],
)
def test_bad_usage(file: Path, options: tuple[str, ...], said: str) -> None:
    result = call("trim", file, *options)
    assert result.exit_code == 2
    assert said in error_of(result)


def test_more_than_was_checked(file: Path, tmp_path: Path) -> None:
    for options in (
        ("--tip", at(PLANNED / 1.12), "--at", PLANNED),
        ("--angles", angles(tmp_path, 1.12)),
    ):
        result = call("trim", file, *options)
        assert result.exit_code == 6
        assert result.stdout == ""
        said = error_of(result)
        assert f"error: {file}: this actuator is 1.12 times as stiff" in said
        assert "would need 1.87 bar, but finite elements checked it up to 1.84 bar only" in said


def test_files_that_do_not_tell(file: Path, samples: Path, tmp_path: Path) -> None:
    options = ("--tip", at(PLANNED), "--at", PLANNED)
    assert call("trim", samples / "paper_bulb.json", *options).exit_code == 3
    design = made_up(samples)
    for changed, said in (
        (replace(design, pressure_bar=1.7), "changed since: its trim table does not hold"),
        (sealed(replace(design, trim=())), "holds no trim table"),
        (replace(design, verified=False), "not verified by finite elements"),
    ):
        file.write_text(to_json(changed))
        result = call("trim", file, *options)
        assert result.exit_code == 3
        assert said in error_of(result)
    result = call("trim", file, "--angles", tmp_path / "absent.csv")
    assert result.exit_code == 3
    assert "absent.csv: no such file" in error_of(result)
