"""Files of decks."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fem.export.expected import Expected
from profiletool.files.design_json import load_design
from profiletool.report.deck import DeckOutput, make_deck_output
from profiletool.report.outputs import deck_files
from tests.report.dossiers import made_up


@pytest.fixture(scope="module")
def output(samples: Path) -> DeckOutput:
    """As if both runs had been made; the second one ended early."""
    design = load_design(samples / "paper_bulb.json")
    bare = make_deck_output(design, "abaqus", "paper", 1.0, solve=False)
    theta = np.radians(np.arange(12.0).reshape(2, 6) + np.array([[170.0], [190.0]]))
    tip, air = np.array([[0.0, -1.0, 0.5], [0.0, -2.0, 1.5]]), np.array([2e4, 3e4])
    found = Expected(np.array([0.01, 0.02]), (theta + np.pi) % (2.0 * np.pi) - np.pi, tip, air)
    verified = made_up(design)
    return replace(bare, expected=found, verified=replace(verified, states=verified.states[:1]))


def test_expected_angles_go_on_beyond_half_a_turn(output: DeckOutput) -> None:
    rows = deck_files(output)["expected.csv"].decode().splitlines()
    head, first, second = (row.split(",") for row in rows)
    assert head[:2] == ["pressure_bar", "theta1_deg"]
    assert head[7] == "design_theta1_deg"
    assert head[13:] == ["tip_ux_mm", "tip_uy_mm", "tip_uz_mm", "air_ml"]
    assert [first[0], second[0]] == ["0.1000", "0.2000"]
    assert float(second[1]) - float(first[1]) == pytest.approx(26.0, abs=2e-3)
    assert float(first[7]) != 0.0
    assert second[7:13] == [""] * 6
    assert second[13:] == ["0.0000", "-2.0000", "1.5000", "30.000"]


def test_the_readme_says_what_was_run_and_what_is_missing(output: DeckOutput) -> None:
    files = deck_files(output)
    assert list(files) == [
        "actuator.inp", "cube.inp", "expected.csv", "README.txt", "design.json",
    ]  # fmt: skip
    text = files["README.txt"].decode()
    for words in (
        "Abaqus was NOT run", "mean 1.0648", "came to 0.20 bar", f"{len(output.deck.X)} nodes",
        f"{output.deck.axial.stiffness.sum():.6g} N/mm",
    ):  # fmt: skip
        assert words in text
    assert output.reached_bar == pytest.approx(0.2)
    assert replace(output, expected=None).reached_bar == pytest.approx(1.0)
    bare = deck_files(replace(output, expected=None, code="calculix"))
    assert "expected.csv" not in bare
    assert "CalculiX 2.20 was run" in bare["README.txt"].decode()


def test_the_same_design_gives_the_same_bytes(output: DeckOutput) -> None:
    assert deck_files(output) == deck_files(output)
