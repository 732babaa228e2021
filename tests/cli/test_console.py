"""The progress bar."""

from __future__ import annotations

import io
import sys

import pytest

from profiletool.cli.console import progress_bar


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def test_a_bar_on_a_terminal_only(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setenv("NO_COLOR", "1")
    for stream, quiet, shown in (
        (Terminal(), False, True), (Terminal(), True, False), (io.StringIO(), False, False),
    ):  # fmt: skip
        monkeypatch.setattr(sys, "stderr", stream)
        with progress_bar("finite elements", quiet) as show:
            assert (show is not None) == shown
            if show is not None:
                assert stream.getvalue() == ""  # nothing before the first share
                show(0.5)
        assert ("finite elements" in stream.getvalue()) == shown
        assert "\x1b[3" not in stream.getvalue()  # no colours
