"""Which source of the scale wins, and what a marker says."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from profiletool.errors import NoScale, UsageError
from profiletool.image.find.silhouette import find_silhouette
from profiletool.image.marker import find_markers
from profiletool.image.scale import scale_of
from profiletool.records.picture import Picture, Silhouette
from profiletool.records.request import ScaleRequest

OUTLINE = np.array([[10.0, 20.0], [10.0, 120.0], [60.0, 120.0], [60.0, 20.0]])
SILHOUETTE = Silhouette(OUTLINE, np.zeros((1, 1), bool), "alpha matte", 0.0, frozenset())


def picture_of(rgb: np.ndarray, mm_per_px: float | None = None) -> Picture:
    return Picture(rgb, None, mm_per_px, "PNG")


PLAIN = picture_of(np.full((200, 200, 3), 255, np.uint8))


def with_markers(*places: tuple[int, int, int], stretch: float = 1.0) -> Picture:
    """Markers at (x, y, side) on grey, each on its white paper, and one red object."""
    rgb = np.full((500, 700, 3), 170, np.uint8)
    dictionary = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_4X4_50)
    for number, (x, y, side) in enumerate(places):
        cells = cv2.aruco.generateImageMarker(dictionary, number, side)
        cells = cv2.resize(cells, (round(side * stretch), side))
        margin = side // 4
        rgb[y - margin : y + side + margin, x - margin : x + cells.shape[1] + margin] = 255
        rgb[y : y + side, x : x + cells.shape[1]] = cells[..., None]
    cv2.ellipse(rgb, (480, 250), (90, 160), 0, 0, 360, (190, 40, 30), -1, cv2.LINE_AA)
    return picture_of(cv2.GaussianBlur(rgb, (0, 0), 0.7))


@pytest.mark.parametrize(
    ("request_", "value", "source"),
    [
        (ScaleRequest(50, 50, 9, 9), 0.5, "height"),
        (ScaleRequest(None, 50, 9, 9), 1.0, "width"),
        (ScaleRequest(None, None, 9, 9), 9.0, "mm-per-px"),
        (ScaleRequest(), 0.25, "resolution"),
    ],
)
def test_first_given_wins(request_: ScaleRequest, value: float, source: str) -> None:
    scale = scale_of(picture_of(PLAIN.rgb, 0.25), SILHOUETTE, request_)
    assert (scale.mm_per_px, scale.source) == (value, source)


def test_nothing_given_names_the_options() -> None:
    with pytest.raises(NoScale, match="`height_mm`, `width_mm`, `mm_per_px` or `marker_mm`"):
        scale_of(PLAIN, SILHOUETTE, ScaleRequest())


@pytest.mark.parametrize("value", [0.0, -1.0, float("nan"), float("inf")])
@pytest.mark.parametrize(
    "field",
    [
        "height_mm",
        "width_mm",
        "mm_per_px",
        "marker_mm",
    ],
)
def test_nonsense_is_bad_usage(field: str, value: float) -> None:
    with pytest.raises(UsageError, match=f"`{field}` must be"):
        scale_of(PLAIN, SILHOUETTE, ScaleRequest(**{field: value}))


def test_marker_gives_the_scale() -> None:
    scale = scale_of(with_markers((80, 100, 120)), SILHOUETTE, ScaleRequest(marker_mm=30))
    assert scale.source == "marker"
    assert scale.mm_per_px == pytest.approx(30 / 120, rel=0.005)


def test_markers_that_agree_are_averaged() -> None:
    picture = with_markers((80, 60, 120), (80, 300, 121))
    scale = scale_of(picture, SILHOUETTE, ScaleRequest(marker_mm=30))
    assert scale.mm_per_px == pytest.approx(30 / 120.5, rel=0.005)


@pytest.mark.parametrize(
    ("picture", "reason"),
    [
        (PLAIN, "no ArUco"),
        (with_markers((80, 60, 120), (80, 300, 100)), "differ in size"),
        (with_markers((80, 100, 120), stretch=1.3), "slant"),
    ],
)
def test_marker_that_cannot_be_trusted(picture: Picture, reason: str) -> None:
    with pytest.raises(NoScale, match=reason):
        scale_of(picture, SILHOUETTE, ScaleRequest(marker_mm=30))


def test_silhouette_passes_over_markers() -> None:
    picture = with_markers((80, 60, 120), (80, 300, 120))
    markers = find_markers(picture)
    assert len(markers) == 2
    found = find_silhouette(picture, ignore=markers)
    np.testing.assert_allclose(found.contour_px.mean(axis=0), [480, 250], atol=2)
    np.testing.assert_allclose(np.ptp(found.contour_px, axis=0), [181, 321], atol=0.7)
