"""Objects on the printed sheet."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest
from PIL import Image

from profiletool.errors import NoScale, Unsure, UsageError
from profiletool.image.sheet.board import BOARDS
from profiletool.image.sheet.rectify import Rectified, rectify
from profiletool.profile.upright import turned
from profiletool.records.picture import Picture, Scale, Silhouette
from profiletool.records.request import Look, ScaleRequest
from profiletool.subject import photo
from profiletool.subject.photo import Seen
from profiletool.subject.sheet import distance_note, measure_on_sheet
from tests.image.views import Shot, bulb, photograph
from tests.subject.objects import PEAR, SHOT, look_at, size_of


@pytest.fixture(scope="module", autouse=True)
def once() -> Iterator[None]:
    """Rectify every photograph once: it takes longer than all that is asked of it here."""
    known: dict[bytes, Rectified | None] = {}

    def rectified(picture: Picture) -> Rectified | None:
        key = picture.rgb.tobytes()
        if key not in known:
            known[key] = rectify(picture)
        return known[key]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(photo, "rectify", rectified)
        yield


@pytest.fixture(scope="module")
def lying() -> Picture:
    """A bulb that lies across the sheet."""
    return photograph(BOARDS[0], bulb(), SHOT, np.random.default_rng(3), turn=85.0)


@pytest.fixture(scope="module")
def lying_file(lying: Picture, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("sheet") / "a.png"
    Image.fromarray(lying.rgb).save(path)
    return path


@pytest.fixture(scope="module")
def sheet(lying: Picture) -> Rectified:
    made = rectify(lying)
    assert made is not None
    return made


@pytest.fixture(scope="module")
def stood(lying_file: Path) -> Seen:
    """Nothing said but that it shall stand."""
    return look_at(lying_file, ScaleRequest(), rotate="auto")


def test_on_the_sheet_nothing_needs_to_be_said_of_size_and_way_up(stood: Seen) -> None:
    seen = stood
    body = bulb()
    assert seen.scale.source == "sheet"
    share = seen.scale.measured_error
    assert share is not None
    assert 0.01 < share < 0.06
    for found, true in zip(size_of(seen), (body.width, body.length), strict=True):
        assert found == pytest.approx(true, rel=0.01)
    assert abs(seen.rotated_deg) == pytest.approx(90.0, abs=10.0)


@pytest.mark.parametrize(
    ("shot", "turn"),
    [
        (replace(SHOT, tilt=30.0, azimuth=0.0, k1=0.0), 135.0),
        *(pytest.param(SHOT, turn, marks=pytest.mark.slow) for turn in (85.0, 40.0)),
    ],
)
@pytest.mark.slow
def test_on_the_sheet_it_may_lie_any_way(tmp_path: Path, shot: Shot, turn: float) -> None:
    """Not turned upright, it has its own size along its own axis all the same."""
    body = bulb(0.9)
    made = photograph(BOARDS[0], body, shot, np.random.default_rng(6), turn=turn)
    Image.fromarray(made.rgb).save(tmp_path / "a.png")
    seen = look_at(tmp_path / "a.png", ScaleRequest())
    contour = seen.silhouette.contour_px * [1.0, -1.0] * seen.scale.mm_per_px
    size = np.ptp(turned(contour, turn), axis=0)
    np.testing.assert_allclose(size, [body.width, body.length], rtol=0.01)
    assert [note for note in seen.notes if "deg off upright" in note]


def test_a_slab_on_the_sheet_keeps_the_outline_that_is_seen(
    lying: Picture, sheet: Rectified
) -> None:
    """What no axis mirrors has no section: its scale only is that of its height."""
    wedge = np.array([[300.0, 300.0], [600.0, 420.0], [330.0, 640.0]])
    mask = np.zeros((1, 1), bool)
    silhouette = Silhouette(wedge, mask, "plain ground", 0.05, frozenset())
    seen, scale = measure_on_sheet(sheet, silhouette, ScaleRequest())
    np.testing.assert_allclose(seen.contour_px, wedge, atol=1e-6)
    assert sheet.picture.mm_per_px is not None
    assert 0.8 * sheet.picture.mm_per_px < scale.mm_per_px < sheet.picture.mm_per_px


@pytest.mark.parametrize("distance", [0.6, 60.0, 1e9])
def test_a_camera_somewhere_else_than_the_sheet_shows_is_refused(
    lying_file: Path, distance: float
) -> None:
    with pytest.raises(UsageError, match=r"but the sheet shows the camera about \d{3} mm"):
        look_at(lying_file, ScaleRequest(camera_distance_mm=distance))


@pytest.mark.parametrize(("factor", "told"), [(1.03, False), (1.4, True), (0.7, True)])
def test_a_distance_that_the_sheet_does_not_show_is_told(
    sheet: Rectified, factor: float, told: bool
) -> None:
    distance = factor * sheet.camera.height_mm
    said = list(distance_note(sheet, ScaleRequest(camera_distance_mm=distance)))
    known = replace(sheet, camera=replace(sheet.camera, height_share=0.02))
    surely = list(distance_note(known, ScaleRequest(camera_distance_mm=distance)))
    assert bool(surely) is told
    assert len(said) <= len(surely)  # a file without a focal length leaves more open
    assert not list(distance_note(known, ScaleRequest(height_mm=60.0)))


def test_what_the_sheet_tells_is_not_given_another_way(lying_file: Path) -> None:
    with pytest.raises(UsageError, match="leave `mm_per_px` away"):
        look_at(lying_file, ScaleRequest(mm_per_px=0.2))
    with pytest.raises(NoScale, match="leave `marker_mm` away"):
        look_at(lying_file, ScaleRequest(marker_mm=30.0))


@pytest.mark.slow
def test_a_marker_in_the_field_sets_the_sheets_size_right(
    lying: Picture, sheet: Rectified, tmp_path: Path
) -> None:
    """Said to be 33 mm, it makes all else a tenth larger."""
    assert sheet.picture.mm_per_px is not None
    cells = cv2.aruco.generateImageMarker(
        cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_4X4_50), 5, 120
    )
    side = round(30.0 / sheet.picture.mm_per_px)
    rgb = lying.rgb.copy()
    left, top = round(0.6 * sheet.frame.width), round(0.62 * sheet.frame.height)
    corners = np.array([[0, 0], [side, 0], [side, side], [0, side]]) + np.array([left, top])
    here = np.array([[-0.5, -0.5], [119.5, -0.5], [119.5, 119.5], [-0.5, 119.5]])
    to = cv2.getPerspectiveTransform(
        here.astype(np.float32), sheet.photo_of(corners.astype(float)).astype(np.float32)
    )
    size = (rgb.shape[1], rgb.shape[0])
    shown = cv2.warpPerspective(np.full_like(cells, 255), to, size) > 127
    rgb[shown] = cv2.warpPerspective(cells, to, size, flags=cv2.INTER_AREA)[shown][:, None]
    Image.fromarray(rgb).save(tmp_path / "a.png")
    for side_mm in (30.0, 33.0):
        seen = look_at(tmp_path / "a.png", ScaleRequest(marker_mm=side_mm), rotate="auto")
        assert seen.scale.source == "marker"
        share = seen.scale.measured_error
        assert share is not None
        assert share < 0.06
        np.testing.assert_allclose(
            size_of(seen), np.array([60.0, 106.0]) * side_mm / 30.0, rtol=0.015
        )


def test_the_mask_is_the_photographs(stood: Seen, lying: Picture) -> None:
    """The body is the one dark red thing in it."""
    mask = stood.silhouette.mask
    red = lying.rgb[..., 0].astype(int) - lying.rgb[..., 2] > 45
    assert mask.shape == lying.rgb.shape[:2]
    assert (mask & red).sum() / (mask | red).sum() > 0.97


def test_a_given_length_goes_before_the_sheets(lying_file: Path) -> None:
    seen = look_at(lying_file, ScaleRequest(width_mm=106.0))
    assert seen.scale.source == "width"
    assert size_of(seen)[0] == pytest.approx(106.0)
    assert seen.scale.measured_error is None


def test_photograph_and_frontal_view_are_brought_onto_each_other(sheet: Rectified) -> None:
    corners = np.array([[0.0, 0.0], [1.0, 0.0], [0.3, 0.7], [1.0, 1.0]])
    frontal = corners * [sheet.frame.width - 1.0, sheet.frame.height - 1.0]
    np.testing.assert_allclose(sheet.frontal_of(sheet.photo_of(frontal)), frontal, atol=1e-6)


def test_hints_on_the_sheet_are_the_photographs(
    lying_file: Path, lying: Picture, stood: Seen, tmp_path: Path
) -> None:
    red = lying.rgb[..., 0].astype(int) - lying.rgb[..., 2] > 45
    rows, columns = np.flatnonzero(red.any(axis=1)), np.flatnonzero(red.any(axis=0))
    Image.fromarray(red.astype(np.uint8) * 255).save(tmp_path / "mask.png")
    box = (columns[0] - 12.0, rows[0] - 12.0, np.ptp(columns) + 24.0, np.ptp(rows) + 24.0)
    for look in (
        {"point": (float(columns.mean()), float(rows.mean()))},
        {"box": box},
        {"mask": tmp_path / "mask.png"},
    ):
        seen = look_at(lying_file, ScaleRequest(), rotate="auto", **look)
        np.testing.assert_allclose(size_of(seen), size_of(stood), rtol=0.015)
        assert (seen.silhouette.method == "mask") is ("mask" in look)
    off = np.zeros_like(red)
    off[:20, :20] = True
    Image.fromarray(off).save(tmp_path / "off.png")
    for look in (
        {"point": (1.0, 1.0)},
        {"box": (0.0, 0.0, 20.0, 20.0)},
        {"mask": tmp_path / "off.png"},
    ):
        with pytest.raises(UsageError, match="outside the printed sheet"):
            look_at(lying_file, ScaleRequest(), **look)


def test_doubt_on_the_sheet_shows_the_photograph(
    lying_file: Path, lying: Picture, sheet: Rectified, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A disc in the frontal view, doubted, comes back where the photograph has it."""
    spot = np.array([0.4 * sheet.frame.width, 0.6 * sheet.frame.height])

    def doubt(picture: Picture, *_: object) -> Silhouette:
        y, x = np.mgrid[: picture.rgb.shape[0], : picture.rgb.shape[1]]
        disc = np.hypot(x - spot[0], y - spot[1]) < 20.0
        raise Unsure("what is it", ((disc, 0.3, "a way"),), picture.rgb)

    monkeypatch.setattr("profiletool.subject.sheet.find_silhouette", doubt)
    with pytest.raises(Unsure) as caught:
        look_at(lying_file, ScaleRequest())
    ((mask, confidence, method),) = caught.value.candidates
    assert (confidence, method) == (0.3, "a way")
    np.testing.assert_array_equal(caught.value.rgb, lying.rgb)
    rows, columns = np.nonzero(mask)
    np.testing.assert_allclose([columns.mean(), rows.mean()], sheet.photo_of(spot), atol=1.5)


def test_what_a_marker_leaves_open_is_told() -> None:
    """Without the camera's distance the object's height above the marker stays unknown."""
    silhouette = Silhouette(np.zeros((4, 2)), np.zeros((2, 2), bool), "mask", 0.0, frozenset())
    said = photo._notes(
        replace(silhouette, contour_px=PEAR * [1.0, -1.0]),
        Scale(0.1, "marker", 0.051),
        Look(),
    )
    assert [note for note in said if "5.1 % off" in note and "`camera_distance_mm`" in note]
