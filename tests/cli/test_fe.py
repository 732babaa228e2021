"""The commands `joint`, `finger` and `verify`."""

from __future__ import annotations

import csv
import json
from dataclasses import replace
from pathlib import Path

import pytest
from PIL import Image

import fem
from profiletool.verify import run
from tests.calls import call, error_of
from tests.cli.inputs import REST, ending_early, never_converging

FE_KEYS = [
    "converged", "pressure_bar", "theta_deg", "elements", "nodes", "dofs", "newton_iterations",
    "seconds",
]  # fmt: skip


pytestmark = pytest.mark.usefixtures("coarse_mesh")

JOINT = ("joint", "--openF", "10", "--alpha", "84", "--pressure", "0.2")


def test_joint_as_json_and_as_text() -> None:
    result = call(*JOINT, "--json", "--quiet")
    assert result.exit_code == 0
    assert result.stderr == ""
    found = json.loads(result.stdout)
    assert list(found)[: len(FE_KEYS)] == FE_KEYS
    assert found["converged"] is True
    assert found["critical"] is None
    assert found["pressure_bar"] == pytest.approx([0.02 * k for k in range(1, 11)])
    (theta,) = found["theta_deg"]
    assert theta[-1] == pytest.approx(2.69, rel=0.03)  # formula (9)
    assert len(theta) == len(found["air_ml"]) == 10
    lines = call(*JOINT).stdout.splitlines()
    assert lines[0] == "one joint: openF 10 mm, alpha_closed 84 deg, alpha_center 270 deg"
    assert lines[12].split()[:2] == ["0.20", "2.7"]


def test_joint_away_from_the_object_bends_the_other_way() -> None:
    found = json.loads(call(*JOINT, "--alpha-center", 90, "--json").stdout)
    assert found["theta_deg"][0][-1] == pytest.approx(-2.69, rel=0.03)


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (("--openF", "70"), "clamped end"),
        (("--openF", "nan"), "finite"),
        (("--alpha", "400"), "alpha_closed 400"),
        (("--alpha-center", "-90"), "--alpha-center"),
        (("--diameter", "0"), "diameter"),
        (("--wall", "11"), "wall"),
        (("--pressure", "0"), "--pressure"),
        (("--pressure", "inf"), "--pressure"),
        (("--pressure", "2000"), "--pressure"),
    ],
)
def test_joint_refuses(options: tuple[str, ...], says: str, tmp_path: Path) -> None:
    result = call(*JOINT, *options, "--out", "out")
    assert result.exit_code == 2
    assert says in error_of(result)
    assert not (tmp_path / "out").exists()


@pytest.mark.slow
def test_finger_writes_a_folder_whole(tmp_path: Path) -> None:
    result = call("finger", "--pressure", "0.25", "--out", "finger", "--json")
    assert result.exit_code == 0, result.stderr
    found = json.loads(result.stdout)
    assert found["pressure_bar"] == pytest.approx([0.1, 0.2, 0.25])
    assert len(found["theta_deg"]) == 3
    assert found["range_deg"] == [75, 100, 65]
    assert found["range_reached_bar"] == [None, None, None]
    folder = tmp_path / "finger"
    names = {
        "fe.json", "theta_vs_pressure.csv", "theta_vs_pressure.png", "trajectories.png",
        "shape.csv", "actuator.vtu", "actuator.pvd",
    }  # fmt: skip
    assert {p.name for p in folder.iterdir()} == names | {f"actuator_0{k}.vtu" for k in range(4)}
    assert (folder / "fe.json").read_text() == result.stdout
    rows = list(csv.DictReader((folder / "theta_vs_pressure.csv").read_text().splitlines()))
    assert [float(row["theta2_deg"]) for row in rows] == pytest.approx(
        found["theta_deg"][1], abs=1e-3
    )
    for picture_name in ("theta_vs_pressure.png", "trajectories.png"):
        with Image.open(folder / picture_name) as image:
            assert min(image.size) > 500
    again = call("finger", "--pressure", "0.1", "--out", "finger")
    assert again.exit_code == 2
    assert call("finger", "--pressure", "0.1", "--out", "finger", "--force").exit_code == 0


