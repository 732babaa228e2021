from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from profiletool.profile.symmetry import LARGEST_MISMATCH, mirrored_mean, symmetry_of
from profiletool.records.request import Request
from profiletool.subject.find import find_subject

SAMPLES = Path(__file__).parents[2] / "samples"
T = np.linspace(0.0, 2.0 * np.pi, 401)[:-1]
EGG = np.column_stack([20.0 * np.cos(T) * (1.0 + 0.2 * np.sin(T)), 30.0 * np.sin(T)])
# A box 40 wide and 100 high with a handle 20 x 30 on its right.
MUG = np.array(
    [[0, 0], [40, 0], [40, 40], [60, 40], [60, 70], [40, 70], [40, 100], [0, 100]], dtype=float
)


def test_axis_and_mismatch_of_a_mug_by_hand() -> None:
    """The body's axis, not the middle of the whole: there the handle alone finds no counterpart.

    Where the handle is, the mirror image misses 20 mm on the right and so does it on the left.
    """
    found = symmetry_of(MUG)
    assert found.axis_x_mm == pytest.approx(20.0, abs=0.02)
    assert found.mismatch == pytest.approx(2 * 20 * 30 / (40 * 100 + 20 * 30), abs=1e-3)
    assert not found.of_revolution


@pytest.mark.parametrize("direction", [1, -1])
@pytest.mark.parametrize("shift", [0.0, -7.3, 210.0])
def test_a_mirrored_outline_has_its_axis_wherever_it_stands(shift: float, direction: int) -> None:
    found = symmetry_of((EGG + np.array([shift, -3.0]))[::direction])
    assert found.axis_x_mm == pytest.approx(shift, abs=0.02)
    assert found.mismatch < 2e-3
    assert found.of_revolution


def test_the_axis_is_where_the_mismatch_is_least() -> None:
    """A leaning cone: what a hundred axes beside the found one leave is more."""
    cone = np.array([[0.0, 0.0], [60.0, 0.0], [50.0, 80.0], [30.0, 80.0]])
    found = symmetry_of(cone)
    height = np.linspace(0.0, 80.0, 4001)
    left, right = 30.0 * height / 80.0, 60.0 - 10.0 * height / 80.0

    def share(axis: float) -> float:
        shared = np.minimum(right, 2 * axis - left) - np.maximum(left, 2 * axis - right)
        return float(2.0 - 2.0 * np.mean(np.maximum(shared, 0.0)) / np.mean(right - left))

    assert found.mismatch == pytest.approx(share(found.axis_x_mm), abs=2e-3)
    axes = np.linspace(20.0, 50.0, 301)
    assert found.mismatch <= min(map(share, axes)) + 1e-3


@pytest.mark.parametrize("name", ["bulb", "pear", "bottle", "vase", "egg"])
def test_samples_are_bodies_of_revolution(name: str) -> None:
    subject = find_subject(Request(SAMPLES / f"{name}.png"), lambda line: None)
    assert subject.profile.outline is not None
    found = symmetry_of(subject.profile.outline)
    assert found.of_revolution
    assert found.mismatch < 0.1 * LARGEST_MISMATCH
    assert found.axis_x_mm == pytest.approx(0.0, abs=0.1)  # the origin is the top's middle


@settings(max_examples=20, deadline=None)
@given(lobe=st.floats(0.0, 0.5), turn=st.floats(0.0, 6.0))
def test_mirroring_mirrors_the_axis(lobe: float, turn: float) -> None:
    r = 20.0 * (1.0 + lobe * np.cos(T - turn) ** 3)
    outline = np.column_stack([r * np.cos(T), 1.3 * r * np.sin(T)])
    here, there = symmetry_of(outline), symmetry_of(outline * [-1.0, 1.0])
    assert there.mismatch == pytest.approx(here.mismatch, abs=2e-3)
    assert there.axis_x_mm == pytest.approx(-here.axis_x_mm, abs=0.2)


def test_an_outline_without_area_has_no_axis() -> None:
    with pytest.raises(ValueError, match="no axis"):
        symmetry_of(np.array([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]]))


def test_mean_of_unequal_sides_lies_half_way() -> None:
    """A box whose right side is 2 mm farther from the axis than its left one."""
    box = np.array([[-10.0, 0.0], [12.0, 0.0], [12.0, 40.0], [-10.0, 40.0]])
    mean = mirrored_mean(box, 0.0, 0.25)
    middle = mean[(mean[:, 1] > 5.0) & (mean[:, 1] < 35.0)]
    np.testing.assert_allclose(np.abs(middle[:, 0]), 11.0, atol=0.02)
    assert mean[:, 1].min() == pytest.approx(0.0, abs=0.02)
    assert mean[:, 1].max() == pytest.approx(40.0, abs=0.02)


@pytest.mark.parametrize("direction", [1, -1])
def test_mean_is_symmetric_and_runs_counter_clockwise(direction: int) -> None:
    bump = 2.0 * np.exp(-(((T - 0.3) / 0.2) ** 2))
    outline = (EGG + np.column_stack([bump, 0.0 * T]) + np.array([50.0, -7.0]))[::direction]
    mean = mirrored_mean(outline, 50.0, 0.3)
    there = np.column_stack([100.0 - mean[:, 0], mean[:, 1]])
    order, other = np.lexsort(mean.T.round(6)), np.lexsort(there.T.round(6))
    np.testing.assert_allclose(mean[order], there[other], atol=1e-5)
    assert shapely.LinearRing(mean).is_ccw
    # The bump goes in half on both sides.
    for side in (1.0, -1.0):
        x, y = EGG[np.argmin(np.abs(T - 0.3))]
        off = shapely.LinearRing(mean).distance(shapely.Point(50.0 + side * (x + 1.0), y - 7.0))
        assert off < 0.1


def test_mean_of_a_mirror_image_is_itself() -> None:
    mean = mirrored_mean(EGG, 0.0, 0.2)
    assert shapely.LinearRing(mean).hausdorff_distance(shapely.LinearRing(EGG)) < 0.03
