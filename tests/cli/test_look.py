"""The options that say how to look at a picture, and the sheet to photograph on, as typed."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from profiletool.files.design_json import load_design
from profiletool.profile.upright import turned
from profiletool.subject.recall import target_of
from tests.calls import call, error_of
from tests.cli.inputs import picture, unverified
from tests.subject.objects import PEAR, csv, drawn


@pytest.mark.slow
def test_doubt_leaves_the_candidates_picture_and_no_folder(shared: Path, tmp_path: Path) -> None:
    photo = shared / "photos" / "pear_in_hand.jpg"
    result = unverified(photo, "--height", 90)
    assert result.exit_code == 5
    assert "pear_in_hand_candidates.png" in error_of(result)
    assert [path.name for path in tmp_path.iterdir()] == ["pear_in_hand_candidates.png"]
    with Image.open(tmp_path / "pear_in_hand_candidates.png") as shown:
        assert min(shown.size) > 300
    (tmp_path / "mine_candidates.png").write_text("precious")
    assert "mine_candidates_2.png" in error_of(
        unverified(photo, "--height", 90, "--out", "mine", "--force")
    )
    assert (tmp_path / "mine_candidates.png").read_text() == "precious"
    assert not (tmp_path / "mine").exists()
    pointed = unverified(photo, "--height", 90, "--point", "90,270", "--from", 15)
    assert pointed.exit_code == 0, pointed.stderr
    assert "% only: look at it in overlay.png" in pointed.stderr


@pytest.mark.parametrize(
    ("option", "value", "words"),
    [
        ("--rotate", "sideways", "'--rotate': expected numbers"),
        ("--rotate", "10,20", "'--rotate': expected one number"),
        ("--rotate", "361", "at most 360"),
        ("--box", "10,10,50", "'--box': expected 4 numbers"),
        ("--box", "10,10,500,500", "--box 10,10,500,500 does not fit"),
        ("--point", "nan,1", "'--point': expected finite numbers"),
        ("--point", "300,10", "outside the picture"),
        ("--camera-distance", "-5", "--camera-distance must be a number above 0, not -5"),
    ],
)
def test_hints_that_make_no_sense(tmp_path: Path, option: str, value: str, words: str) -> None:
    result = unverified(picture(tmp_path / "a.png"), "--height", 107, option, value)
    assert result.exit_code == 2
    assert words in error_of(result)
    assert [path.name for path in tmp_path.iterdir()] == ["a.png"]


def test_lengths_are_judged_where_they_are_not_needed_too(tmp_path: Path) -> None:
    result = unverified(csv(tmp_path / "a.csv", PEAR), "--camera-distance", "-5")
    assert result.exit_code == 2
    assert "--camera-distance must be a number above 0, not -5" in error_of(result)


def test_a_mask_of_another_size_is_refused(tmp_path: Path) -> None:
    Image.new("L", (20, 20), 255).save(tmp_path / "mask.png")
    file = picture(tmp_path / "a.png")
    result = unverified(file, "--height", 107, "--mask", tmp_path / "mask.png")
    assert result.exit_code == 2
    assert "20 x 20" in error_of(result)
    missing = unverified(file, "--height", 107, "--mask", tmp_path / "none.png")
    assert missing.exit_code == 3


@pytest.mark.slow
def test_what_was_asked_for_is_in_the_design_and_the_report(tmp_path: Path) -> None:
    file = drawn(tmp_path / "a.png", [turned(PEAR, 30.0)])
    (tmp_path / "look.toml").write_text(
        'rotate = "auto"\nsymmetric = true\npoint = [240, 200]\nbox = "90,50,300,300"\n'
        'method = "paper"\n'
    )
    result = unverified(file, "--height", 120, "--config", tmp_path / "look.toml")
    assert result.exit_code == 0, result.stderr
    assert "turned upright by -30." in result.stderr
    source = json.loads((tmp_path / "a_design" / "design.json").read_text())["source"]
    assert source["rotated_deg"] == pytest.approx(-30.0, abs=0.2)
    assert source["symmetric"] is True
    assert source["scale_error_share"] is None
    assert 0.5 < source["confidence"] <= 1.0
    report = (tmp_path / "a_design" / "report.html").read_text()
    assert "counter-clockwise" in report
    assert "the mean of both" in report


@pytest.mark.slow
def test_verify_finds_the_target_of_a_turned_drawing(tmp_path: Path) -> None:
    """An open line keeps its length however it is turned: only its place tells."""
    file = csv(tmp_path / "a.csv", PEAR[330:870])
    result = unverified(file, "--rotate", 4)
    assert result.exit_code in (0, 6), result.stderr
    design = tmp_path / "a_design" / "design.json"
    target = np.genfromtxt(
        tmp_path / "a_design" / "shape.csv", delimiter=",", skip_header=1, usecols=(2, 3)
    )
    (tmp_path / "design.json").write_bytes(design.read_bytes())
    found = target_of(load_design(tmp_path / "design.json"), tmp_path / "design.json")
    assert found is not None
    assert found.file == "a.csv"
    np.testing.assert_allclose(found.points[0], target[0], atol=1e-3)


@pytest.mark.parametrize(("paper", "size"), [("a4", (210, 297)), ("letter", (215.9, 279.4))])
def test_the_sheet_is_printed_at_its_size(
    tmp_path: Path, paper: str, size: tuple[float, float]
) -> None:
    result = call("sheet", "--paper", paper)
    assert result.exit_code == 0, result.stderr
    file = tmp_path / f"sheet_{paper}.pdf"
    before = file.read_bytes()
    (box,) = re.findall(rb"/MediaBox \[ 0 0 ([\d.]+) ([\d.]+) \]", before)
    assert [float(side) * 25.4 / 72 for side in box] == pytest.approx(size, abs=0.05)
    again = call("sheet", "--paper", paper)
    assert again.exit_code == 2
    assert "--force" in error_of(again)
    assert call("sheet", "--paper", paper, "--force").exit_code == 0
    assert file.read_bytes() == before
