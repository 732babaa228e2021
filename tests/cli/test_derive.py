"""The command `derive`, and what takes its result."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from fem.gauze import Gauze
from fem.loadpath import Options
from fem.meshsize import MeshSize
from fem.solver import solve
from formula.files import campaign_of, load_formula, read_bytes
from formula.theta import theta_deg
from profiletool.campaign import runs
from profiletool.records.request import TubeSpec
from profiletool.verify.tube import joint_actuator
from tests.calls import call, error_of

SMALL = ("--alpha", "84,120,156", "--openF", "8,12", "--max-pressure", "0.4", "--workers", "1")


COARSE = MeshSize(beside=0.0, edge=1.0)


@pytest.fixture(autouse=True)
def in_a_folder_of_its_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PROFILETOOL_RUNS", str(tmp_path / "runs"))


@pytest.fixture(scope="module", autouse=True)
def coarse_mesh() -> Iterator[None]:
    """Run joints on a coarse mesh: the commands are tested here, not the engine's error."""
    with pytest.MonkeyPatch.context() as patch:
        settings = runs._Settings(Gauze(), COARSE, Options())
        patch.setattr(runs, "_SETTINGS", {"converged": settings})
        yield


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("derived")
    result = call(
        "derive", *SMALL, "--out", folder / "mine.json", "--report", folder / "report",
        "--runs", folder / "runs",
    )  # fmt: skip
    assert result.exit_code == 0, result.stderr
    assert "6 joints run" in result.stdout
    return folder


@pytest.mark.slow
def test_a_formula_of_finite_elements(made: Path) -> None:
    tree = json.loads((made / "mine.json").read_text())
    assert tree["name"] == "mine"
    assert tree["campaign"]["runs"] == 6
    run = solve(joint_actuator(12.0, 120.0, 270.0, TubeSpec()), [0.04], COARSE, threads=1)
    known = tree["campaign"]["theta_deg"][1][1][-1]
    assert known == pytest.approx(np.degrees(run.states[-1].theta[0]), rel=1e-6)
    assert tree["fit"]["rms_deg"] < 0.05
    assert {path.name for path in (made / "report").iterdir()} >= {
        "formula.json", "report.txt", "residuals.csv", "theta_vs_openF.png", "formula_vs_fe.png",
    }  # fmt: skip
    assert (made / "report" / "formula.json").read_bytes() == (made / "mine.json").read_bytes()


