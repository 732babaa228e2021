"""Errors of a build, as text and by name."""

from __future__ import annotations

import math

import pytest

from profiletool.errors import UsageError
from profiletool.records.built import BuildErrors, build_errors


def test_the_text_of_errors_is_read_back() -> None:
    errors = BuildErrors(pressure=0.03, thread=0.0)
    assert build_errors(str(errors)) == errors
    assert build_errors(" rubber=3, cut = 0 ") == BuildErrors(rubber=3.0, cut=0.0)
    assert build_errors("") == BuildErrors()
    assert build_errors({"wall": 5}) == BuildErrors(wall=5.0)
    assert build_errors(errors) == errors


def test_sigma_is_that_of_a_uniform_distribution() -> None:
    assert BuildErrors(cut=1.0).sigma("cut") == pytest.approx(math.sqrt(1.0 / 3.0))


@pytest.mark.parametrize(
    ("given", "says"),
    [
        ("thred=1", "no error 'thred'"),
        ("thread", "not 'thread'"),
        ("thread=x", "not 'thread=x'"),
        ("thread=-1", "thread must be 0 to 5"),
        ("rubber=nan", "rubber must be 0 to 50"),
        ("wall=99", "wall must be 0 to 50"),
        ({"cut": "1"}, "cut must be"),
        ({"cut": True}, "cut must be"),
    ],
)
def test_bounds_that_make_no_sense(given: str | dict[str, float], says: str) -> None:
    with pytest.raises(UsageError, match=says):
        build_errors(given)
