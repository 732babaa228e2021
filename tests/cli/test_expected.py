"""The command line as people expect it."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

from profiletool.cli.main import design_main
from profiletool.records.version import VERSION
from tests.calls import call, error_of
from tests.cli.inputs import Made, unverified

COMMANDS = (
    "design", "verify", "joint", "finger", "derive", "table", "assign", "trim", "edit", "report",
    "refine", "template", "sheet",
)  # fmt: skip


@pytest.mark.parametrize("command", COMMANDS)
def test_short_help_says_all_and_knows_a_config(command: str) -> None:
    short = call(command, "-h")
    assert short.exit_code == 0
    assert short.stdout == call(command, "--help").stdout
    assert "--config" in short.stdout
    assert "Example:" in short.stdout


def test_help_of_design_in_panels() -> None:
    text = call("design", "-h").stdout
    panels = (
        "Size of the object", "Finding the object", "What to follow", "Tube", "Method",
        "Finite elements", "Output",
    )  # fmt: skip
    places = [text.index(f"─ {panel} ─") for panel in panels]
    assert places == sorted(places)
    assert text.index("--height") < text.index("--box") < text.index("--from")


def test_both_programs_know_their_version(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert call("--version").stdout == f"profiletool {VERSION}\n"
    monkeypatch.setattr("sys.argv", ["design", "--version"])
    with pytest.raises(SystemExit) as ended:
        design_main()
    assert ended.value.code == 0
    assert capsys.readouterr().out == f"profiletool {VERSION}\n"


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish", "powershell"])
def test_completion(shell: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("_TYPER_COMPLETE_TEST_DISABLE_SHELL_DETECTION", "1")
    script = call("--show-completion", shell)
    assert script.exit_code == 0
    assert "profiletool" in script.stdout


def test_config_serves_every_command(tmp_path: Path) -> None:
    (tmp_path / "lab.toml").write_text('openF = "8"\ncsv = true\n')
    assert (
        call("table", "--config", "lab.toml").stdout == call("table", "--openF", 8, "--csv").stdout
    )
    assert call("table", "--config", "lab.toml", "--openF", 6).stdout == (
        call("table", "--openF", 6, "--csv").stdout
    )
    (tmp_path / "lab.toml").write_text("height = 100\n")
    result = call("table", "--config", "lab.toml")
    assert result.exit_code == 2
    assert '"height" is no option of table; see table --help' in error_of(result)


def test_config_explains_a_flag_that_turns_off(samples: Path, tmp_path: Path) -> None:
    (tmp_path / "lab.toml").write_text("no-verify = true\n")
    result = unverified(samples / "egg.png", "--config", "lab.toml")
    assert result.exit_code == 2
    assert 'write "verify = false" in place of "no-verify"' in error_of(result)


def test_one_line_after_ctrl_c(monkeypatch: pytest.MonkeyPatch, samples: Path) -> None:
    def stopped(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("profiletool.pipeline.run", stopped)
    result = call("design", samples / "egg.png", "--quiet")
    assert (result.exit_code, result.stdout) == (130, "")
    assert result.stderr == "stopped: nothing was written\n"
    assert not Path("egg_design").exists()
    monkeypatch.setattr("profiletool.api.derive_formula", stopped)
    result = call("derive", "--out", "t.json", "--quiet")
    assert result.exit_code == 130
    assert result.stderr == (
        "stopped: every finished run is kept; the same command goes on from there\n"
    )


def test_a_folder_stands_for_its_design(egg: Made) -> None:
    assert call("template", egg.folder).exit_code == 0
    assert Path("egg_template").is_dir()  # named after the object
    assert call("template", egg.folder / "design.json", "--out", "b").exit_code == 0
    for name in ("template.dxf", "design.json"):
        assert Path("egg_template", name).read_bytes() == Path("b", name).read_bytes()
    shutil.rmtree("b")
    assert call("trim", egg.folder, "--tip", "1,2", "--at", 1).exit_code == 3
    assert call("template", Path("egg_template").parent, "--out", "c").exit_code == 3


@pytest.mark.slow
@pytest.mark.usefixtures("coarse_mesh")
def test_a_joint_of_another_rubber_beside_a_formula() -> None:
    options = ("--openF", 8, "--alpha", 120, "--pressure", 0.2, "--json", "--quiet")
    plain = json.loads(call("joint", *options).stdout)
    soft = json.loads(call("joint", *options, "--rubber", "neo-hooke:0.05,0.46").stdout)
    assert soft["theta_deg"][0][-1] > 1.5 * plain["theta_deg"][0][-1]
    beside = json.loads(call("joint", *options, "--formula", "paper").stdout)
    assert beside["theta_deg"] == plain["theta_deg"]
    assert beside["formula"]["name"] == "paper"
    assert beside["formula"]["theta_deg"][0][-1] == pytest.approx(
        beside["theta_deg"][0][-1], rel=0.1
    )
    result = call("joint", *options, "--rubber", "butter")
    assert result.exit_code == 2
    assert "butter" in error_of(result)


@pytest.mark.slow
@pytest.mark.usefixtures("coarse_mesh")
def test_the_finger_of_another_rubber_beside_a_formula() -> None:
    options = ("--pressure", 0.4, "--rubber", "neo-hooke:0.05,0.46", "--formula", "fe")
    text = call("finger", *options, "--quiet").stdout
    assert 'by the formula "' in text
    assert text.count(" deg\n") >= 1
