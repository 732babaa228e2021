"""The command `deck`."""

from __future__ import annotations

import json
from argparse import Namespace
from pathlib import Path

import numpy as np
import pytest

from fem.export.expected import Expected
from profiletool.report import deck
from tests.calls import call, error_of

DESIGN = "paper_bulb.json"


@pytest.mark.parametrize(("code", "ending"), [("ansys", ".dat"), ("febio", ".feb")])
def test_a_deck_and_what_lies_beside_it(
    samples: Path, tmp_path: Path, code: str, ending: str
) -> None:
    options = ("--for", code, "--no-verify", "--thread-factor", "2")
    assert call("deck", samples / DESIGN, *options).exit_code == 0
    folder = tmp_path / f"paper_bulb_{code}"
    assert {file.name for file in folder.iterdir()} == {
        f"actuator{ending}", f"cube{ending}", "README.txt", "design.json",
    }  # fmt: skip
    assert json.loads((folder / "design.json").read_text())["model"]["thread_factor"] == 2.0
    assert call("deck", samples / DESIGN, *options, "--quiet", "--force").stderr == ""


def test_meshes_and_pressures(samples: Path, tmp_path: Path) -> None:
    options = ("--for", "calculix", "--no-verify", "--mesh", "paper", "--pressure", "1.2")
    assert call("deck", samples / DESIGN, *options, "--out", "p").exit_code == 0
    text = (tmp_path / "p" / "actuator.inp").read_text()
    assert "TYPE=C3D8I," in text
    assert "C3D20R" not in text
    assert text.count("*STEP") == 10
    assert text.count("INNER, P1, 0.12\n") == 1


def test_an_engine_that_stops_early_says_so(
    samples: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    found = Expected(np.array([0.01]), np.zeros((1, 6)), np.zeros((1, 3)), np.zeros(1))
    monkeypatch.setattr(deck, "expect", lambda *_: found)
    monkeypatch.setattr(deck, "run_design", lambda *_: Namespace(verification=None))
    options = ("--for", "abaqus", "--mesh", "paper", "--out", "early")
    result = call("deck", samples / DESIGN, *options)
    assert result.exit_code == 7
    assert "came to 0.10 bar, not to the 1.90 bar of the deck" in error_of(result)
    assert len((tmp_path / "early" / "expected.csv").read_text().splitlines()) == 2


@pytest.mark.slow
def test_angles_to_expect(samples: Path, tmp_path: Path) -> None:
    options = ("--for", "febio", "--pressure", "0.4", "--out", "f")
    assert call("deck", samples / DESIGN, *options).exit_code == 0
    table = np.genfromtxt(tmp_path / "f" / "expected.csv", delimiter=",", names=True)
    assert table["pressure_bar"] == pytest.approx(np.arange(1, 11) * 0.04)
    for joint in range(1, 7):
        theirs = table[f"design_theta{joint}_deg"]
        assert table[f"theta{joint}_deg"] == pytest.approx(theirs, rel=0.06)
    assert "expected.csv has" in (tmp_path / "f" / "README.txt").read_text()


@pytest.mark.parametrize(
    ("options", "code", "why"),
    [
        ((), 2, "Missing option '--for'. Choose from: calculix, abaqus, ansys, febio"),
        (("--for", "nastran"), 2, "'nastran' is not one of"),
        (
            ("--for", "ansys", "--gravity", "down"),
            2,
            "a deck holds no weight: leave it out with --g",
        ),
        (("--for", "ansys", "--pressure", "0"), 2, "--pressure must be above 0"),
        (("--for", "ansys", "--nu", "0.5"), 2, "--nu must be 0 to"),
    ],
)
def test_bad_usage(
    samples: Path, tmp_path: Path, options: tuple[str, ...], code: int, why: str
) -> None:
    result = call("deck", samples / DESIGN, *options, "--out", "x")
    assert result.exit_code == code
    assert why in error_of(result)
    assert not (tmp_path / "x").exists()


def test_a_file_that_is_no_design(samples: Path) -> None:
    assert call("deck", samples / "finger_rest.csv", "--for", "febio").exit_code == 3
