"""Cells of the report's tables."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from profiletool.files.design_json import load_design
from profiletool.records.built import SectorThreads
from profiletool.report.tables import threads_left


def test_uncut_threads_are_those_that_design_json_counts(samples: Path) -> None:
    design = load_design(samples / "paper_bulb.json")
    first = design.joints[0]
    rows = (SectorThreads(1, 1, 7, 0.5), SectorThreads(1, 2, 8, 0.5), SectorThreads(2, 1, 9, 0.5))
    assert threads_left(first, replace(design, threads=rows)) == "7 / 8"
    same = replace(design, threads=tuple(replace(row, uncut=8) for row in rows))
    assert threads_left(first, same) == "8"
    assert threads_left(first, replace(design, threads=())) == "–"  # a file of the first schema
