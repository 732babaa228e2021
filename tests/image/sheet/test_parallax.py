"""Thick objects look larger: the closed forms, the section, and what a marker's scale says."""

from __future__ import annotations

import math
from pathlib import Path

import cv2
import numpy as np
import pytest
from PIL import Image
from scipy.spatial import ConvexHull

from profiletool.errors import NoScale
from profiletool.image.load import load_picture
from profiletool.image.scale import scale_of
from profiletool.image.sheet.parallax import Camera, axis_height, remaining, shrinkage
from profiletool.image.sheet.section import lying_section
from profiletool.records.picture import Picture, Silhouette
from profiletool.records.request import ScaleRequest
from tests.image.views import BODIES, Body, capsule, sphere

ANGLES = np.linspace(0, 2 * np.pi, 721)[:-1]


def silhouette_of(contour: np.ndarray, noise_px: float = 0.0) -> Silhouette:
    return Silhouette(contour, np.zeros((1, 1), bool), "plain ground", noise_px, frozenset())


def outline_on_sheet(body: Body, camera: np.ndarray, turn: float = 0.0) -> np.ndarray:
    """Where the rays that graze a body meet the sheet: the outer hull of its spheres' cones."""
    axis = np.array([-math.sin(turn), math.cos(turn), 0.0])
    middles = [np.array([0, 0, body.radius.max()]) + s * axis for s in body.place]
    eye = np.asarray(camera, float)
    foot = middles[int(np.argmax(body.radius))][:2]
    # From a point inside outwards, by bisection: is the ray to the sheet there inside any sphere?
    low, high = np.zeros(len(ANGLES)), np.full(len(ANGLES), 400.0)
    directions = np.column_stack([np.cos(ANGLES), np.sin(ANGLES)])
    start = eye[:2] + (foot - eye[:2]) * eye[2] / (eye[2] - body.radius.max())
    for _ in range(40):
        middle = 0.5 * (low + high)
        rays = np.column_stack([start + middle[:, None] * directions, np.zeros(len(ANGLES))]) - eye
        rays /= np.linalg.norm(rays, axis=1)[:, None]
        inside = np.zeros(len(ANGLES), bool)
        for place, radius in zip(middles, body.radius, strict=True):
            off = place - eye
            inside |= (off @ off) - (rays @ off) ** 2 < radius**2
        low, high = np.where(inside, middle, low), np.where(inside, high, middle)
    return np.asarray(start + (0.5 * (low + high))[:, None] * directions)


# --- closed forms --------------------------------------------------------------------------


@pytest.mark.parametrize("height", [200.0, 300.0, 1000.0])
@pytest.mark.parametrize("radius", [10.0, 30.0, 45.0])
def test_radius_from_the_shadow_of_a_ball(radius: float, height: float) -> None:
    ring = outline_on_sheet(sphere(radius), np.array([0, 0, height]))
    half = 0.5 * float(np.ptp(ring[:, 0]))
    assert half == pytest.approx(radius / math.sqrt(1 - 2 * radius / height), rel=1e-4)
    assert axis_height(half, height) == pytest.approx(radius, rel=1e-4)


def test_known_numbers() -> None:
    # A 60 mm bulb is 6 % too large at half a metre and 1.5 % at two.
    assert 1 / shrinkage(30, 500) - 1 == pytest.approx(0.06, abs=0.005)
    assert 1 / shrinkage(30, 2000) - 1 == pytest.approx(0.015, abs=0.001)
    assert shrinkage(0, 500) == 1.0


def test_what_remains() -> None:
    overhead = remaining(30, Camera((0, 0), 500, 0.03), 0.0, section=False)
    assert overhead.distance == pytest.approx(2 * 0.03 * 30 / 470)
    assert overhead.shape == pytest.approx(0.3 * 30 / 470, rel=0.02)
    slanted = remaining(30, Camera((0, 0), 500, 0.03), 270.0, section=False)
    assert slanted.shape > 1 / math.cos(math.radians(29)) - 1
    rounded = remaining(30, Camera((0, 0), 500, 0.03), 270.0, section=True)
    assert rounded.shape < 0.5 * slanted.shape


# --- the section ---------------------------------------------------------------------------


@pytest.mark.parametrize("kind", BODIES)
@pytest.mark.parametrize(
    "camera",
    [(0, 0, 300), (20, -15, 500), (150, 0, 260), (0, 260, 450), (-200, 200, 600), (40, 30, 2000)],
)
def test_section_of_a_body_of_revolution(kind: str, camera: tuple[float, float, float]) -> None:
    body = BODIES[kind]
    ring = outline_on_sheet(body, np.array(camera, float))
    section = lying_section(ring, np.array(camera, float))
    assert section is not None
    assert section.height_mm == pytest.approx(body.radius.max(), rel=2e-3)
    size = np.ptp(section.points, axis=0)
    np.testing.assert_allclose(size, (body.width, body.length), rtol=5e-3)
    if kind != "bulb":
        np.testing.assert_allclose(section.points.mean(axis=0), 0.0, atol=1.0)


def test_section_of_a_body_that_lies_askew() -> None:
    body, camera, turn = capsule(20, 120), np.array([150.0, 120.0, 500.0]), math.radians(12)
    section = lying_section(outline_on_sheet(body, camera, turn), camera)
    assert section is not None
    across = section.points @ [math.cos(turn), math.sin(turn)]
    along = section.points @ [-math.sin(turn), math.cos(turn)]
    assert np.ptp(across) == pytest.approx(40, rel=3e-3)
    assert np.ptp(along) == pytest.approx(120, rel=3e-3)


