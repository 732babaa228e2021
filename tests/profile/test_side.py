from __future__ import annotations

import numpy as np
import pytest

from profiletool.profile.curve import arc_length
from profiletool.profile.side import Stretch, side_of, top_middle

T = np.linspace(0.0, 2.0 * np.pi, 721)[:-1]
CIRCLE = 30.0 * np.column_stack([np.cos(T), np.sin(T)])
BOX = np.array([[0.0, 0.0], [40.0, 0.0], [40.0, 100.0], [0.0, 100.0]])


def on(stretch: Stretch) -> np.ndarray:
    s = arc_length(stretch.points)
    at = np.linspace(stretch.start, stretch.end, 50)
    return np.column_stack([np.interp(at, s, stretch.points[:, k]) for k in (0, 1)])


def test_top_middle_of_a_box_is_the_middle_of_its_top() -> None:
    np.testing.assert_allclose(top_middle(BOX), [20.0, 100.0])


def test_top_middle_takes_the_highest_run_only() -> None:
    horned = np.array(
        [[0, 0], [40, 0], [40, 90], [30, 90], [25, 100], [15, 100], [10, 60], [0, 60]]
    )
    np.testing.assert_allclose(top_middle(horned.astype(float)), [20.0, 100.0], atol=0.6)


@pytest.mark.parametrize("direction", [1, -1])
@pytest.mark.parametrize(("side", "sense"), [("left", -1.0), ("right", 1.0)])
def test_a_box_side_runs_from_the_top_middle_to_the_bottom_middle(
    side: str, sense: float, direction: int
) -> None:
    points = on(side_of(BOX[::direction], side, 5.0))
    np.testing.assert_allclose(points[0], [20.0, 100.0], atol=1e-9)
    np.testing.assert_allclose(points[-1], [20.0, 0.0], atol=1e-9)
    assert np.all(np.diff(points[:, 1]) <= 1e-9)
    np.testing.assert_allclose(points[len(points) // 2], [20.0 + sense * 20.0, 50.0], atol=2.0)


def test_left_and_right_mirror_each_other() -> None:
    pear = CIRCLE * np.column_stack([1.0 - 0.3 * np.sin(T), np.full(len(T), 1.5)])
    left, right = on(side_of(pear, "left", 3.0)), on(side_of(pear, "right", 3.0))
    np.testing.assert_allclose(left * [-1.0, 1.0], right, atol=0.1)


def test_what_lies_beyond_the_ends_is_kept() -> None:
    stretch = side_of(CIRCLE, "left", 5.0)
    assert stretch.start == 5.0
    first = stretch.points[0]
    assert np.hypot(*(first - [0.0, 30.0])) == pytest.approx(5.0, abs=0.01)
    assert first[0] > 0.0
