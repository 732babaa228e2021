"""The command studio before there is a page: what it lacks, and what stands in its way."""

from __future__ import annotations

import socket
from pathlib import Path

import pytest

from profiletool.cli import studio
from tests.calls import call, error_of


def test_without_the_extra_it_says_what_to_install(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(studio, "find_spec", lambda name: None)
    result = call("studio", "--no-browser")
    assert result.exit_code == 2
    assert "pip install" in error_of(result)
    assert "[studio]" in error_of(result)
    assert list(tmp_path.iterdir()) == []


def test_a_port_that_is_taken(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    with socket.socket() as other:
        other.bind(("127.0.0.1", 0))
        other.listen()
        port = other.getsockname()[1]
        result = call("studio", "--no-browser", "--port", port)
    assert result.exit_code == 1
    assert f"port {port} cannot be taken" in error_of(result)
    assert "--port" in error_of(result)
    assert list(tmp_path.iterdir()) == []
