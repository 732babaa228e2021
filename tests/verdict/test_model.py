"""Notes on the model: which one bent a design, and what its mesh leaves."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from profiletool.files.design_json import load_design
from profiletool.records.built import BuiltMisfit
from profiletool.records.design import Design
from profiletool.records.model import ModelInputs
from profiletool.records.options import in_flags
from profiletool.verdict.model import model_notes


@pytest.fixture(scope="module")
def design(samples: Path) -> Design:
    paper = load_design(samples / "paper_bulb.json")
    return replace(paper, verified=True, tube=replace(paper.tube, length_mm=118.0))


def test_the_papers_model_is_named_with_what_it_leaves_out(design: Design) -> None:
    (note,) = model_notes(design, True)
    assert "Poisson's ratio, 0.46" in note
    assert note.endswith("the mesh leaves up to 0.6 mm in the shape")
    assert "(--nu)" in in_flags(note)


def test_another_model_is_named_and_whether_joints_were_corrected_by_it(design: Design) -> None:
    other = replace(design, model=ModelInputs(nu=0.49, gravity="down"))
    first, second = model_notes(other, True)
    assert first.startswith("finite elements take Poisson's ratio 0.49, gravity down; the mesh")
    assert "the first choice of joints is by the paper's model" in second
    assert list(model_notes(other, False)) == [first]


def test_a_model_that_nothing_took_is_said(design: Design) -> None:
    idle = replace(design, verified=False)
    assert list(model_notes(idle, True)) == []
    (note,) = model_notes(replace(idle, model=ModelInputs(thread_factor=2.0)), True)
    assert note == "no finite elements took threads 2 times as stiff into account"


def test_threads_that_lie_far_off_are_said(design: Design) -> None:
    near = replace(design, threads_off_mm=BuiltMisfit(0.65, 0.2))
    far = replace(design, threads_off_mm=BuiltMisfit(9.1, 0.8))
    assert len(list(model_notes(near, True))) == 1
    said, _ = model_notes(far, True)
    assert "0.8 mm RMS apart once the pressure is set, 9.1 before" in said
