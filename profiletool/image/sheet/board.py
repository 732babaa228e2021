"""The printed sheet that an object is photographed on: a frame of squares with markers in them.

The middle of the sheet is left white, so that the object has a plain ground to be told from;
the frame round it stays in sight, and its corners are found to a fraction of a pixel. Board
frame: mm, origin at the frame's upper left corner as printed, x to the right, y down.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Literal

import cv2
import numpy as np
from numpy.typing import NDArray

from profiletool.records.picture import Picture
from profiletool.records.units import FloatArray

# Single markers are 4 x 4 (`marker_mm`). These have 5 x 5 bits, a grid of another size, and
# differ among themselves in six bits at least: neither is ever read as the other.
_DICTIONARY = cv2.aruco.DICT_5X5_250
_LEAST_SPREAD = 2.0  # root of the corners' squared distances to a line, in squares
_SECOND = 4  # markers that do not fit are no chance any more
MARKER_CELLS = 7  # across a marker: five bits and the black border


@dataclass(frozen=True)
class Board:
    """The layout of a sheet.

    Attributes
    ----------
    name : str
    paper_mm : (width, height)
    columns, rows : int
        Squares along the frame's sides, outside.
    first_id : int
        Number of the first marker: it tells the sheets apart.
    band : int
        The frame's width in squares.
    square_mm, marker_mm : float
    """

    name: str
    paper_mm: tuple[float, float]
    columns: int
    rows: int
    first_id: int
    band: int = 2
    square_mm: float = 16.0
    marker_mm: float = 12.6

    @property
    def size_mm(self) -> tuple[float, float]:
        """Width and height of the frame, outside."""
        return self.columns * self.square_mm, self.rows * self.square_mm

    @property
    def origin_mm(self) -> tuple[float, float]:
        """The frame's upper left corner on the paper, from the paper's."""
        (width, height), (across, down) = self.paper_mm, self.size_mm
        return (width - across) / 2.0, (height - down) / 2.0

    @property
    def field_mm(self) -> tuple[float, float]:
        """Width and height of the white field."""
        return (
            (self.columns - 2 * self.band) * self.square_mm,
            (self.rows - 2 * self.band) * self.square_mm,
        )

    def in_frame(self, column: int, row: int) -> bool:
        """Whether a square belongs to the frame."""
        return not (
            self.band <= column < self.columns - self.band
            and self.band <= row < self.rows - self.band
        )

    def squares(self) -> list[tuple[int, int]]:
        """Column and row of every square of the frame, row by row."""
        return [
            (column, row)
            for row in range(self.rows)
            for column in range(self.columns)
            if self.in_frame(column, row)
        ]


BOARDS = (
    Board("A4", (210.0, 297.0), columns=12, rows=17, first_id=0),
    Board("Letter", (215.9, 279.4), columns=12, rows=16, first_id=120),
)
Paper = Literal["a4", "letter"]


def board_for(paper: Paper) -> Board:
    """Give the sheet for a paper."""
    return {board.name.lower(): board for board in BOARDS}[paper]


def marker_id(board: Board, column: int, row: int) -> int | None:
    """Give the number of the marker in a square, None in a black one.

    Numbers count the white squares of the whole grid, also those that are not printed.
    """
    if (column + row) % 2 == 0:
        return None
    return board.first_id + (row * board.columns + column) // 2


def marker_bits(number: int) -> NDArray[np.bool_]:
    """Give the (7, 7) cells of a marker, the border with them; True is black."""
    dictionary = cv2.aruco.getPredefinedDictionary(_DICTIONARY)
    return np.asarray(cv2.aruco.generateImageMarker(dictionary, number, MARKER_CELLS) == 0)


@cache
def _ink(board: Board) -> FloatArray:
    boxes = []
    cell, margin = board.marker_mm / MARKER_CELLS, (board.square_mm - board.marker_mm) / 2.0
    for column, row in board.squares():
        x, y = column * board.square_mm, row * board.square_mm
        number = marker_id(board, column, row)
        if number is None:
            boxes.append((x, y, x + board.square_mm, y + board.square_mm))
            continue
        for v, u in np.argwhere(marker_bits(number)):
            left, top = x + margin + u * cell, y + margin + v * cell
            boxes.append((left, top, left + cell, top + cell))
    return np.array(boxes)


def ink(board: Board) -> FloatArray:
    """Give all that is black, as boxes: (N, 4) mm, x min, y min, x max, y max, board frame."""
    return _ink(board).copy()


def ink_picture(board: Board, px_per_mm: float, rim_mm: float) -> NDArray[np.float32]:
    """Draw the frame: the share of ink in every pixel, (H, W), with a white rim round it."""
    fine = 4
    width, height = (round((side + 2.0 * rim_mm) * px_per_mm) for side in board.size_mm)
    drawn = np.zeros((height * fine, width * fine), np.uint8)
    for x0, y0, x1, y1 in np.round((_ink(board) + rim_mm) * px_per_mm * fine).astype(int):
        drawn[y0:y1, x0:x1] = 255
    reduced = cv2.resize(drawn, (width, height), interpolation=cv2.INTER_AREA)
    return np.asarray(reduced, np.float32) / np.float32(255)


@dataclass(frozen=True)
class Sighting:
    """A sheet in a picture.

    Attributes
    ----------
    board : Board
    px : (N, 2)
        Corners where four squares meet, picture frame, sub-pixel.
    mm : (N, 2)
        The same in the board frame.
    markers : int
        How many markers were read.
    others : bool
        Whether there are markers of a second sheet.
    """

    board: Board
    px: FloatArray
    mm: FloatArray
    markers: int
    others: bool


def corners_of(board: Board) -> int:
    """Count the corners where four squares of the frame meet."""
    return len(_inner(board))


def _inner(board: Board) -> set[tuple[int, int]]:
    """Column and row of the corners that lie inside the frame's bands."""
    return {
        (column, row)
        for row in range(1, board.rows)
        for column in range(1, board.columns)
        if all(board.in_frame(column - a, row - b) for a in (0, 1) for b in (0, 1))
    }


