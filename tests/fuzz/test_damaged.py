"""Damaged files of the kinds that people have, through the readers: a result or one line."""

from __future__ import annotations

import sys
from itertools import islice
from pathlib import Path

import pytest

FOLDER = Path(__file__).resolve().parents[2] / "benchmarks"


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="limits of POSIX")
@pytest.mark.parametrize("kind", ["picture", "dxf", "svg", "csv", "rubber"])
def test_damage_ends_in_a_result_or_one_line(
    kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.syspath_prepend(str(FOLDER))
    monkeypatch.setattr(sys, "path", sys.path[:])  # the script adds to it
    import fuzz

    read = fuzz.readers()[kind]
    path = tmp_path / f"input{fuzz.SUFFIX[kind]}"
    for data in islice(fuzz.inputs(kind, 11), 150):
        path.write_bytes(data)
        said = fuzz.outcome_of(kind, path, read)
        assert not said.startswith("!"), said
