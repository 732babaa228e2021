"""Dashes, dimensions, and lines drawn once."""

from __future__ import annotations

import numpy as np
import pytest
from shapely import LineString

from profiletool.template.draughting import CHAIN, dashed, dimension, no_line_twice
from profiletool.template.drawing import Line, polyline


def test_dashes_follow_their_pattern():
    strokes = [line.points for line in dashed("MARK", np.array([[0.0, 0.0], [25.0, 0.0]]), CHAIN)]
    assert [p[:, 0].tolist() for p in strokes] == [
        [0.0, 8.0], [9.5, 11.0], [12.5, 20.5], [22.0, 23.5],
    ]  # fmt: skip
    bent = dashed("MARK", np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 9.0]]), (4.0, 1.0))
    assert bent[0].points.tolist() == [[0, 0], [2, 0], [2, 2]]


@pytest.mark.parametrize("upright", [False, True])
@pytest.mark.parametrize("length", [3.0, 12.0, 60.0])
def test_a_dimension_spans_what_it_says(length, upright):
    turn = (lambda p: p[::-1]) if upright else (lambda p: p)
    a, b = np.array(turn((5.0, 1.0))), np.array(turn((5.0 + length, -4.0)))
    lines, (text,) = dimension(a, b, 20.0, upright, "x ")
    assert text.text == f"x {length:.1f}"
    shafts = [turn(line.points.T) for line in lines if len(line.points) == 2]
    level = [u for u, v in shafts if np.allclose(v, 20.0)]
    assert any(np.allclose(sorted(u), [5.0, 5.0 + length]) for u in level)
    assert dimension(a, a, 20.0, upright) == ((), ())


def test_what_runs_on_a_line_is_taken_away():
    square = np.array([[0, 0], [10, 0], [10, 10], [0, 10]], dtype=float)
    lines = no_line_twice(
        (
            polyline("MARK", (-5, 0), (4, 0)),
            Line("REF", square, closed=True),
            polyline("NOTE", (5, -5), (5, 15)),
            polyline("NOTE", (10, 2), (10, 8)),
        )
    )
    assert len(lines) == 3
    assert not lines[1].closed
    assert LineString(lines[1].points).length == pytest.approx(36.0, abs=0.1)
    assert lines[2].points.tolist() == [[5, -5], [5, 15]]
