"""The report's parts on neighbours, and on what was measured."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from profiletool.files.design_json import load_design
from profiletool.records.design import Design
from profiletool.records.neighbour import Neighbour
from profiletool.records.request import Request, TubeSpec
from profiletool.report.measured import measured
from profiletool.report.neighbours import neighbours


@pytest.fixture
def design(samples: Path) -> Design:
    around = (
        Neighbour("as chosen", 5, 1.197, 0.119, 1.852, "joint response"),
        Neighbour("lower pressure", 5, 1.08, 0.31, None, "FE"),
    )
    return replace(load_design(samples / "paper_bulb.json"), neighbours=around)


def test_every_neighbour_is_a_row_that_says_by_what(design: Design) -> None:
    page = str(neighbours(design, Request(Path("a"))))
    for words in ("as chosen", "1.20", "0.12", "1.85", "joint response", "1.08", "0.31", "–", "FE"):
        assert words in page
    assert "within the tolerance (0.25 mm RMS)" in page


def test_the_rule_is_that_of_what_was_asked(design: Design) -> None:
    assert "(0.4 mm RMS)" in str(neighbours(design, Request(Path("a"), tolerance_mm=0.4)))
    given = Request(Path("a"), joints=4, tube=TubeSpec(pressure_bar=1.2))
    page = str(neighbours(design, given))
    assert "The number of joints is the one asked for. The pressure is given." in page
    assert "tolerance" not in page


def test_what_was_measured_is_what_the_guide_says() -> None:
    page = str(measured())
    root = Path(__file__).parents[2]
    guide = " ".join((root / "docs" / "measured.md").read_text("utf-8").split())
    for fact in ("0 to 100°", "11 mm RMS", "18.7°", "50.5°", "59.3°", "Beyond 1.5 bar"):
        assert fact in page
        assert fact in guide
    assert "No actuator of this project has been built yet" in page
    assert "No actuator of this project has been built yet" in guide
