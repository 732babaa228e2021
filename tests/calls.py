"""The command line as tests call it: by the entry point of the console script."""

from __future__ import annotations

import io
import sys
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import dataclass
from unittest.mock import patch

from profiletool.cli.main import main


@dataclass(frozen=True)
class Result:
    """What a call printed, and its exit code."""

    exit_code: int
    stdout: str
    stderr: str


def call(*arguments: object) -> Result:
    out, err, code = io.StringIO(), io.StringIO(), 0
    words = ["profiletool", *(str(argument) for argument in arguments)]
    with redirect_stdout(out), redirect_stderr(err), patch.object(sys, "argv", words):
        try:
            main()
        except SystemExit as ended:
            code = int(ended.code or 0)
    return Result(code, out.getvalue(), err.getvalue())


def error_of(result: Result) -> str:
    """The one line that says what is wrong."""
    lines = [line for line in result.stderr.splitlines() if line.startswith("error: ")]
    assert len(lines) == 1, result.stderr
    assert "Traceback" not in result.stderr
    return lines[0]
