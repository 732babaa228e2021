"""The printed sheet: its layout, its file, and how it is found."""

from __future__ import annotations

import base64
import math
import re
import zlib
from pathlib import Path

import cv2
import numpy as np
import pytest

from profiletool.image.load import load_picture
from profiletool.image.marker import find_markers
from profiletool.image.sheet.board import (
    BOARDS,
    Board,
    Paper,
    board_for,
    corners_of,
    find_board,
    ink,
    ink_picture,
    marker_bits,
    marker_id,
)
from profiletool.image.sheet.rectify import rectify
from profiletool.records.picture import Picture
from profiletool.template.calibration import calibration_sheet
from tests.programs import run

PAPERS: tuple[Paper, ...] = ("a4", "letter")
SIZES = {"a4": (210.0, 297.0), "letter": (215.9, 279.4)}
FRAMES = {"a4": (192.0, 272.0), "letter": (192.0, 256.0)}
FIELDS = {"a4": (128.0, 208.0), "letter": (128.0, 192.0)}


def drawn(board: Board, px_per_mm: float = 5, rim_mm: float = 12) -> Picture:
    grey = 255 - np.round(235 * ink_picture(board, px_per_mm, rim_mm)).astype(np.uint8)
    return Picture(np.repeat(grey[..., None], 3, axis=2), None, None, "PNG")


# --- layout --------------------------------------------------------------------------------


@pytest.mark.parametrize("paper", PAPERS)
def test_sheet_measures_what_it_should(paper: Paper) -> None:
    board = board_for(paper)
    assert board.paper_mm == SIZES[paper]
    assert board.size_mm == FRAMES[paper]
    assert board.field_mm == FIELDS[paper]
    assert min(board.origin_mm) > 8.0  # room for the bars, and for what printers do not reach
    boxes = ink(board)
    np.testing.assert_allclose(boxes[:, :2].min(axis=0), 0.0)
    np.testing.assert_allclose(boxes[:, 2:].max(axis=0), FRAMES[paper])


@pytest.mark.parametrize("board", BOARDS)
def test_field_is_white_and_half_of_the_frame_is_black(board: Board) -> None:
    x0, y0, x1, y1 = ink(board).T
    low = np.full(2, 32.0)
    high = np.array(board.size_mm) - 32.0
    inside = (x1 > low[0] + 1e-9) & (x0 < high[0] - 1e-9)
    inside &= (y1 > low[1] + 1e-9) & (y0 < high[1] - 1e-9)
    assert not inside.any()
    squares = sum(marker_id(board, *place) is None for place in board.squares())
    assert squares == len(board.squares()) / 2
    assert np.isclose((x1 - x0) * (y1 - y0), 256.0).sum() == squares


def test_no_marker_is_used_twice() -> None:
    numbers = [
        number
        for board in BOARDS
        for place in board.squares()
        if (number := marker_id(board, *place)) is not None
    ]
    assert len(set(numbers)) == len(numbers)


# --- finding -------------------------------------------------------------------------------


@pytest.mark.parametrize("board", BOARDS)
@pytest.mark.parametrize("turns", range(4))
def test_every_corner_is_found_in_its_place(board: Board, turns: int) -> None:
    rgb = np.ascontiguousarray(np.rot90(drawn(board).rgb, turns))
    seen = find_board(Picture(rgb, None, None, "PNG"))
    assert seen is not None
    assert seen.board == board
    assert len(seen.px) == corners_of(board)
    assert not seen.others
    x, y = seen.px.T
    height, width = rgb.shape[:2]
    for _ in range(turns):  # back to the upright picture
        x, y, height, width = height - 1 - y, x, width, height
    places = np.stack([x, y], axis=1)
    np.testing.assert_allclose((places + 0.5) / 5 - 12, seen.mm, atol=0.02)


def test_no_sheet_is_none() -> None:
    plain = Picture(np.full((300, 400, 3), 200, np.uint8), None, None, "PNG")
    assert find_board(plain) is None
    assert rectify(plain) is None


def test_single_markers_are_no_sheet_and_the_sheet_no_marker() -> None:
    for board in BOARDS:
        assert find_markers(drawn(board)) == []
    dictionary = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_4X4_50)
    rgb = np.full((900, 1500), 255, np.uint8)
    for number in range(50):
        row, column = divmod(number, 10)
        cells = cv2.aruco.generateImageMarker(dictionary, number, 96)
        rgb[40 + 170 * row : 136 + 170 * row, 40 + 140 * column : 136 + 140 * column] = cells
    picture = Picture(np.repeat(rgb[..., None], 3, axis=2), None, None, "PNG")
    assert len(find_markers(picture)) == 50
    assert find_board(picture) is None


