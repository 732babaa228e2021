"""From a picture's file to the object in it: hints, the printed sheet, upright and symmetric."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest
import shapely
from PIL import Image

from profiletool.errors import NoObject, NoScale, Unsure, UsageError
from profiletool.image.load import load_picture
from profiletool.image.sheet.board import BOARDS
from profiletool.image.sheet.rectify import Rectified, rectify
from profiletool.profile.symmetry import symmetry_of
from profiletool.profile.upright import turned
from profiletool.records.picture import Picture, Scale, Silhouette
from profiletool.records.request import Look, Request, ScaleRequest
from profiletool.records.units import FloatArray
from profiletool.report.scene import backdrop_of
from profiletool.subject import photo
from profiletool.subject.find import find_subject
from profiletool.subject.photo import Seen, see
from profiletool.subject.sheet import distance_note, measure_on_sheet
from tests.image.views import Shot, bulb, photograph

T = np.linspace(0.0, 2.0 * np.pi, 1201)[:-1]
# Narrow above, heavy below: 80 wide and 120 high, y up.
PEAR = np.column_stack([40.0 * np.cos(T) * (1.0 - 0.35 * np.sin(T)), 60.0 * np.sin(T)])
PEAR_WIDTH, PEAR_HEIGHT = np.ptp(PEAR, axis=0).tolist()
HEIGHT = ScaleRequest(height_mm=PEAR_HEIGHT)
SHOT = Shot(600, 25, 30, k1=-0.08, fill=0.7, size=(720, 960))


def drawn(
    path: Path,
    outlines: list[FloatArray],
    size: tuple[int, int] = (480, 400),
    k: float = 2.0,
) -> Path:
    """Fill outlines, mm, y up, off the middle of a picture of (width, height)."""
    fine = 4
    width, height = (fine * side for side in size)
    image = np.full((height, width, 3), 236, np.uint8)
    for outline in outlines:
        px = (outline * [k * fine, -k * fine] + [width / 2.0, height / 2.0]).round().astype(int)
        cv2.fillPoly(image, [px.astype(np.int32)], (60, 90, 50))
    Image.fromarray(cv2.resize(image, size, interpolation=cv2.INTER_AREA)).save(path)
    return path


def look_at(file: Path, asked: ScaleRequest = HEIGHT, **look: object) -> Seen:
    return see(load_picture(file), asked, Look(**look), lambda line: None)  # type: ignore[arg-type]


def size_of(seen: Seen) -> tuple[float, float]:
    width, height = np.ptp(seen.silhouette.contour_px, axis=0) * seen.scale.mm_per_px
    return float(width), float(height)


# --- upright --------------------------------------------------------------------------------


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


@pytest.mark.parametrize("turn", [90.0, 30.0, -140.0])
def test_the_overlay_turns_its_picture_with_the_outline(turn: float) -> None:
    """A red dot on grey, found again where the turn brings it."""
    rgb = np.full((200, 320, 3), 128, np.uint8)
    dot = np.array([250.0, 40.0])
    cv2.circle(rgb, (250, 40), 4, (255, 0, 0), -1)
    middle = np.array([159.5, 99.5])
    origin = np.array([150.0, 20.0])
    back = backdrop_of(Picture(rgb, None, None, "PNG"), 0.5, (150.0, 20.0), turn)
    red = (back.rgb[..., 0] > 200) & (back.rgb[..., 1] < 80)
    rows, columns = np.nonzero(red)
    left, right, bottom, top = back.extent
    height, width = red.shape
    x = left + (columns.mean() + 0.5) * (right - left) / width
    y = top - (rows.mean() + 0.5) * (top - bottom) / height
    there = turned((dot - middle) * [1.0, -1.0], turn) * [1.0, -1.0] + middle
    np.testing.assert_allclose([x, y], (there - origin) * [0.5, -0.5], atol=0.3)


# --- symmetric ------------------------------------------------------------------------------


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


# --- hints ----------------------------------------------------------------------------------

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


# --- the printed sheet ----------------------------------------------------------------------


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
    [(SHOT, 85.0), (replace(SHOT, tilt=30.0, azimuth=0.0, k1=0.0), 135.0), (SHOT, 40.0)],
)
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


def test_a_marker_in_the_field_sets_the_sheets_size_right(lying: Picture, tmp_path: Path) -> None:
    """Said to be 33 mm, it makes all else a tenth larger."""
    sheet = rectify(photograph(BOARDS[0], None, SHOT, np.random.default_rng(3)))
    assert sheet is not None
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


# --- drawings -------------------------------------------------------------------------------


def csv(path: Path, points: FloatArray) -> Path:
    path.write_text("x,y\n" + "".join(f"{x:.4f},{y:.4f}\n" for x, y in points))
    return path


def asked(file: Path, **look: object) -> Request:
    return Request(file, verify=False, look=Look(**look))  # type: ignore[arg-type]


def test_drawings_are_turned_and_averaged_too(tmp_path: Path) -> None:
    closed = np.vstack([PEAR, PEAR[:1]])
    stands = find_subject(asked(csv(tmp_path / "a.csv", closed)), str)
    file = csv(tmp_path / "b.csv", turned(closed, 70.0))
    for rotate in (-70.0, "auto"):
        made = find_subject(asked(file, rotate=rotate), str)
        assert made.rotated_deg == pytest.approx(-70.0, abs=0.1)
        assert made.profile.length_mm == pytest.approx(stands.profile.length_mm, rel=2e-3)
    lopsided = np.where(closed[:, :1] > 0.0, closed * [1.1, 1.0], closed)
    mean = find_subject(asked(csv(tmp_path / "c.csv", lopsided), symmetric=True), str)
    outline = mean.profile.outline
    assert outline is not None
    half = 0.5 * (np.ptp(PEAR[:, 0]) * 1.05)
    assert np.ptp(outline[:, 0]) == pytest.approx(2.0 * half, rel=2e-3)


def test_an_open_profile_has_no_axis(tmp_path: Path) -> None:
    file = csv(tmp_path / "a.csv", PEAR[300:900])
    for look in ({"rotate": "auto"}, {"symmetric": True}):
        with pytest.raises(UsageError, match="open profile"):
            find_subject(asked(file, **look), str)
    plain, half = find_subject(asked(file), str), find_subject(asked(file, rotate=5.0), str)
    assert half.profile.length_mm == pytest.approx(plain.profile.length_mm, rel=0.01)
    assert half.rotated_deg == 5.0


def test_what_a_marker_leaves_open_is_told() -> None:
    """Without the camera's distance the object's height above the marker stays unknown."""
    silhouette = Silhouette(np.zeros((4, 2)), np.zeros((2, 2), bool), "mask", 0.0, frozenset())
    said = photo._notes(
        replace(silhouette, contour_px=PEAR * [1.0, -1.0]),
        Scale(0.1, "marker", 0.051),
        Look(),
    )
    assert [note for note in said if "5.1 % off" in note and "`camera_distance_mm`" in note]
