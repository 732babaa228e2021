"""The engine's benchmarks run: each with its smallest job, which measures nothing."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.slow

ROOT = Path(__file__).resolve().parents[2]


STAGES = ("material", "factorise", "solid")


def printed(script: str, *arguments: str) -> str:
    done = subprocess.run(
        [sys.executable, "-W", "error", str(ROOT / "benchmarks" / script), *arguments],
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr[-2000:] + done.stdout[-2000:]
    return done.stdout


def test_growth(tmp_path: Path) -> None:
    plot = tmp_path / "growth.png"
    text = printed(
        "fem_growth.py", "--joints", "1", "2", "--repeat", "1", "--bar", "0.03", "--out", str(plot)
    )
    assert "time ~ length^" in text
    assert plot.read_bytes().startswith(b"\x89PNG")


def test_profile() -> None:
    text = printed("fem_profile.py", "--joint", "--bar", "0.1", "--functions", "3")
    rows = [line.split() for line in text.splitlines()]
    shares = {row[0]: float(row[-1]) for row in rows if row and row[0] in STAGES and len(row) == 3}
    assert min(shares.values()) > 1.0
    assert len(shares) == 3
    assert sum(shares.values()) < 100.0
    # 20-node bricks: the stiffness is some GFLOP a factorisation as the elimination.
    (line,) = [line for line in text.splitlines() if line.startswith("factorisations ")]
    factorise, stiffness = float(line.split()[1]), float(line.split()[5])
    assert 0.2 < stiffness / factorise < 5.0


def test_robustness() -> None:
    text = printed("fem_robustness.py", "--only", "54", "--workers", "1")
    assert "1 of 1 end, 1 must: ok" in text


def test_speed() -> None:
    text = printed("fem_speed.py", "--repeat", "1", "--no-campaign", "--share", "0.02")
    for name in ("one joint to 2.0 bar", "bulb to 1.9 bar", "whole 3-D", "import fem.solver"):
        assert name in text