def find_board(picture: Picture) -> Sighting | None:
    """Find the sheet in a picture; of two, the one that shows more corners.

    Returns
    -------
    Sighting or None
        None where fewer than four corners are seen, or all of them in a line.
    """
    grey = np.asarray(cv2.cvtColor(picture.rgb, cv2.COLOR_RGB2GRAY), np.uint8)
    quads, ids = _markers(grey)
    seen = [sighting for board in BOARDS if (sighting := _sighted(board, grey, quads, ids))]
    return max(seen, key=lambda sighting: len(sighting.px), default=None)


def _markers(grey: NDArray[np.uint8]) -> tuple[FloatArray, NDArray[np.intp]]:
    """Corners (N, 4, 2) and numbers (N,) of the markers in a grey picture."""
    dictionary = cv2.aruco.getPredefinedDictionary(_DICTIONARY)
    quads, ids, _ = cv2.aruco.ArucoDetector(dictionary, _settings()).detectMarkers(grey)
    if ids is None or len(quads) == 0:
        return np.zeros((0, 4, 2)), np.zeros(0, np.intp)
    corners = np.asarray(quads, np.float64).reshape(-1, 4, 2)
    return corners, np.asarray(ids, np.intp).reshape(-1)


def _settings() -> cv2.aruco.DetectorParameters:
    settings = cv2.aruco.DetectorParameters()
    settings.cornerRefinementMethod = cv2.aruco.CORNER_REFINE_SUBPIX
    return settings


def _sighted(
    board: Board, grey: NDArray[np.uint8], quads: FloatArray, ids: NDArray[np.intp]
) -> Sighting | None:
    last = board.first_id + board.columns * board.rows // 2
    own = (ids >= board.first_id) & (ids < last)
    chosen = _of_one_sheet(board, quads[own], ids[own])
    if len(chosen) < 2:
        return None
    quads, own_ids = quads[own][chosen], ids[own][chosen]
    px, at = _saddles(board, grey, quads, own_ids)
    if len(px) < 4 or np.linalg.svd(at - at.mean(axis=0), compute_uv=False)[1] < _LEAST_SPREAD:
        return None
    others = len(ids) - len(chosen) >= _SECOND
    mm = np.asarray(at * board.square_mm, np.float64)
    return Sighting(board, px, mm, len(chosen), others)


def _of_one_sheet(board: Board, quads: FloatArray, ids: NDArray[np.intp]) -> NDArray[np.intp]:
    """Choose the markers that one plane explains; a second sheet has the same numbers."""
    if len(ids) < 2:
        return np.arange(len(ids))
    places = np.concatenate([_marker_corners(board, int(number)) for number in ids])
    points = quads.reshape(-1, 2)
    side = float(np.median(np.hypot(*(quads[:, 1] - quads[:, 0]).T)))
    found, inside = cv2.findHomography(places, points, cv2.RANSAC, 0.5 * side)
    if found is None:
        return np.zeros(0, np.intp)
    return np.flatnonzero(np.asarray(inside).reshape(-1, 4).all(axis=1))


def _marker_corners(board: Board, number: int) -> FloatArray:
    """Corners of a marker, (4, 2) mm, in its own order."""
    row, rest = divmod(2 * (number - board.first_id), board.columns)
    column = rest + (row + rest + 1) % 2
    low = np.array([column, row]) * board.square_mm + (board.square_mm - board.marker_mm) / 2.0
    return low + board.marker_mm * np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])


def _saddles(
    board: Board, grey: NDArray[np.uint8], quads: FloatArray, ids: NDArray[np.intp]
) -> tuple[FloatArray, NDArray[np.intp]]:
    """Corners of the frame's squares between known markers: picture frame, and column and row."""
    count = board.columns * board.rows // 2
    dictionary = cv2.aruco.getPredefinedDictionary(_DICTIONARY)
    grid = cv2.aruco.CharucoBoard(
        (board.columns, board.rows),
        board.square_mm,
        board.marker_mm,
        dictionary,
        board.first_id + np.arange(count),
    )
    detector = cv2.aruco.CharucoDetector(grid)
    px, numbers, _, _ = detector.detectBoard(
        grey,
        markerCorners=[quad.astype(np.float32).reshape(1, 4, 2) for quad in quads],
        markerIds=ids.astype(np.int32).reshape(-1, 1),
    )
    if numbers is None:
        return np.zeros((0, 2)), np.zeros((0, 2), np.intp)
    flat = np.asarray(numbers, np.intp).reshape(-1)
    at = np.stack([flat % (board.columns - 1), flat // (board.columns - 1)], axis=1) + 1
    inner = _inner(board)
    kept = np.array([(int(column), int(row)) in inner for column, row in at], bool)
    return np.asarray(px, np.float64).reshape(-1, 2)[kept], at[kept]
