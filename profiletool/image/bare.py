"""The sheet's own squares in a frontal picture: which are bare, and a ground without them."""

from __future__ import annotations

import math

import cv2
import numpy as np
from numpy.typing import NDArray

from profiletool.image.board import Board, ink_picture
from profiletool.records import FloatArray

RIM_MM = 2.0  # shown round the frame; the bars and the lettering begin beyond it
_PX_PER_MM = 2.0  # squares are told from what hides them at this resolution
_ABOUT_MM = 1.5  # looked at round a square: a black one shows against its neighbours
_LIKENESS = 0.75  # correlation with what was printed
_WHITE = 0.02  # ink near a pixel of paper
_BLUR_MM = 0.5
_PAPER_MM = 6.0  # paper is taken from so far about
_SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])


def without_squares(
    board: Board, rgb: NDArray[np.uint8], turn: int
) -> tuple[list[FloatArray], NDArray[np.uint8]]:
    """Find the squares that look as printed, and paint them over.

    Parameters
    ----------
    board : Board
    rgb : (H, W, 3)
        The frame and ``RIM_MM`` round it, seen squarely.
    turn : int
        Quarter turns, counter-clockwise, that bring it as the sheet was printed.

    Returns
    -------
    squares : list of (4, 2) mm
        Corners of the bare squares, board frame.
    plain : (H, W, 3)
        The picture with those squares as white paper: the mean of the white about, so that light
        and shade go on.
    """
    small = _reduced(board, rgb, turn)
    ink = ink_picture(board, _PX_PER_MM, RIM_MM)
    grey = cv2.cvtColor(small, cv2.COLOR_RGB2GRAY).astype(np.float64)
    bare = [
        np.array(place) * board.square_mm
        for place in board.squares()
        if _looks_printed(board, place, grey, ink)
    ]
    covered = np.zeros(grey.shape, np.uint8)
    for low in bare:
        covered[_window(low, board.square_mm, RIM_MM)] = 1
    paper = _paper(small, ink, covered > 0)
    height, width = rgb.shape[:2]
    upright = [np.rot90(layer, -turn) for layer in (paper, covered)]
    large = [
        cv2.resize(np.ascontiguousarray(layer), (width, height), interpolation=kind)
        for layer, kind in zip(upright, (cv2.INTER_LINEAR, cv2.INTER_NEAREST), strict=True)
    ]
    plain = np.where(large[1][..., None] > 0, large[0], rgb)
    return [low + board.square_mm * _SQUARE for low in bare], np.asarray(plain, np.uint8)


def _reduced(board: Board, rgb: NDArray[np.uint8], turn: int) -> NDArray[np.uint8]:
    """Reduce a frontal picture to what `ink_picture` shows, upright as the sheet was printed."""
    turned = np.ascontiguousarray(np.rot90(rgb, turn))
    width, height = (round((side + 2.0 * RIM_MM) * _PX_PER_MM) for side in board.size_mm)
    return np.asarray(cv2.resize(turned, (width, height), interpolation=cv2.INTER_AREA), np.uint8)


def _window(low: FloatArray, side: float, margin: float) -> tuple[slice, slice]:
    """Rows and columns of the reduced picture that a square and a margin round it take."""
    first = np.maximum(0, np.round((low - margin + RIM_MM) * _PX_PER_MM)).astype(int)
    last = np.round((low + side + margin + RIM_MM) * _PX_PER_MM).astype(int)
    return slice(first[1], last[1]), slice(first[0], last[0])


def _looks_printed(
    board: Board, place: tuple[int, int], grey: FloatArray, ink: NDArray[np.float32]
) -> bool:
    window = _window(np.array(place) * board.square_mm, board.square_mm, _ABOUT_MM)
    one, other = -grey[window], ink[window].astype(np.float64)
    one, other = one - one.mean(), other - other.mean()
    scale = math.sqrt(float((one**2).sum() * (other**2).sum()))
    return bool(scale > 0.0 and float((one * other).sum()) > _LIKENESS * scale)


def _paper(
    small: NDArray[np.uint8], ink: NDArray[np.float32], covered: NDArray[np.bool_]
) -> NDArray[np.uint8]:
    """Spread the colour of the bare squares' white over what is about."""
    blurred = cv2.GaussianBlur(ink, (0, 0), _BLUR_MM * _PX_PER_MM)
    white = ((blurred < _WHITE) & covered).astype(np.float32)
    sigma = _PAPER_MM * _PX_PER_MM
    total = cv2.GaussianBlur(small.astype(np.float32) * white[..., None], (0, 0), sigma)
    weight = cv2.GaussianBlur(white, (0, 0), sigma)
    mean = total / np.maximum(weight, 1e-6)[..., None]
    return np.asarray(np.clip(np.round(mean), 0, 255), np.uint8)