@pytest.mark.slow
def test_nothing_is_run_twice(made: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def never(task: object) -> None:
        raise AssertionError("it is in the folder of runs")

    monkeypatch.setattr("profiletool.campaign.runs.solve", never)
    result = call("derive", *SMALL, "--out", "mine.json", "--runs", made / "runs")
    assert result.exit_code == 0, result.stderr
    assert (tmp_path / "mine.json").read_bytes() == (made / "mine.json").read_bytes()


@pytest.mark.slow
def test_table_and_assign_take_it(made: Path) -> None:
    result = call("table", "--formula", made / "mine.json", "--openF", "8", "--csv")
    assert result.exit_code == 0, result.stderr
    rows = list(csv.DictReader(io.StringIO(result.stdout)))
    assert {row["pressure_bar"] for row in rows} == {"0.20", "0.40"}
    assert "extrapolated" not in rows[0]
    result = call("assign", "--formula", made / "mine.json", "--openF", "12", "--theta", "5")
    assert "pressure 0.40 bar" in result.stdout


@pytest.mark.slow
def test_beyond_its_range_it_is_refused_or_marked(made: Path) -> None:
    table = ("table", "--formula", made / "mine.json", "--openF", "16")
    result = call(*table)
    assert result.exit_code == 2
    assert "openF 16 mm is outside the 8 to 12 mm" in error_of(result)
    wide = call(*table, "--extrapolate")
    assert wide.exit_code == 0
    assert "*" in wide.stdout
    assert "extrapolated" in wide.stdout
    rows = list(csv.DictReader(io.StringIO(call(*table, "--extrapolate", "--csv").stdout)))
    assert {row["extrapolated"] for row in rows} == {"1"}
    cells = json.loads(call(*table, "--extrapolate", "--json").stdout)
    assert all(cell["extrapolated"] for cell in cells)
    chosen = ("assign", "--formula", made / "mine.json", "--openF", "16", "--theta", "6")
    found = json.loads(call(*chosen, "--extrapolate", "--json").stdout)
    assert "extrapolated" in found["warnings"][0]
    assert "note: joint 1" in call(*chosen, "--extrapolate").stdout
    assert call(*chosen).exit_code != 0


@pytest.mark.slow
@pytest.mark.usefixtures("few_files")
def test_a_design_has_the_tube_and_the_rubber_of_its_formula(
    made: Path, samples: Path, tmp_path: Path
) -> None:
    tree = json.loads((made / "mine.json").read_text())
    tree["domain"] |= {"outer_diameter_mm": 16.0, "wall_mm": 1.6}
    tree["domain"]["rubber"] |= {"constants": {"C10": 0.03, "C01": 0.02, "K": 1.2}}
    (tmp_path / "soft.json").write_text(json.dumps(tree))
    result = call(
        "design", samples / "bulb.png", "--formula", "soft.json", "--no-verify", "--extrapolate"
    )
    assert result.exit_code in (0, 6), result.stderr
    design = json.loads((tmp_path / "bulb_design" / "design.json").read_text())
    assert design["tube"]["outer_diameter_mm"] == 16.0
    assert design["tube"]["rubber"]["constants"]["C10"] == 0.03
    assert any("extrapolated" in warning for warning in design["warnings"])


def test_rubbers_are_listed() -> None:
    result = call("derive", "--rubber", "list")
    assert result.exit_code == 0
    assert "paper" in result.stdout
    assert "Actuators 9(4):113" in result.stdout


@pytest.mark.parametrize(
    ("options", "code", "says"),
    [
        (("--rubber", "granite"), 2, "granite"),
        (("--rubber", "mooney-rivlin:0.1,0.1,0.6"), 2, "nu"),
        (("--alpha", "84,x"), 2, "--alpha"),
        (("--alpha", "-5,84"), 2, "--alpha"),
        (("--openF", "70"), 2, "joint 1 reaches beyond the clamped end"),
        (("--wall", "12"), 2, "wall"),
        (("--max-pressure", "0"), 2, "--max-pressure"),
        (("--workers", "0"), 2, "--workers"),
        (("--from", "paper"), 2, "holds no campaign"),
        (("--from", "nothing.json"), 3, "cannot read"),
        (("--out", "."), 2, "--out"),
        ((), 2, "--out FILE is missing"),
    ],
)
def test_refusals_before_anything_is_run(
    options: tuple[str, ...], code: int, says: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def never(*_: object, **__: object) -> None:
        raise AssertionError("nothing should run")

    monkeypatch.setattr("profiletool.campaign.workers.run_all", never)
    out = () if "--out" in options or not options else ("--out", "x.json")
    result = call("derive", *options, *out)
    assert result.exit_code == code, result.stderr
    assert says in error_of(result)
    assert not Path("x.json").exists()


def test_an_earlier_file_is_kept() -> None:
    Path("x.json").write_text("mine")
    result = call("derive", *SMALL, "--out", "x.json")
    assert result.exit_code == 2
    assert "--force" in error_of(result)
    assert Path("x.json").read_text() == "mine"


def test_the_formula_that_comes_along_is_that_of_our_finite_elements() -> None:
    """Made anew with `derive --out formula/coefficients/fe.json` where the engine changes."""
    fe = load_formula(Path("fe"))
    tube, tight = joint_actuator(10.0, 108.0, 270.0, TubeSpec()), Options(before=1e-6)
    run = solve(tube, [0.1, 0.2], options=tight, threads=1)
    theta = np.degrees([state.theta[0] for state in run.states[1:]])
    np.testing.assert_allclose(theta_deg(fe, 108.0, 10.0, [1.0, 2.0]), theta, atol=0.25)
    campaign = campaign_of(read_bytes("fe"), "fe")
    assert campaign is not None
    np.testing.assert_allclose(campaign.theta_deg[1, 2, [4, 9]], theta, rtol=1e-4)
