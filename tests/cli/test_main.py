"""Entry points: help, usage errors, exit codes, imports."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from profiletool.cli.main import design_main, main
from tests.calls import call, error_of
from tests.cli.inputs import REST, unverified


def test_debug_shows_the_traceback() -> None:
    assert "Traceback" in call("design", "absent.png", "--debug").stderr


def test_help_shows_an_example_and_the_version() -> None:
    assert "Example:" in call("design", "--help").stdout
    assert call("--version").stdout.startswith("profiletool ")


def test_help_loads_nothing_heavy() -> None:
    code = (
        "import sys, profiletool.cli.main; "
        "heavy = ('numpy','scipy','fem','cv2','matplotlib','ezdxf','shapely','rich'); "
        "print([m for m in heavy if m in sys.modules])"
    )
    loaded = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    )
    assert loaded.stdout.strip() == "[]"


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
    assert "Commands" in capsys.readouterr().out
