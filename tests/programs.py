"""Other programs that read what we write."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

import pytest


def program(name: str) -> str:
    """Find a program; skip the test without it.

    PROFILETOOL_NEED_PROGRAMS=1 turns the skip into a failure, so that CI cannot pass without it.
    """
    found = shutil.which(name)
    if found is None:
        if os.environ.get("PROFILETOOL_NEED_PROGRAMS") == "1":
            pytest.fail(f"{name} is not installed, and PROFILETOOL_NEED_PROGRAMS=1 demands it")
        pytest.skip(f"{name} is not installed")
    return found


def run(name: str, *arguments: object, cwd: Path) -> str:
    """Run a program without a screen in a folder, which is its home too; give what it prints."""
    settings = {**os.environ, "QT_QPA_PLATFORM": "offscreen", "HOME": str(cwd)}
    done = subprocess.run(
        [program(name), *map(str, arguments)],
        cwd=cwd,
        env=settings,
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout
