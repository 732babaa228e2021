"""The example scripts run, each in a folder of its own, and print what the guide says of them."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
EXAMPLES = ROOT / "examples"
GUIDE = ROOT / "docs" / "examples.md"
# Whole designs one after the other, or finite elements of more than some seconds.
SLOW = {
    "change_a_joint.py", "figure.py", "own_points.py", "own_rubber.py", "picture_to_files.py",
    "step_by_step.py",
}  # fmt: skip
SCRIPTS = [
    pytest.param(file, id=file.stem, marks=pytest.mark.slow if file.name in SLOW else ())
    for file in sorted(EXAMPLES.glob("*.py"))
]


def run(file: Path, folder: Path) -> str:
    environment = os.environ | {"PYTHONPATH": str(ROOT), "MPLBACKEND": "agg"}
    done = subprocess.run(
        [sys.executable, "-W", "error", str(file)],
        cwd=folder, env=environment, capture_output=True, text=True, timeout=300,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    return done.stdout


def shown(file: Path) -> str:
    """The output that the guide shows below an example."""
    _, _, section = GUIDE.read_text("utf-8").partition(f"../examples/{file.name}")
    found = re.search(r"```text\n(.*?)```", section.partition("literalinclude")[0], re.DOTALL)
    assert found is not None, f"{file.name} is not in the guide with its output"
    return found[1]


def words(text: str) -> list[str]:
    """Text without its numbers, which the next mesh or library may move in the last digit."""
    return re.sub(r"\d+(\.\d+)?", "#", text).split()


def numbers(text: str) -> list[float]:
    return [float(number) for number in re.findall(r"\d+(?:\.\d+)?", text)]


@pytest.mark.parametrize("file", SCRIPTS)
def test_an_example_prints_what_the_guide_shows(file: Path, tmp_path: Path) -> None:
    printed = run(file, tmp_path)
    assert words(printed) == words(shown(file))
    # A design's numbers go in steps (threads, millimetres): another machine may take the next one.
    assert numbers(printed) == pytest.approx(numbers(shown(file)), rel=0.1, abs=0.5)
    named = re.findall(r"[\w]+\.(?:png|json|dxf)\b", printed)
    assert all((tmp_path / name).stat().st_size > 1000 for name in named)


def test_no_example_has_the_name_of_a_package() -> None:
    """Python looks beside a script first: formula.py there would hide the package formula."""
    assert len(SCRIPTS) >= 7
    names = {file.stem for file in EXAMPLES.glob("*.py")}
    assert not names & ({*sys.stdlib_module_names} | {"profiletool", "fem", "formula"})


@pytest.mark.parametrize("file", SCRIPTS)
def test_an_example_is_short_and_uses_public_names_only(file: Path) -> None:
    text = file.read_text("utf-8")
    assert len(text.splitlines()) <= 40
    assert not re.search(r"^(from|import) (profiletool|fem|formula)\.", text, re.MULTILINE)
