from __future__ import annotations

import csv
import io
import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image, ImageDraw
from typer.testing import CliRunner, Result

from profiletool.cli import app, design_main, main

REST = "finger_rest.csv"


def call(*arguments: object) -> Result:
    return CliRunner().invoke(app, [str(argument) for argument in arguments])


def unverified(*arguments: object) -> Result:
    """Design without finite elements, where they are not the point."""
    return call("design", *arguments, "--no-verify")


def error_of(result: Result) -> str:
    """The one line that says what is wrong."""
    lines = [line for line in result.stderr.splitlines() if line.startswith("error: ")]
    assert len(lines) == 1, result.stderr
    assert "Traceback" not in result.stderr
    return lines[0]


def picture(path: Path, *, blank: bool = False, **save: object) -> Path:
    image = Image.new("RGB", (300, 400), (235, 232, 228))
    if not blank:
        ImageDraw.Draw(image).ellipse((70, 60, 230, 330), fill=(120, 60, 40))
    image.save(path, **save)
    return path


@pytest.fixture(autouse=True)
def in_a_folder_of_its_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def test_the_main_job(samples: Path, tmp_path: Path) -> None:
    result = call("design", samples / "bulb.png", "--method", "paper")
    assert result.exit_code == 0, result.stderr
    out = tmp_path / "bulb_design"
    names = {"design.json", "template.dxf", "template.svg", "overlay.png", "mask.png", "shape.csv"}
    names |= {"theta_vs_pressure.csv", "theta_vs_pressure.png", "actuator.vtu"}
    assert {path.name for path in out.iterdir()} == names
    design = json.loads((out / "design.json").read_text())
    away = [j["number"] for j in design["joints"] if j["alpha_center_deg"] == 90]
    assert away == [len(design["joints"])]  # the opposite one, at the neck
    assert len(design["joints"]) in (6, 7)  # after five or six around the glass
    assert design["pressure_bar"] <= 2.0
    assert design["feasible"] is True
    assert design["verified"] is True
    assert not any("NOT VERIFIED" in warning for warning in design["warnings"])
    assert "NOT VERIFIED" not in (out / "template.svg").read_text()
    for joint in design["joints"]:  # the same angles, and more above 1.2 bar
        assert 0.9 < joint["theta_fe_deg"] / joint["theta_formula_deg"] < 1.3
    assert design["fit"]["fe"]["max_mm"] > design["fit"]["fe"]["rms_mm"] > 0.0
    assert any("than the formula says" in warning for warning in design["warnings"])
    curves = {line.split(",")[0] for line in (out / "shape.csv").read_text().splitlines()}
    assert curves == {"curve", "target", "formula", "fe"}
    assert design["source"]["scale_source"] == "resolution"
    assert result.stdout.splitlines()[1].split()[:3] == ["joint", "F", "mm"]
    with Image.open(out / "overlay.png") as overlay:
        assert min(overlay.size) > 900


def test_same_input_same_bytes(samples: Path, tmp_path: Path) -> None:
    for name in ("a", "b"):
        assert unverified(samples / "egg.png", "--out", name).exit_code == 0
    for file in ("design.json", "template.dxf", "template.svg", "shape.csv"):
        assert (tmp_path / "a" / file).read_bytes() == (tmp_path / "b" / file).read_bytes()


def test_json_on_stdout_is_the_file(samples: Path, tmp_path: Path) -> None:
    result = unverified(samples / "egg.png", "--json", "--quiet")
    assert result.stdout == (tmp_path / "egg_design" / "design.json").read_text()
    assert result.stderr == ""


def test_left_and_right_of_a_symmetric_object_agree(tmp_path: Path) -> None:
    file = picture(tmp_path / "oval.png")
    designs = []
    for side in ("left", "right"):
        result = unverified(file, "--height", 90, "--side", side, "--out", side, "--json")
        designs.append(json.loads(result.stdout))
    left, right = designs
    # Which of many equally good polygons is taken may differ with the last pixel.
    turns = [sum(j["theta_target_deg"] for j in design["joints"]) for design in designs]
    assert turns[0] == pytest.approx(turns[1], abs=1.0)
    assert len(left["joints"]) == len(right["joints"])
    assert left["source"]["profile_length_mm"] == pytest.approx(
        right["source"]["profile_length_mm"], abs=0.3
    )
    assert left["base_pose"]["heading_deg"] == pytest.approx(180.0, abs=1.0)
    assert right["base_pose"]["heading_deg"] == pytest.approx(0.0, abs=1.0)


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
        ("--no-such-option",),
        ("--config", "absent.toml", "--config", "absent.toml", "--bad"),
    ],
)
def test_exit_2_for_bad_usage(options: tuple[str, ...], tmp_path: Path) -> None:
    file = picture(tmp_path / "oval.png")
    scale = () if options[0] in ("--height", "--width", "--mm-per-px") else ("--height", "90")
    result = unverified(file, *scale, *options)
    assert result.exit_code == 2, result.output
    assert [path.name for path in tmp_path.iterdir()] == ["oval.png"]


