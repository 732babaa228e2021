"""Requests that cannot be met: exit codes 2 to 5, one line, nothing written."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from PIL import Image, ImageDraw

from tests.calls import error_of
from tests.cli.inputs import picture, unverified


@pytest.mark.parametrize(
    "options",
    [
        ("--height", "0"),
        ("--width", "-3"),
        ("--mm-per-px", "nan"),
        ("--diameter", "inf"),
        ("--wall", "10"),
        ("--tolerance", "0"),
        ("--clearance", "-1"),
        ("--from", "60", "--to", "40"),
        ("--to", "101"),
        ("--joints", "0"),
        ("--side", "top"),
        ("--method", "magic"),
        ("--pitch", "50"),
        ("--max-pressure", "0.05"),
        ("--max-pressure", "0.05", "--method", "paper"),
        ("--interference", "-0.1"),
        ("--interference", "nan"),
        ("--alpha-step", "-5"),
        ("--alpha-step", "inf"),
        ("--place-step", "-1"),
        ("--place-step", "wide"),
        ("--no-such-option",),
        ("--config", "absent.toml", "--config", "absent.toml", "--bad"),
    ],
)
def test_exit_2_for_bad_usage(options: tuple[str, ...], tmp_path: Path) -> None:
    file = picture(tmp_path / "oval.png")
    scale = () if options[0] in ("--height", "--width", "--mm-per-px") else ("--height", "90")
    result = unverified(file, *scale, *options)
    assert result.exit_code == 2, result.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["oval.png"]


@pytest.mark.usefixtures("few_files")
def test_exit_2_for_a_folder_that_is_there(tmp_path: Path) -> None:
    file = picture(tmp_path / "oval.png")
    old = tmp_path / "oval_design" / "design.json"
    old.parent.mkdir()
    old.write_text("an earlier one")
    again = unverified(file, "--height", 90)
    assert again.exit_code == 2
    assert "--force" in error_of(again)
    assert old.read_text() == "an earlier one"
    assert unverified(file, "--height", 90, "--force", "--method", "paper").exit_code == 0
    assert old.read_text() != "an earlier one"


@pytest.mark.parametrize("name", ["absent.png", "text.png", "folder.png", "absent.svg", "bad.csv"])
def test_exit_3_for_what_cannot_be_read(name: str, tmp_path: Path) -> None:
    (tmp_path / "text.png").write_text("no picture")
    (tmp_path / "folder.png").mkdir()
    (tmp_path / "bad.csv").write_text("x,y\n1,2\n3,four\n")
    result = unverified(name, "--height", 90)
    assert result.exit_code == 3
    error_of(result)
    assert not (tmp_path / f"{Path(name).stem}_design").exists()


@pytest.mark.parametrize("dpi", [None, (72, 72), (96, 96)])
def test_exit_4_without_a_scale(dpi: tuple[int, int] | None, tmp_path: Path) -> None:
    file = picture(tmp_path / "oval.png", **({"dpi": dpi} if dpi else {}))
    result = unverified(file)
    assert result.exit_code == 4
    assert "--height" in error_of(result)


def test_exit_5_without_an_object(tmp_path: Path) -> None:
    result = unverified(picture(tmp_path / "blank.png", blank=True), "--height", 90)
    assert result.exit_code == 5
    error_of(result)


@pytest.mark.usefixtures("few_files")
@pytest.mark.parametrize(
    ("box", "options", "code"),
    [
        ((-20, 60, 160, 330), ("--mm-per-px", "0.3"), 5),
        ((-20, 60, 160, 330), ("--mm-per-px", "0.3", "--side", "right"), 0),
        ((-20, 60, 160, 330), ("--width", "50", "--side", "right"), 5),
        ((70, 60, 230, 430), ("--mm-per-px", "0.3"), 0),
        ((70, 60, 230, 430), ("--height", "90"), 5),
        ((70, -60, 230, 330), ("--mm-per-px", "0.3"), 5),
    ],
)
def test_exit_5_for_an_object_cut_off_where_it_matters(
    box: tuple[int, int, int, int], options: tuple[str, ...], code: int, tmp_path: Path
) -> None:
    image = Image.new("RGB", (300, 400), (235, 232, 228))
    ImageDraw.Draw(image).ellipse(box, fill=(120, 60, 40))
    image.save(tmp_path / "cut.png")
    result = unverified("cut.png", "--method", "paper", *options)
    assert result.exit_code in ({0, 6} if code == 0 else {code}), result.stderr
    if code:
        assert "runs out of the frame" in error_of(result)
    else:
        written = json.loads((tmp_path / "cut_design" / "design.json").read_text())
        assert any("runs out of the frame" in warning for warning in written["warnings"])


def test_exit_5_for_a_straight_profile(tmp_path: Path) -> None:
    (tmp_path / "line.csv").write_text("0,100\n0,50\n0,0\n")
    result = unverified("line.csv")
    assert result.exit_code == 5
    assert "straight" in error_of(result)


@pytest.mark.usefixtures("few_files")
@pytest.mark.parametrize(
    ("points", "options", "code"),
    [
        ("500,100\n500,50\n500,0\n", ("--joints", "2"), 5),
        ("0,80\n0,0\n80,0\n", ("--from", "50", "--to", "50.01"), 5),
        ("0,80\n-20,0\n0,-80\n", ("--joints", "120", "--method", "paper"), 6),
        pytest.param("0,20\n-5,0\n0,-20\n", ("--joints", "40"), 6, marks=pytest.mark.slow),
        ("0,80\n-20,0\n0,-80\n", ("--out", "x" * 300), 1),
    ],
)
def test_odd_requests_end_in_one_line(
    points: str, options: tuple[str, ...], code: int, tmp_path: Path
) -> None:
    (tmp_path / "odd.csv").write_text(points)
    result = unverified("odd.csv", *options)
    assert result.exit_code == code, result.stderr
    error_of(result)
