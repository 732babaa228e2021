"""The command `template`."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.calls import call, error_of
from tests.cli.inputs import REST


def test_template_of_a_design(samples: Path, tmp_path: Path) -> None:
    assert call("template", samples / "paper_bulb.json").exit_code == 0
    folder = tmp_path / "bulb_template"  # as the object is called, not the file
    assert {path.name for path in folder.iterdir()} >= {"template.dxf", "template.svg"}
    assert call("template", samples / REST).exit_code == 3


@pytest.mark.slow
def test_template_for_other_ways_to_make_it(samples: Path, tmp_path: Path) -> None:
    design = samples / "paper_bulb.json"
    options = ("--variant", "strip", "--kerf", "0.2", "--date", "26 Nov 2026", "--dxf", "R12")
    assert call("template", design, "--out", "strip", *options, "--paper", "letter").exit_code == 0
    strip = tmp_path / "strip"
    assert {file.name for file in strip.iterdir()} == {
        "design.json", "template.dxf", "template.pdf", "template.svg",
    }  # fmt: skip
    assert b"AC1009" in (strip / "template.dxf").read_bytes()[:100]
    assert "<title>Marking strip: " in (strip / "template.svg").read_text()
    pdf = (strip / "template.pdf").read_bytes()
    assert pdf.startswith(b"%PDF")
    assert call("template", design, "--out", "again", *options, "--paper", "letter").exit_code == 0
    assert (tmp_path / "again" / "template.pdf").read_bytes() == pdf


@pytest.mark.parametrize("kerf", ["-1", "1.75", "nan"])
def test_a_kerf_that_burns_threads_is_bad_usage(samples: Path, tmp_path: Path, kerf: str) -> None:
    for command, file in (("template", "paper_bulb.json"), ("design", "egg.png")):
        result = call(command, samples / file, "--kerf", kerf, "--out", "x")
        assert result.exit_code == 2
        assert "does not pass between hoop threads 1.75 mm apart" in error_of(result)
    assert not (tmp_path / "x").exists()