def test_exit_2_for_a_folder_that_is_there(tmp_path: Path) -> None:
    file = picture(tmp_path / "oval.png")
    assert unverified(file, "--height", 90).exit_code == 0
    again = unverified(file, "--height", 90)
    assert again.exit_code == 2
    assert "--force" in error_of(again)
    assert unverified(file, "--height", 90, "--force").exit_code == 0


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
    result = unverified("cut.png", *options)
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


def test_exit_6_writes_the_best_attempt(tmp_path: Path) -> None:
    (tmp_path / "corner.csv").write_text("0,80\n0,0\n80,0\n")
    result = unverified("corner.csv")
    assert result.exit_code == 6
    assert "marked infeasible" in error_of(result)
    written = json.loads((tmp_path / "corner_design" / "design.json").read_text())
    assert written["feasible"] is False
    assert "INFEASIBLE" in (tmp_path / "corner_design" / "template.svg").read_text()


@pytest.mark.parametrize(
    ("options", "says"),
    [(("--diameter", "16"), "--formula"), (("--max-length", "60"), "--max-length")],
)
def test_exit_6_for_other_limits(
    options: tuple[str, ...], says: str, samples: Path, tmp_path: Path
) -> None:
    result = unverified(samples / "egg.png", *options)
    assert result.exit_code == 6
    assert says in error_of(result)


def test_config_gives_defaults_and_the_command_line_wins(samples: Path, tmp_path: Path) -> None:
    (tmp_path / "lab.toml").write_text('side = "right"\nmax-length = 200\nroot = 12\n')
    made = unverified(samples / "egg.png", "--config", "lab.toml", "--root", 14, "--json")
    design = json.loads(made.stdout)
    assert design["source"]["side"] == "right"
    assert design["tube"]["root_mm"] == 14


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("sidee = 1", 2),
        ("side = [1]", 2),
        ("height = true", 2),
        ("no-verify = true", 2),
        ("side = 'up'", 2),
        ("side = ", 3),
        ("root = 'x'", 2),
    ],
)
def test_config_is_checked(text: str, code: int, samples: Path, tmp_path: Path) -> None:
    (tmp_path / "lab.toml").write_text(text)
    assert unverified(samples / "egg.png", "--config", "lab.toml").exit_code == code


def test_a_drawn_profile(samples: Path, tmp_path: Path) -> None:
    result = unverified(samples / REST, "--json")
    assert result.exit_code == 0, result.stderr
    design = json.loads(result.stdout)
    assert design["source"]["mm_per_px"] is None
    assert design["source"]["scale_source"] == "vector"
    assert not (tmp_path / "finger_rest_design" / "mask.png").exists()


def test_table_as_csv_json_and_text() -> None:
    rows = list(csv.DictReader(io.StringIO(call("table", "--csv").stdout)))
    assert len(rows) == 336
    assert rows[0] == {
        "pressure_bar": "0.20", "openF_mm": "6", "alpha_closed_deg": "84", "theta_deg": "1.89",
    }  # fmt: skip
    cells = json.loads(call("table", "--json").stdout)
    assert [round(cell["theta_deg"], 2) for cell in cells] == [float(r["theta_deg"]) for r in rows]
    assert call("table").stdout.count("theta (deg)") == 3
    assert call("table", "--openF", "20").exit_code == 2


def test_assign_the_papers_bulb() -> None:
    options = ("--openF", "8,8,8,8,6,10", "--theta", "30,30,30,25,20,45")
    found = json.loads(call("assign", *options, "--json").stdout)
    assert found["pressure_bar"] == 1.9
    assert found["alpha_closed_deg"] == [132, 132, 132, 144, 144, 108]
    assert "pressure 1.90 bar" in call("assign", *options).stdout


@pytest.mark.parametrize(
    ("openF", "theta", "code"),
    [("8,8", "30", 2), ("8,x", "30,30", 2), ("8", "-30", 2), ("8", "60", 6), ("20", "30", 6)],
)
def test_assign_refuses(openF: str, theta: str, code: int) -> None:
    result = call("assign", "--openF", openF, "--theta", theta)
    assert result.exit_code == code
    error_of(result)


