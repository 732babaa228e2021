"""The command `grip`."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from profiletool.files.design_json import to_json
from profiletool.profile.shape_csv import shape_csv
from tests.calls import call, error_of
from tests.verify.test_setting import made_up


def write(samples: Path, folder: Path) -> Path:
    """Write a design of the paper's bulb beside a profile that is as long as it says."""
    design = made_up(samples)
    length = design.source.profile_length_mm
    phi = np.linspace(0.0, 1.5, 400)
    arc = length / 1.5 * np.column_stack([-np.sin(phi), np.cos(phi) - 1.0])
    (folder / "shape.csv").write_bytes(shape_csv({"target": arc}))
    (folder / "design.json").write_text(to_json(design))
    return folder / "design.json"


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("--fingers", 0), "--fingers"),
        (("--friction", "0.5,x"), "numbers"),
        (("--friction", "-1"), "--friction"),
        (("--pressure", "0"), "--pressure"),
        (("--pressure", "40"), "--pressure"),
        (("--against", "wall:1,2,3"), "--against"),
        (("--object", "round"), "--object"),
        (("--clearance", "-1"), "--clearance"),
    ],
)
def test_refusals(samples: Path, tmp_path: Path, words: tuple[object, ...], told: str) -> None:
    result = call("grip", write(samples, tmp_path), *words)
    assert result.exit_code == 2
    assert told in error_of(result)


def test_without_the_profile(samples: Path, tmp_path: Path) -> None:
    file = write(samples, tmp_path)
    (tmp_path / "shape.csv").unlink()
    result = call("grip", file)
    assert result.exit_code == 3
    assert "no target beside it" in error_of(result)


@pytest.mark.slow
@pytest.mark.usefixtures("coarse_mesh")
def test_against_a_plane(samples: Path, tmp_path: Path) -> None:
    file = write(samples, tmp_path)
    words = ("--pressure", "0.8,1.0", "--against", "plane:0,-8,90", "--out", "g", "--json")
    result = call("grip", file, *words)
    assert result.exit_code == 0, result.stderr
    told = json.loads(result.stdout)
    assert told["converged"] is True
    assert told["pressure_bar"] == [0.8, 1.0]
    assert 0.0 <= told["normal_N"][0] < told["normal_N"][1]
    assert told["axial_N"][1] == pytest.approx(-told["normal_N"][1], abs=1e-3)
    assert told["payload_N"] is None
    names = {path.name for path in (tmp_path / "g").iterdir()}
    assert {"grip.json", "grip.csv", "contact.png", "force_vs_pressure.png"} <= names
