"""Benchmarks run: each with its smallest job, which measures nothing. Those of fem: tests/fem."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.cli.inputs import arc

ROOT = Path(__file__).resolve().parents[2]


def printed(script: str, *arguments: object, code: int = 0) -> str:
    done = subprocess.run(
        [sys.executable, "-W", "error", str(ROOT / "benchmarks" / script), *map(str, arguments)],
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == code, done.stderr[-2000:] + done.stdout[-2000:]
    return done.stdout


@pytest.mark.slow
def test_design_fit(tmp_path: Path) -> None:
    *_, row = printed("design_fit.py", arc(tmp_path)).splitlines()
    name, length, joints, _, paper, optimal, *_, good, _ = row.split()
    assert (name, length, good) == ("arc.csv", "47", "yes")
    assert int(joints) >= 1
    assert 0.0 < float(optimal) <= float(paper)


@pytest.mark.slow
def test_formula_derive(tmp_path: Path) -> None:
    text = printed("formula_derive.py", "--smallest", "--runs", tmp_path)
    assert "cross-validated" in text
    rows = [line for line in text.splitlines() if line.startswith(("0.1 ", "0.2 "))]
    assert len(rows) == 2
    assert len(list(tmp_path.iterdir())) == 9
    known = {path.name: path.stat().st_mtime_ns for path in tmp_path.iterdir()}
    again = printed("formula_derive.py", "--smallest", "--runs", tmp_path)
    assert again.splitlines()[1:] == text.splitlines()[1:]
    assert {path.name: path.stat().st_mtime_ns for path in tmp_path.iterdir()} == known


@pytest.mark.slow
def test_silhouettes(shared: Path) -> None:
    assert (shared / "photos").is_dir()
    text = printed("silhouettes.py", "--ground", "white", "--only", "pear", "--held")
    rows = [line.split() for line in text.splitlines()]
    (row,) = [row for row in rows if row[:1] == ["white"]]
    assert row[1] == "1"
    assert float(row[2]) > 0.95
    assert ["pale", "1"] in [row[:2] for row in rows]
    assert "bulb_on_grey: IoU 0.99" in text


@pytest.mark.slow
def test_scale() -> None:
    text = printed("scale.py", "--smallest", "--random", "0")
    assert "inside the measured part 1 of 1, inside the whole 1 of 1" in text


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="limits of POSIX")
def test_fuzz(tmp_path: Path) -> None:
    keep = tmp_path / "found"
    for kind in ("csv", "toml"):
        row = printed("fuzz.py", 3, "--only", kind, "--keep", keep)
        assert row.split()[:2] == [kind, "3"]
        assert "FINDING" not in row
    assert not keep.exists()
    (tmp_path / "lab.toml").write_text("side = 1")
    assert printed("fuzz.py", "--replay", "toml", tmp_path / "lab.toml") == "exit 2\n"
