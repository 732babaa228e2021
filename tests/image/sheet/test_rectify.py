"""Photographs of the printed sheet: the frontal view, the sizes in it, and what is said of it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import cv2
import numpy as np
import pytest

from profiletool.image.find.silhouette import find_silhouette
from profiletool.image.marker import find_markers
from profiletool.image.sheet.board import BOARDS
from profiletool.image.sheet.measure import measure
from profiletool.image.sheet.rectify import Rectified, edge_warnings, rectify
from profiletool.records.picture import Picture
from tests.image.trials import Trial, extents, trial
from tests.image.views import BODIES, POSES, PX_PER_MM, Shot, paper, photograph, random_shot, sphere

A4, LETTER = BOARDS
QUICK = ["overhead, 0.5 m", "from below, 30 deg", "near, slanted, barrel"]
SMALL = Shot(500, 4, 60, size=(540, 720))


def rng(seed: int = 5) -> np.random.Generator:
    return np.random.default_rng(seed)


@cache
def good() -> Rectified:
    return seen()


def seen(shot: Shot = SMALL, change: Callable[[np.ndarray], None] | None = None) -> Rectified:
    """Rectify a photograph of the sheet with a ball on it, after a change to its pixels."""
    picture = photograph(A4, sphere(25), shot, rng())
    if change is not None:
        change(picture.rgb)
    made = rectify(picture)
    assert made is not None
    return made


# --- sizes ---------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "kind"),
    [
        pytest.param(name, kind, marks=() if "slanted" in name else pytest.mark.slow)
        for name, kind in zip(QUICK, BODIES, strict=True)
    ],
)
def test_sizes_from_three_poses(name: str, kind: str) -> None:
    tried = trial(BODIES[kind], replace(POSES[name], size=(720, 960)), rng())
    assert abs(tried.worst) < 0.01
    assert tried.inside
    assert tried.measured.round
    assert tried.made.tilt_deg == pytest.approx(POSES[name].tilt, abs=1.0)
    assert tried.made.reprojection_px < 0.1


@pytest.mark.slow
def test_sizes_from_all_poses_and_random_ones() -> None:
    generator = rng(11)
    kinds = list(BODIES)
    shots = [*POSES.values(), *(random_shot(generator) for _ in range(14))]

    def tried(number: int, shot: Shot) -> Trial:
        stored = float(generator.normal(0, 0.03))
        board = BOARDS[number % 2]
        body = BODIES[kinds[number % 3]]
        return trial(body, replace(shot, size=(720, 960)), generator, board, stored)

    trials = [tried(number, shot) for number, shot in enumerate(shots)]
    errors = np.abs([one.worst for one in trials])
    assert errors.max() < 0.01
    assert np.mean([one.inside for one in trials]) >= 0.95
    # What the sheet itself says is no more than it can know: the bars are not just wide.
    assert np.mean([one.inside_measured for one in trials]) > 0.8
    assert max(one.measured.measured_share for one in trials) < 0.012


@pytest.mark.slow
def test_flat_disc_keeps_its_size_under_tilt_and_distortion() -> None:
    sheet = paper(A4).copy()
    cv2.circle(sheet, (1050, 1485), 300, 0.2, -1, cv2.LINE_AA)
    shot = Shot(500, 25, 30, k1=-0.1, fill=0.65)
    made = rectify(photograph(A4, None, shot, rng(), sheet=sheet))
    assert made is not None
    assert made.picture.mm_per_px is not None
    assert made.lens_terms == 1
    size = np.ptp(find_silhouette(made.plain).contour_px, axis=0) * made.picture.mm_per_px
    np.testing.assert_allclose(size, 600 / PX_PER_MM, rtol=2e-3)


def test_print_that_is_too_large_is_within_the_bar() -> None:
    tried = trial(sphere(25), replace(SMALL, printed=1.003), rng())
    assert tried.worst == pytest.approx(-0.003, abs=0.002)
    assert tried.inside_measured


# --- the camera ----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("shot", "focal_error", "sure"),
    [
        (SMALL, 0.0, 0.05),
        pytest.param(replace(SMALL, tilt=0.0), 0.04, 0.05, marks=pytest.mark.slow),
        (replace(SMALL, tilt=25.0), None, 0.02),
        (replace(SMALL, tilt=0.0), None, 0.5),
    ],
)
def test_height_is_as_sure_as_is_said(shot: Shot, focal_error: float | None, sure: float) -> None:
    made = rectify(photograph(A4, None, shot, rng(), focal_error=focal_error))
    assert made is not None
    height = shot.distance * np.cos(np.radians(shot.tilt))
    assert made.camera.height_share < sure
    assert abs(made.camera.height_mm / height - 1) < 2.5 * made.camera.height_share + 1e-3
    unsure = any("`camera_distance_mm`" in text for text in made.warnings)
    assert unsure == (made.camera.height_share > 0.15)


@pytest.mark.slow
def test_measured_distance_stands_in_for_an_unknown_one() -> None:
    shot = replace(SMALL, tilt=0.0)
    blind = trial(sphere(30), shot, rng(), focal_error=None)
    told = trial(sphere(30), shot, rng(), focal_error=None, camera_distance_mm=500.0)
    assert abs(told.worst) < 0.005
    assert told.measured.measured_share < 0.01
    assert blind.measured.measured_share > 0.03
    assert blind.inside_measured


def test_straight_lens_gets_no_terms() -> None:
    assert good().lens_terms == 0


# --- the frontal view ----------------------------------------------------------------------


@pytest.mark.parametrize("turns", [1, 2, pytest.param(3, marks=pytest.mark.slow)])
def test_up_stays_up(turns: int) -> None:
    picture = photograph(A4, BODIES["bulb"], SMALL, rng(), at=(0.0, 0.0))
    turned = replace(picture, rgb=np.ascontiguousarray(np.rot90(picture.rgb, turns)))
    made = rectify(turned)
    assert made is not None
    height, width = made.picture.rgb.shape[:2]
    assert (height > width) == (turns % 2 == 0)
    mask = find_silhouette(made.plain).mask
    x, y = np.argwhere(mask).mean(axis=0)[::-1] - (np.array([width, height]) - 1) / 2
    # The globe is heavier than the neck and above the middle in the picture as taken.
    heavier = {0: (0, -1), 1: (-1, 0), 2: (0, 1), 3: (1, 0)}[turns]
    assert (x, y) @ np.array(heavier) > 0.02 * height
    assert made.hidden == 0


def test_frame_is_painted_over_and_the_squares_are_told() -> None:
    made = good()
    assert made.hidden == 0
    assert len(made.squares) == len(A4.squares())
    k = made.picture.mm_per_px
    assert k is not None
    for square in made.squares:
        np.testing.assert_allclose(np.ptp(square, axis=0) * k, 16.0, atol=1e-6)
    assert made.picture.rgb.min() < 40
    rim = made.plain.rgb[: round(32 / k)]
    assert rim.min() > 180
    assert made.plain.rgb.shape == made.picture.rgb.shape


def test_alpha_is_warped_too() -> None:
    picture = photograph(A4, None, SMALL, rng())
    alpha = np.full(picture.rgb.shape[:2], 255, np.uint8)
    alpha[400:500, 300:400] = 0
    made = rectify(replace(picture, alpha=alpha))
    assert made is not None
    assert made.picture.alpha is not None
    assert made.picture.alpha.shape == made.picture.rgb.shape[:2]
    assert made.picture.alpha.min() == 0


def test_marker_on_the_sheet_is_still_read() -> None:
    sheet = paper(A4).copy()
    dictionary = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_4X4_50)
    cells = cv2.aruco.generateImageMarker(dictionary, 3, 300).astype(np.float32) / 255
    sheet[1900:2200, 900:1200] = cells
    made = rectify(photograph(A4, None, SMALL, rng(), sheet=sheet))
    assert made is not None
    (quad,) = find_markers(made.picture)
    sides = np.hypot(*(np.roll(quad, -1, axis=0) - quad).T) * (made.picture.mm_per_px or 0)
    np.testing.assert_allclose(sides, 30.0, rtol=0.01)


# --- parts and warnings --------------------------------------------------------------------


def test_a_third_of_the_corners_hidden() -> None:
    whole = good()

    def cover(rgb: np.ndarray) -> None:
        rgb[:, : round(0.32 * rgb.shape[1])] = (60, 110, 60)

    made = seen(change=cover)
    assert 0.5 < made.corners_seen / made.corners_total < 0.75
    assert made.hidden > 20
    assert made.picture.mm_per_px == pytest.approx(whole.picture.mm_per_px, rel=3e-3)
    np.testing.assert_allclose(made.camera.foot_px, whole.camera.foot_px, atol=12)


def test_hidden_squares_are_left_as_they_are() -> None:
    picture = photograph(A4, BODIES["bulb"], SMALL, rng(), at=(-70.0, 0.0))
    made = rectify(picture)
    assert made is not None
    silhouette = find_silhouette(made.plain)
    assert made.hidden > 2
    said = edge_warnings(made, silhouette)
    assert any("hides" in text for text in said)
    assert edge_warnings(good(), find_silhouette(good().plain)) == ()


@pytest.mark.parametrize(
    ("kind", "shot", "at"),
    [
        ("bulb", replace(POSES["from the side, 30 deg"], size=(720, 960)), (-8.0, 0.0)),
        pytest.param("cylinder", SMALL, (-60.0, 10.0), marks=pytest.mark.slow),
        pytest.param("bulb", replace(SMALL, aim=(60.0, 90.0)), (0.0, 0.0), marks=pytest.mark.slow),
    ],
)
def test_size_over_the_frame_or_on_part_of_it(
    kind: str, shot: Shot, at: tuple[float, float]
) -> None:
    body = BODIES[kind]
    made = rectify(photograph(A4, body, shot, rng(), at))
    assert made is not None
    assert made.hidden > 0
    found = measure(made, find_silhouette(made.plain))
    np.testing.assert_allclose(extents(found, 0.0), (body.width, body.length), rtol=0.01)


@pytest.mark.parametrize(
    ("shot", "words"),
    [
        (replace(SMALL, aim=(60.0, 90.0)), "runs out of the picture"),
        (replace(SMALL, tilt=35.0, fill=0.6), "slant of 35 degrees"),
        (replace(SMALL, distance=280.0, fill=0.7), "mm away"),
        (replace(SMALL, fill=0.45, blur=0.3), "small in the picture"),
    ],
)
def test_what_may_go_wrong_is_said(shot: Shot, words: str) -> None:
    said = seen(shot).warnings
    assert any(words in text for text in said), said


def test_few_corners_are_said() -> None:
    def cover(rgb: np.ndarray) -> None:
        rgb[round(0.35 * rgb.shape[0]) :] = 90

    made = seen(change=cover)
    assert any("hide less" in text for text in made.warnings)
    assert made.error_share > good().error_share


def test_a_good_picture_has_no_warnings() -> None:
    assert good().warnings == ()


@pytest.mark.parametrize(("rows", "enough"), [(90, False), (120, False), (200, True)])
def test_a_single_line_of_corners_is_no_sheet(rows: int, enough: bool) -> None:
    picture = photograph(A4, None, SMALL, rng())
    rgb = np.full_like(picture.rgb, 120)
    rgb[-rows - 80 : -80] = picture.rgb[-rows - 80 : -80]
    made = rectify(Picture(rgb, None, None, "PNG"))
    assert (made is not None) == enough
    if made is not None:
        assert made.camera.height_mm == pytest.approx(500.0, rel=4 * made.camera.height_share)