def test_template_of_a_design(samples: Path, tmp_path: Path) -> None:
    assert call("template", samples / "paper_bulb.json").exit_code == 0
    folder = tmp_path / "paper_bulb_template"
    assert {path.name for path in folder.iterdir()} >= {"template.dxf", "template.svg"}
    assert call("template", samples / REST).exit_code == 3


def test_debug_shows_the_traceback() -> None:
    assert "Traceback" in call("design", "absent.png", "--debug").stderr


def test_help_shows_an_example_and_the_version() -> None:
    assert "Example:" in call("design", "--help").stdout
    assert call("--version").stdout.startswith("profiletool ")


def test_help_loads_nothing_heavy() -> None:
    code = (
        "import sys, profiletool.cli; "
        "print([m for m in ('numpy','cv2','matplotlib','ezdxf','shapely') if m in sys.modules])"
    )
    loaded = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    )
    assert loaded.stdout.strip() == "[]"


def test_shape_csv_holds_target_and_predicted_line(samples: Path, tmp_path: Path) -> None:
    design = json.loads(unverified(samples / "egg.png", "--json").stdout)
    with (tmp_path / "egg_design" / "shape.csv").open() as file:
        rows = list(csv.DictReader(file))
    for curve, length in (("target", design["source"]["profile_length_mm"]), ("formula", None)):
        points = np.array(
            [[float(r[k]) for k in ("s_mm", "x_mm", "y_mm")] for r in rows if r["curve"] == curve]
        )
        assert np.all(np.diff(points[:, 0]) > 0)
        if length is not None:
            assert points[-1, 0] == pytest.approx(length, abs=0.01)
    first = next(r for r in rows if r["curve"] == "formula")
    assert float(first["x_mm"]) == pytest.approx(design["base_pose"]["x_mm"], abs=1e-3)


@pytest.mark.parametrize(
    ("points", "options", "code"),
    [
        ("500,100\n500,50\n500,0\n", ("--joints", "2"), 5),
        ("0,80\n0,0\n80,0\n", ("--from", "50", "--to", "50.01"), 5),
        ("0,80\n-20,0\n0,-80\n", ("--joints", "300"), 6),
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


def test_a_mirrored_drawing_on_the_other_side_is_the_same_design(
    samples: Path, tmp_path: Path
) -> None:
    rows = [line.split(",") for line in (samples / REST).read_text().splitlines()[1:]]
    (tmp_path / "mirror.csv").write_text("\n".join(f"{-float(x)},{y}" for x, y in rows))
    left = json.loads(unverified(samples / REST, "--json").stdout)
    right = json.loads(unverified("mirror.csv", "--side", "right", "--json").stdout)
    assert right["joints"] == left["joints"]
    assert right["fit"] == left["fit"]
    assert right["base_pose"]["x_mm"] == -left["base_pose"]["x_mm"]


def test_scale_options_on_a_drawing_are_not_silent(samples: Path) -> None:
    design = json.loads(unverified(samples / REST, "--height", 50, "--json").stdout)
    assert any("scale options were not used" in warning for warning in design["warnings"])


def test_the_fit_is_on_the_screen(samples: Path) -> None:
    assert "predicted off the profile:" in unverified(samples / REST).stdout


def test_a_fault_of_ours_is_one_line_too(monkeypatch: pytest.MonkeyPatch, samples: Path) -> None:
    def broken(*_: object) -> None:
        raise RuntimeError("two\nlines")

    monkeypatch.setattr("profiletool.pipeline.run", broken)
    result = unverified(samples / REST)
    assert result.exit_code == 1
    assert "fault in profiletool (RuntimeError: two lines)" in error_of(result)


@pytest.mark.parametrize(
    ("words", "says"),
    [
        ([], "Missing argument 'PICTURE'"),
        (["x.png", "--side", "up"], "'up' is not one of 'left', 'right'"),
        (["x.png", "--height", "tall"], "--height"),
        (["x.png", "--bad"], "--bad"),
    ],
)
def test_bad_usage_is_one_line(
    words: list[str],
    says: str,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setattr(sys, "argv", ["design", *words])
    with pytest.raises(SystemExit) as ended:
        design_main()
    assert ended.value.code == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("error: ")
    assert line.endswith("; see --help")
    assert says in line


def test_exit_codes_pass_through(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for words, code in ((["design", "absent.png"], 3), (["table"], 0), ([], 2), (["--help"], 0)):
        monkeypatch.setattr(sys, "argv", ["profiletool", *words])
        with pytest.raises(SystemExit) as ended:
            main()
        assert ended.value.code == code
    assert "Commands:" in capsys.readouterr().out