@pytest.mark.parametrize("camera", [(0, 0, 600), (10, 60, 500), (120, 30, 500), (0, 200, 500)])
def test_flat_end_stays_flat(camera: tuple[float, float, float]) -> None:
    # A cylinder is the hull of its two rims, and so is what hides the sheet.
    eye = np.array(camera, float)
    rims = np.concatenate(
        [
            np.column_stack([20 * np.cos(ANGLES), np.full(720, end), 20 + 20 * np.sin(ANGLES)])
            for end in (-50.0, 50.0)
        ]
    )
    seen = eye[:2] + (rims[:, :2] - eye[:2]) * (eye[2] / (eye[2] - rims[:, 2:]))
    section = lying_section(seen[ConvexHull(seen).vertices], eye)
    assert section is not None
    np.testing.assert_allclose(np.ptp(section.points, axis=0), (40, 100), rtol=0.01)


def test_box_is_hardly_changed() -> None:
    ring = np.array([[-20.0, -50.0], [20.0, -50.0], [20.0, 50.0], [-20.0, 50.0]])
    section = lying_section(ring, np.array([0.0, 0.0, 600.0]))
    assert section is not None
    ratio = np.ptp(section.points, axis=0) / (40, 100)
    np.testing.assert_allclose(ratio, 1 - section.height_mm / 600, rtol=0.02)


def test_mug_is_no_body_of_revolution() -> None:
    mug = np.array(
        [[-30, -40], [30, -40], [30, -25], [60, -25], [60, 25], [30, 25], [30, 18], [50, 18],
         [50, -18], [30, -18], [30, 40], [-30, 40]], float
    )  # fmt: skip
    assert lying_section(mug, np.array([0.0, 0.0, 500.0])) is None


# --- scales --------------------------------------------------------------------------------


def with_marker(side: int = 120, focal_px: float | None = None) -> Picture:
    rgb = np.full((1000, 1400, 3), 255, np.uint8)
    dictionary = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_4X4_50)
    rgb[60 : 60 + side, 60 : 60 + side] = cv2.aruco.generateImageMarker(dictionary, 1, side)[
        ..., None
    ]
    return Picture(cv2.GaussianBlur(rgb, (0, 0), 0.7), None, None, "JPEG", focal_px)


def ball(radius: float, distance: float, mm_per_px: float) -> Silhouette:
    half = radius / math.sqrt(1 - 2 * radius / distance) / mm_per_px
    return silhouette_of(half * np.column_stack([np.cos(ANGLES), np.sin(ANGLES)]) + 500)


def test_marker_and_distance_give_the_size_of_a_ball() -> None:
    found = ball(30, 500, 0.25)
    scale = scale_of(with_marker(), found, ScaleRequest(marker_mm=30, camera_distance_mm=500))
    size = float(np.ptp(found.contour_px[:, 0])) * scale.mm_per_px
    assert size == pytest.approx(60, rel=0.01)
    assert scale.error_share is not None
    assert abs(size / 60 - 1) < scale.error_share < 0.03


def test_marker_alone_says_what_parallax_may_do() -> None:
    found = ball(30, 500, 0.25)
    plain = scale_of(with_marker(), found, ScaleRequest(marker_mm=30))
    assert plain.mm_per_px == pytest.approx(0.25, rel=0.005)
    size = float(np.ptp(found.contour_px[:, 0])) * plain.mm_per_px
    told = scale_of(with_marker(focal_px=2000.0), found, ScaleRequest(marker_mm=30))
    assert plain.error_share is not None
    assert told.error_share is not None
    assert abs(size / 60 - 1) < told.error_share < 0.1
    far = scale_of(with_marker(focal_px=8000.0), found, ScaleRequest(marker_mm=30))
    assert far.error_share is not None
    assert far.error_share < 0.5 * told.error_share


def test_every_source_says_how_sure_it_is() -> None:
    found = silhouette_of(np.array([[10.0, 20], [10, 120], [60, 120], [60, 20]]), noise_px=0.1)
    picture = Picture(np.zeros((200, 200, 3), np.uint8), None, 0.25, "PNG")
    shares = [
        scale_of(picture, found, request).error_share
        for request in (
            ScaleRequest(height_mm=50),
            ScaleRequest(width_mm=50),
            ScaleRequest(mm_per_px=0.5),
            ScaleRequest(),
        )
    ]
    two = 2 * math.sqrt(2) * 0.1
    assert shares == [pytest.approx(two / 100), pytest.approx(two / 50), None, 0.005]


def test_camera_inside_the_object_is_refused() -> None:
    with pytest.raises(NoScale, match="too near"):
        scale_of(
            with_marker(),
            ball(30, 500, 0.25),
            ScaleRequest(marker_mm=30, camera_distance_mm=40.0),
        )


def test_focal_length_is_read_from_exif(tmp_path: Path) -> None:
    image = Image.new("RGB", (400, 300), (200, 200, 200))
    exif = image.getexif()
    exif.get_ifd(0x8769)[0xA405] = 26
    image.save(tmp_path / "photo.jpg", exif=exif)
    image.save(tmp_path / "plain.jpg")
    focal = load_picture(tmp_path / "photo.jpg").focal_px
    assert focal == pytest.approx(26 / 43.27 * 500)
    assert load_picture(tmp_path / "plain.jpg").focal_px is None