def test_no_sampling_of_the_sheets_markers_gives_a_single_one() -> None:
    singles = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_4X4_50)
    for board in BOARDS:
        for place in board.squares():
            number = marker_id(board, *place)
            if number is not None:
                cells = (~marker_bits(number)).astype(np.uint8) * 255
                seen = cv2.resize(cells, (336, 336), interpolation=cv2.INTER_NEAREST)
                bits = seen[28::56, 28::56][1:5, 1:5] > 127
                assert not singles.identify(bits.astype(np.uint8), 0.0)[0]


def test_marker_beside_the_sheet_is_read_too() -> None:
    board = board_for("a4")
    picture = drawn(board)
    single = cv2.aruco.generateImageMarker(
        cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_4X4_50), 7, 120
    )
    rgb = picture.rgb.copy()
    rgb[700:820, 480:600] = single[..., None]
    both = Picture(rgb, None, None, "PNG")
    assert len(find_markers(both)) == 1
    seen = find_board(both)
    assert seen is not None
    assert len(seen.px) == corners_of(board)
    assert not seen.others


@pytest.mark.parametrize("second", PAPERS)
def test_of_two_sheets_one_is_taken(second: Paper) -> None:
    large, small = drawn(board_for("a4"), 5), drawn(board_for(second), 3)
    height, width = large.rgb.shape[:2]
    rgb = np.full((height, width + small.rgb.shape[1], 3), 250, np.uint8)
    rgb[:, :width] = large.rgb
    rgb[: small.rgb.shape[0], width:] = small.rgb
    picture = Picture(rgb, None, None, "PNG")
    seen = find_board(picture)
    assert seen is not None
    assert seen.others
    made = rectify(picture)
    assert made is not None
    assert made.reprojection_px < 0.1
    assert any("second sheet" in text for text in made.warnings)


# --- the file ------------------------------------------------------------------------------


@pytest.mark.parametrize("paper", PAPERS)
def test_file_is_at_true_scale_and_always_the_same(
    paper: Paper, monkeypatch: pytest.MonkeyPatch
) -> None:
    data = calibration_sheet(paper)
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "12345")
    assert calibration_sheet(paper) == data
    assert b"/PrintScaling /None" in data
    (box,) = re.findall(rb"/MediaBox \[\s*0 0 ([\d.]+) ([\d.]+)\s*\]", data)
    np.testing.assert_allclose([float(side) * 25.4 / 72 for side in box], SIZES[paper], atol=0.01)
    assert data.count(b"/Type /Page\n") + data.count(b"/Type /Page ") == 1


def content(data: bytes) -> str:
    (stream,) = re.findall(rb"stream\r?\n(.*?)endstream", data, re.DOTALL)
    return zlib.decompress(base64.a85decode(stream.strip().removesuffix(b"~>"))).decode()


@pytest.mark.parametrize("paper", PAPERS)
def test_bars_measure_100_mm(paper: Paper) -> None:
    text = content(calibration_sheet(paper))
    lines = re.findall(r"([\d.]+) ([\d.]+) m ([\d.]+) ([\d.]+) l", text)
    lengths = [math.dist((float(a), float(b)), (float(c), float(d))) for a, b, c, d in lines]
    assert sum(math.isclose(length, 100.0, abs_tol=1e-3) for length in lengths) == 2


@pytest.mark.slow
@pytest.mark.parametrize("paper", PAPERS)
def test_printed_sheet_gives_its_own_scale(paper: Paper, tmp_path: Path) -> None:
    (tmp_path / "sheet.pdf").write_bytes(calibration_sheet(paper))
    run("pdftoppm", "-r", 150, "-png", "sheet.pdf", "page", cwd=tmp_path)
    (page,) = tmp_path.glob("page*.png")
    picture = load_picture(page)
    seen = find_board(picture)
    assert seen is not None
    assert len(seen.px) == corners_of(board_for(paper))
    away = np.array([np.hypot(*(seen.px[0] - seen.px[-1])), np.hypot(*(seen.mm[0] - seen.mm[-1]))])
    assert away[1] / away[0] == pytest.approx(25.4 / 150, rel=1e-3)
    made = rectify(picture)
    assert made is not None
    assert made.corners_seen == made.corners_total
    # A line between the field's inner corners, in the page and in the frontal picture.
    assert made.picture.mm_per_px == pytest.approx(25.4 / 150, rel=1e-3)
    assert made.hidden == 0
    assert made.tilt_deg < 1.0
