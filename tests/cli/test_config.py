"""The file of options."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from profiletool.errors import ProfiletoolError
from profiletool.records.request import Request
from tests.calls import call
from tests.cli.inputs import unverified


@pytest.mark.usefixtures("few_files")
def test_config_gives_defaults_and_the_command_line_wins(samples: Path, tmp_path: Path) -> None:
    (tmp_path / "lab.toml").write_text(
        'side = "right"\nmax-length = 200\nroot = 12\nmethod = "paper"\n'
    )
    made = unverified(samples / "egg.png", "--config", "lab.toml", "--root", 14, "--json")
    design = json.loads(made.stdout)
    assert design["source"]["side"] == "right"
    assert design["tube"]["root_mm"] == 14
    assert design["method"] == "paper"


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


@pytest.mark.parametrize(
    ("text", "grip", "force"),
    [("grip = false", False, None), ("no-grip = true", False, None), ("grip = 1.5", True, 1.5)],
)
def test_the_grip_is_left_out_or_sets_the_pressure(
    text: str, grip: bool, force: float | None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[Request] = []

    def heard(request: Request, *_: object) -> None:
        asked.append(request)
        raise ProfiletoolError("enough")

    monkeypatch.setattr("profiletool.pipeline.run", heard)
    (tmp_path / "lab.toml").write_text(text)
    call("design", "egg.png", "--config", tmp_path / "lab.toml")
    assert [(one.grip, one.grip_N) for one in asked] == [(grip, force)]
