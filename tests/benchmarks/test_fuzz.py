"""The campaign of damaged inputs tells what is a finding and what is not."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import pytest

FOLDER = Path(__file__).resolve().parents[2] / "benchmarks"


@pytest.fixture
def fuzz(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """The script as a module."""
    monkeypatch.syspath_prepend(str(FOLDER))
    monkeypatch.setattr(sys, "path", sys.path[:])  # the script adds to it
    import fuzz

    return fuzz


def options(fuzz: ModuleType, folder: Path, text: str = "side = 'up'") -> str:
    """What comes of a file of options."""
    path = folder / "lab.toml"
    path.write_text(text)
    return str(fuzz.outcome_of("toml", path, fuzz.readers()["toml"]))


def breaks(error: Exception) -> Callable[..., None]:
    def broken(*_: object, **__: object) -> None:
        raise error

    return broken


def test_refused_options_are_no_finding(fuzz: ModuleType, tmp_path: Path) -> None:
    assert options(fuzz, tmp_path) == "exit 2"
    assert options(fuzz, tmp_path, "side = ") == "exit 3"
    assert options(fuzz, tmp_path, "side = 'left'") == "exit 3"  # good ones, and no picture


@pytest.mark.parametrize("place", ["files.read.read_file", "cli.design.request_of"])
def test_an_exception_while_options_are_read_is_a_finding(
    fuzz: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, place: str
) -> None:
    monkeypatch.setattr(f"profiletool.{place}", breaks(ZeroDivisionError("a bug")))
    said = options(fuzz, tmp_path, "side = 'left'")
    assert said.startswith("! ")
    assert "a bug" in said


@pytest.mark.parametrize("kind", ["csv", "rubber", "formula"])
def test_an_exception_of_a_reader_is_a_finding(fuzz: ModuleType, tmp_path: Path, kind: str) -> None:
    path = tmp_path / "a.csv"
    path.write_text("0,0\n")
    assert fuzz.outcome_of(kind, path, breaks(KeyError("x"))).startswith("! Traceback")


def test_a_changed_input_and_a_file_left_behind_are_findings(
    fuzz: ModuleType, tmp_path: Path
) -> None:
    path = tmp_path / "a.csv"
    path.write_text("0,0\n")
    assert fuzz.outcome_of("csv", path, Path.read_bytes) == "ok"
    for careless in (lambda p: p.write_text("1,1\n"), lambda p: (tmp_path / "more").touch()):
        assert fuzz.outcome_of("csv", path, careless) == "! the input or its folder was changed"


def test_the_same_seed_gives_the_same_inputs(fuzz: ModuleType) -> None:
    one, other, seeded = (
        [data for data, _ in zip(fuzz.inputs("csv", seed), range(20), strict=False)]
        for seed in (1, 1, 2)
    )
    assert one == other
    assert one != seeded
    assert len(set(one)) > 10