@pytest.mark.slow
def test_the_papers_finger_reaches_its_ranges() -> None:
    found = json.loads(call("finger", "--json").stdout)
    assert found["pressure_bar"] == pytest.approx([0.1 * k for k in range(1, 24)])
    first, second, third = found["range_reached_bar"]
    assert first < 2.0  # as the paper says
    assert third < 2.0
    assert second == pytest.approx(2.115, abs=0.03)  # the paper: below 2.0; converged FE: not
    assert "joint 2: 0 to 100 deg reached at 2.1" in call("finger").stdout


def test_a_limit_point_prints_what_there_is(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    ending_early(monkeypatch)
    result = call(*JOINT, "--json", "--out", "out")
    assert result.exit_code == 7
    assert error_of(result) == (
        "error: limit point at 0.10 bar, before the 0.20 bar asked for; ask for less with "
        "--pressure"
    )
    found = json.loads(result.stdout)
    assert found["converged"] is False
    assert found["critical"] == {"kind": "limit point", "pressure_bar": 0.1}
    assert found["pressure_bar"] == pytest.approx([0.02, 0.04, 0.06, 0.08])
    assert (tmp_path / "out" / "actuator_04.vtu").exists()


@pytest.mark.parametrize("words", [JOINT, ("finger",), ("verify", "DESIGN")])
def test_exit_7_when_it_does_not_converge(
    words: tuple[str, ...], monkeypatch: pytest.MonkeyPatch, samples: Path
) -> None:
    never_converging(monkeypatch)
    design = str(samples / "paper_bulb.json")
    result = call(*(design if word == "DESIGN" else word for word in words))
    assert result.exit_code == 7
    assert "no equilibrium found beyond 0.01 bar" in error_of(result)
    assert result.stdout == ""


def shortened(samples: Path, folder: Path) -> Path:
    """Only the first joint of the paper's bulb, on 32 mm of tube, with its drawing beside it."""
    tree = json.loads((samples / "paper_bulb.json").read_text())
    tree["joints"] = [{**tree["joints"][0], "F_mm": 22.0}]
    tree["tube"]["length_mm"] = 32.0
    (folder / "short.json").write_text(json.dumps(tree))
    (folder / "truth").mkdir()
    (folder / "truth" / "bulb.csv").write_bytes((samples / "truth" / "bulb.csv").read_bytes())
    return folder / "short.json"


def test_verify_finds_the_drawing_of_a_design(samples: Path, tmp_path: Path) -> None:
    result = call("verify", shortened(samples, tmp_path), "--pressure", "0.1", "--json")
    assert result.exit_code == 0, result.stderr
    found = json.loads(result.stdout)
    assert list(found)[: len(FE_KEYS)] == FE_KEYS
    assert len(found["theta_deg"]) == 1
    assert found["fit"]["target"] == "truth/bulb.csv"
    assert found["fit"]["max_mm"] > 20.0  # most of the bulb is left to the other joints


@pytest.mark.slow
def test_verify_ends_with_7_where_the_tube_stands_hardly_more(
    samples: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    solve, looked = run.solve, list[float]()

    def limited(*arguments: object, options: fem.Options, **more: object) -> fem.Solution:
        looked.append(options.ahead)
        return replace(solve(*arguments, **more), ahead=fem.Critical("limit point", 0.0103))

    monkeypatch.setattr(run, "solve", limited)
    design = shortened(samples, tmp_path)
    tree = json.loads(design.read_text())
    design.write_text(json.dumps({**tree, "pressure_bar": 0.1}))
    result = call("verify", design, "--json")
    assert looked == [pytest.approx(0.05 * 0.01)]
    assert result.exit_code == 7
    assert "limit point at 0.10 bar, less than 5 % above 0.10 bar" in error_of(result)
    found = json.loads(result.stdout)
    assert found["converged"] is True
    assert found["ahead"]["kind"] == "limit point"
    call("verify", design, "--pressure", "0.05")
    assert looked[1:] == [0.0]  # what is not the design's pressure is not held against it


def test_verify_without_a_target_says_so(samples: Path, tmp_path: Path) -> None:
    design = shortened(samples, tmp_path)
    with (tmp_path / "truth" / "bulb.csv").open("a") as drawing:
        drawing.write("\n")  # no longer the file that the design was made from
    # A shape.csv of some other design is not its target.
    (tmp_path / "shape.csv").write_text("curve,s_mm,x_mm,y_mm\ntarget,0,0,0\ntarget,5,5,0\n")
    result = call("verify", design, "--pressure", "0.05")
    assert result.exit_code == 0
    assert "no target to compare with" in result.stdout


def test_verify_refuses(samples: Path, tmp_path: Path) -> None:
    assert call("verify", "absent.json").exit_code == 3
    tree = json.loads((samples / "paper_bulb.json").read_text())
    tree["tube"]["wall_mm"] = 8.0  # a tube, but none that this model describes
    for feasible, code in ((True, 3), (False, 6)):
        (tmp_path / "thick.json").write_text(json.dumps({**tree, "feasible": feasible}))
        result = call("verify", "thick.json")
        assert result.exit_code == code
        assert "thick.json: a wall of 8 mm" in error_of(result)


@pytest.mark.slow
def test_verify_agrees_with_design(samples: Path, tmp_path: Path) -> None:
    made = json.loads(
        call("design", samples / REST, "--no-refine", "--no-grip", "--json", "--quiet").stdout
    )
    assert made["verified"] is True
    assert {entry["what"].split()[0] for entry in made["sensitivity"]} >= {"pressure", "joint"}
    again = call("verify", "finger_rest_design/design.json", "--out", "again", "--json", "--quiet")
    found = json.loads(again.stdout)
    assert found["fit"]["target"] == "shape.csv"
    for key in ("rms_mm", "max_mm"):
        assert found["fit"][key] == pytest.approx(made["fit"]["fe"][key], abs=2e-3)
    for joint, theta in zip(made["joints"], found["theta_deg"], strict=True):
        assert abs(theta[-1]) == pytest.approx(joint["theta_fe_deg"], abs=1e-3)
    curves = {r.split(",")[0] for r in (tmp_path / "again/shape.csv").read_text().splitlines()[1:]}
    assert curves == {"target", "rest", "fe"}


def test_what_was_reached_is_shown_where_a_run_does_not_converge(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def stuck(*arguments: object, **options: object) -> fem.Solution:
        found = solve(*arguments, **options)
        part = replace(found, states=found.states[:4])
        raise fem.NotConverged("residual", (), part.states[-1].pressure, part)

    solve = run.solve
    monkeypatch.setattr(run, "solve", stuck)
    result = call(*JOINT, "--json", "--out", "stuck")
    assert result.exit_code == 7
    assert error_of(result).endswith(
        "no equilibrium found beyond 0.06 bar, before the 0.20 bar asked for; "
        "ask for less with --pressure"
    )
    told = json.loads(result.stdout)
    assert told["converged"] is False
    assert told["critical"] is None
    assert told["failure"] == "no equilibrium found beyond 0.06 bar"
    assert told["pressure_bar"] == [0.02, 0.04, 0.06]
    assert len(told["theta_deg"][0]) == 3
    assert (tmp_path / "stuck" / "theta_vs_pressure.csv").read_text().count("\n") == 4


@pytest.mark.slow
def test_a_stiffer_rubber_by_its_nu_bends_less_and_says_so() -> None:
    less = json.loads(call(*JOINT, "--nu", 0.49, "--json").stdout)
    usual = json.loads(call(*JOINT, "--json").stdout)
    assert "model" not in usual
    assert less["model"]["nu"] == 0.49
    assert less["theta_deg"][0][-1] < 0.995 * usual["theta_deg"][0][-1]


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (("--nu", "0.5"), "--nu must be 0 to 0.4999"),
        (("--gravity", "sideways"), "--gravity must be none, down, up, level or an angle"),
        (("--thread-factor", "0"), "--thread-factor must be"),
    ],
)
def test_inputs_of_the_model_that_make_no_sense(options: tuple[str, str], says: str) -> None:
    assert says in error_of(call(*JOINT, *options))
