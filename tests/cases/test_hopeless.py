"""Inputs that no tube can follow end before any finite elements run."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from profiletool import design, pipeline
from profiletool.joints.plan import out_of_reach
from profiletool.records.request import Request, TubeSpec

FILES = Path(__file__).parent / "files"


def test_what_is_out_of_reach() -> None:
    request = Request(Path("a.csv"), tube=TubeSpec(max_length_mm=250.0))
    assert out_of_reach(270.0, 0.5, request) == ""
    assert "the profile is 427 mm long and the tube at most 250 mm" in out_of_reach(
        427.0, 0.5, request
    )
    assert out_of_reach(100.0, 7.9, request) == ""
    assert "lie 9.0 mm RMS off the profile, where 1.00 mm will do" in out_of_reach(
        100.0, 9.0, request
    )


@pytest.mark.slow
@pytest.mark.parametrize("method", ["paper", "optimal"])
def test_no_finite_elements_for_a_profile_longer_than_the_tube(
    monkeypatch: pytest.MonkeyPatch, method: str
) -> None:
    def never(*_: Any, **__: Any) -> None:
        raise AssertionError("finite elements were run")

    monkeypatch.setattr(pipeline, "check", never)
    monkeypatch.setattr(pipeline.FeForwardModel, "bend", never)
    result = design(FILES / "csv-cm.csv", method=method)
    assert not result.design.feasible
    assert not result.design.verified
    assert any("no finite elements were run; shorten" in note for note in result.design.warnings)
    assert any("mm long, more than 250 mm" in reason for reason in result.reasons)
