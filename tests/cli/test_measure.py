"""The commands `measure` and `calibrate`, and tube files in others."""

from __future__ import annotations

import json
from pathlib import Path

import cv2
import pytest

from profiletool.cli.measure import _pictures
from profiletool.errors import UsageError
from tests.calls import Result, call, error_of
from tests.subject.tube.drawn import MM_PER_PX, family, picture

DESIGN = "paper_bulb.json"


@pytest.fixture
def shot(samples: Path, tmp_path: Path) -> Path:
    rgb = picture(family(samples), 0.6).rgb
    cv2.imwrite(str(tmp_path / "a.png"), rgb[..., ::-1])
    return tmp_path / "a.png"


def measure(samples: Path, shots: list[Path], *more: object) -> Result:
    return call("measure", samples / DESIGN, *shots, "--no-fe", "--quiet", *more)


@pytest.mark.slow
def test_a_folder_of_results(samples: Path, shot: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    asked = ("--pressures", "0.6", "--mm-per-px", MM_PER_PX, "--out", out)
    result = measure(samples, [shot], *asked, "--json")
    assert result.exit_code == 0, result.stderr
    names = {path.name for path in out.iterdir()}
    assert {"angles.csv", "compare.json", "overlay_00.png", "report.html"} <= names
    assert {"theta_vs_pressure.png", "trajectories.svg", "agreement.png"} <= names
    told = json.loads(result.stdout)
    assert told == json.loads((out / "compare.json").read_text())
    assert set(told["response"]["all"]) == {
        "count", "r2", "slope", "intercept_deg", "rmse_deg", "bias_deg", "limits_deg",
    }  # fmt: skip
    assert told["response"]["all"]["rmse_deg"] < 1.0
    head = (out / "angles.csv").read_text().splitlines()[0]
    assert head == "picture,pressure_bar,joint,theta_deg,sigma_deg,state"
    page = (out / "report.html").read_text()
    assert "R² alone says little" in page
    assert "://" not in page.replace("http://www.w3.org", "")
    assert page.count('class="shot"') == page.count("data:image/jpeg") == 1
    assert page.index('class="predicted"') < page.index('class="fitted"')
    assert len(page) < 3_000_000


@pytest.mark.parametrize(
    ("pressures", "count", "more", "code", "said"),
    [
        ("0.4,0.6", 1, (), 2, "1 pictures and 2 pressures"),
        ("0.6,0.4", 2, (), 2, "must rise"),
        ("0", 1, (), 2, "at rest tells nothing"),
        ("x", 1, (), 2, "not 'x'"),
        ("99", 1, (), 2, "0 to 20 bar"),
        ("0.6", 1, ("--mm-per-px", "-1"), 2, "--mm-per-px must be a number above 0"),
        ("0.6", 1, (), 4, "--mm-per-px"),
        ("0.6", 1, ("--lines", "none.csv"), 3, "none.csv"),
    ],
)
def test_bad_usage_is_one_line_and_leaves_nothing(
    pressures: str, count: int, more: tuple[str, ...], code: int, said: str,
    samples: Path, shot: Path, tmp_path: Path,
) -> None:  # fmt: skip
    out = tmp_path / "out"
    result = measure(samples, [shot] * count, "--pressures", pressures, "--out", out, *more)
    assert result.exit_code == code
    assert said in error_of(result)
    assert not out.exists()


def test_pictures_over_time_may_be_at_one_pressure(shot: Path, tmp_path: Path) -> None:
    table = tmp_path / "times.csv"
    table.write_text("time_s,pressure_bar\n0,0.6\n5,0.6\n")
    names, bars, times, load = _pictures([shot, shot], str(table))
    assert (names, bars, times) == (["a.png", "a.png"], [0.6, 0.6], [0.0, 5.0])
    assert load(1).rgb.shape == (760, 760, 3)
    with pytest.raises(UsageError, match="1 pictures and 2 pressures"):
        _pictures([shot], str(table))


def test_no_picture_and_no_design(samples: Path, shot: Path, tmp_path: Path) -> None:
    (tmp_path / "b.png").write_text("no picture")
    asked = ("--pressures", "0.6", "--mm-per-px", "0.2", "--out", tmp_path / "out")
    result = measure(samples, [tmp_path / "b.png"], *asked)
    assert result.exit_code == 3
    assert "b.png" in error_of(result)
    result = call("measure", tmp_path / "b.png", shot, *asked)
    assert result.exit_code == 3
    assert not (tmp_path / "out").exists()


def test_calibrate_refuses_what_it_cannot_use(samples: Path, tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("pressure_bar,joint,theta_deg\n1.0,9,10\n1.2,9,10\n1.4,9,12\n")
    out = tmp_path / "tube.json"
    result = call("calibrate", samples / DESIGN, tmp_path / "a.csv", "--out", out)
    assert result.exit_code == 3
    assert "joint 9" in error_of(result)
    result = call(
        "calibrate", samples / DESIGN, tmp_path / "a.csv", "--out", out, "--date", "yesterday"
    )
    assert result.exit_code == 2
    assert "2026-03-01" in error_of(result)
    assert not out.exists()


def test_tube_files_are_read_before_anything_is_run(samples: Path, tmp_path: Path) -> None:
    (tmp_path / "tube.json").write_text("{}")
    tube = ("--tube", tmp_path / "tube.json")
    for command in (
        ("verify", samples / DESIGN, *tube),
        ("grip", samples / DESIGN, *tube),
        ("trim", samples / DESIGN, *tube),
        ("design", samples / "bulb.png", "--out", tmp_path / "out", *tube),
        ("derive", "--out", tmp_path / "formula.json", *tube),
    ):
        result = call(*command)
        assert result.exit_code == 3, command
        assert "no tube file" in error_of(result)
    result = call("derive", "--out", tmp_path / "f.json", "--wall", 1.5, *tube)
    assert result.exit_code == 2
