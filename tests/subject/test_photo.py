"""From a picture's file to the object in it: upright, symmetric, hints."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import shapely
from PIL import Image

from profiletool.errors import NoObject, UsageError
from profiletool.profile.symmetry import symmetry_of
from profiletool.profile.upright import turned
from tests.subject.objects import PEAR, PEAR_HEIGHT, PEAR_WIDTH, drawn, look_at, size_of


@pytest.mark.parametrize("lean", [-38.0, 14.0, 90.0])
def test_turned_upright_it_has_its_own_width(tmp_path: Path, lean: float) -> None:
    seen = look_at(drawn(tmp_path / "a.png", [turned(PEAR, lean)]), rotate="auto")
    assert seen.rotated_deg == pytest.approx(-lean, abs=0.2)
    assert size_of(seen)[0] == pytest.approx(PEAR_WIDTH, rel=0.01)
    assert seen.notes == ()


def test_degrees_turn_counter_clockwise(tmp_path: Path) -> None:
    """A pear whose narrow end points right comes to point up by a quarter turn."""
    seen = look_at(drawn(tmp_path / "a.png", [turned(PEAR, -90.0)]), rotate=90.0)
    x, y = seen.silhouette.contour_px.T
    assert x[np.argmin(x)] < x.mean()
    assert y[np.argmax(x)] > 0.5 * (y.min() + y.max())  # the widest place is below the middle


def test_a_lean_is_told_and_left(tmp_path: Path) -> None:
    seen = look_at(drawn(tmp_path / "a.png", [turned(PEAR, 20.0)]))
    assert seen.rotated_deg == 0.0
    assert [note for note in seen.notes if "stands 20 deg off upright" in note]
    upright = look_at(drawn(tmp_path / "b.png", [PEAR]))
    assert upright.notes == ()


def test_an_object_without_axis_is_not_turned(tmp_path: Path) -> None:
    wedge = np.array([[-50.0, -30.0], [60.0, -40.0], [-20.0, 55.0]])
    file = drawn(tmp_path / "a.png", [wedge])
    with pytest.raises(NoObject, match="`rotate` DEG"):
        look_at(file, rotate="auto")
    assert look_at(file, rotate=10.0).rotated_deg == 10.0


@pytest.mark.parametrize(
    ("shift", "turn", "touches"),
    [
        ((-90.0, 0.0), 90.0, {"bottom"}),
        ((-90.0, 0.0), -90.0, {"top"}),
        ((0.0, 70.0), 180.0, {"bottom"}),
        ((-90.0, 0.0), 45.0, {"left", "bottom"}),
        ((-90.0, 0.0), 10.0, {"left"}),
    ],
)
def test_edges_turn_with_the_object(
    tmp_path: Path, shift: tuple[float, float], turn: float, touches: set[str]
) -> None:
    seen = look_at(drawn(tmp_path / "a.png", [PEAR + shift]), rotate=turn)
    assert seen.silhouette.touches == touches


def test_the_mean_of_both_sides_is_taken(tmp_path: Path) -> None:
    """The right side is 4 % farther out: both sides come to lie 2 % out."""
    lopsided = np.where(PEAR[:, :1] > 0.0, PEAR * [1.04, 1.0], PEAR)
    file = drawn(tmp_path / "a.png", [lopsided], size=(800, 600), k=4.0)
    plain, mean = look_at(file), look_at(file, symmetric=True)
    assert size_of(mean)[0] == pytest.approx(size_of(plain)[0], rel=0.003)
    assert size_of(mean)[1] == pytest.approx(PEAR_HEIGHT, abs=1e-6)  # the height that was given
    here, there = (symmetry_of(one.silhouette.contour_px).mismatch for one in (plain, mean))
    assert there < 1e-3
    assert here > 10.0 * there


def test_unlike_sides_are_not_averaged(tmp_path: Path) -> None:
    mug = np.array(
        [[-40, -50], [40, -50], [40, -30], [70, -30], [70, 30], [40, 30], [40, 50], [-40, 50]],
        dtype=float,
    )
    with pytest.raises(NoObject, match="two sides differ"):
        look_at(drawn(tmp_path / "a.png", [mug]), symmetric=True)


def test_a_side_out_of_the_frame_is_not_averaged(tmp_path: Path) -> None:
    with pytest.raises(NoObject, match="no two sides"):
        look_at(drawn(tmp_path / "a.png", [PEAR + np.array([90.0, 0.0])]), symmetric=True)


TWO = [0.6 * PEAR + np.array([-55.0, 0.0]), 0.6 * PEAR + np.array([55.0, 0.0])]


def test_of_two_objects_alike_a_hint_takes_one(tmp_path: Path) -> None:
    file = drawn(tmp_path / "a.png", TWO)
    with pytest.raises(NoObject):
        look_at(file)
    mask = np.zeros((400, 480), np.uint8)
    mask[100:300, 280:420] = 255
    Image.fromarray(mask).save(tmp_path / "mask.png")
    for look in ({"point": (350.0, 200.0)}, {"box": (270.0, 80.0, 170.0, 240.0)}):
        assert look_at(file, **look).silhouette.contour_px[:, 0].min() > 280.0
    seen = look_at(file, mask=tmp_path / "mask.png")
    np.testing.assert_allclose(np.ptp(seen.silhouette.contour_px, axis=0), [140, 200], atol=2.0)
    assert seen.silhouette.method == "mask"


def test_a_mask_is_narrowed_by_point_and_box(tmp_path: Path) -> None:
    """Of two regions the smaller one, which alone would not be taken."""
    file = drawn(tmp_path / "a.png", TWO)
    mask = np.zeros((400, 480), np.uint8)
    mask[100:300, 280:440] = 255
    mask[120:280, 60:170] = 255
    Image.fromarray(mask).save(tmp_path / "mask.png")
    assert look_at(file, mask=tmp_path / "mask.png").silhouette.contour_px[:, 0].min() > 270.0
    for look in ({"point": (100.0, 200.0)}, {"box": (40.0, 80.0, 160.0, 240.0)}):
        seen = look_at(file, mask=tmp_path / "mask.png", **look)
        np.testing.assert_allclose(np.ptp(seen.silhouette.contour_px, axis=0), [110, 160], atol=2)
    with pytest.raises(UsageError, match="outside what `mask` holds"):
        look_at(file, mask=tmp_path / "mask.png", point=(220.0, 20.0))
    with pytest.raises(UsageError, match="outside what `mask` holds"):
        look_at(file, mask=tmp_path / "mask.png", point=(479.9, 399.9))  # in the last pixel


def test_masks_that_show_nothing(tmp_path: Path) -> None:
    file = drawn(tmp_path / "a.png", [PEAR])
    speck = np.zeros((400, 480), np.uint8)
    speck[200, 200] = 255
    Image.fromarray(speck).save(tmp_path / "speck.png")
    with pytest.raises(UsageError, match="nothing 16 pixels wide"):
        look_at(file, mask=tmp_path / "speck.png")
    speck[20:100, 20:90] = 255
    Image.fromarray(speck).save(tmp_path / "beside.png")
    seen = look_at(file, mask=tmp_path / "beside.png")
    assert [note for note in seen.notes if "follows nothing" in note]


@pytest.mark.parametrize("name", ["pear_alpha.png", "cylinder_alpha.png", "bulb_on_grey.jpg"])
def test_a_mask_given_back_gives_the_same_outline(shared: Path, tmp_path: Path, name: str) -> None:
    """Of a cut-out trimmed to its own size too, which runs into no frame."""
    first = look_at(shared / "photos" / name)
    Image.fromarray(first.silhouette.mask).save(tmp_path / "mask.png")
    again = look_at(shared / "photos" / name, mask=tmp_path / "mask.png")
    assert again.silhouette.touches == first.silhouette.touches
    np.testing.assert_allclose(size_of(again), size_of(first), rtol=0.01)
    here, there = (shapely.Polygon(one.silhouette.contour_px) for one in (first, again))
    assert here.symmetric_difference(there).area / here.area < 0.02


def test_a_box_through_the_object_is_told(tmp_path: Path) -> None:
    file = drawn(tmp_path / "a.png", [PEAR])
    through = look_at(file, box=(100.0, 60.0, 280.0, 200.0))
    assert [note for note in through.notes if "runs along `box`" in note]
    round_ = look_at(file, box=(100.0, 40.0, 280.0, 320.0))
    assert not [note for note in round_.notes if "`box`" in note]


def test_hints_that_do_not_fit_are_refused(tmp_path: Path) -> None:
    file = drawn(tmp_path / "a.png", [PEAR])
    with pytest.raises(UsageError, match="`point`"):
        look_at(file, point=(480.0, 10.0))
    with pytest.raises(UsageError, match="`box`"):
        look_at(file, box=(400.0, 10.0, 100.0, 100.0))
