"""The sheet's own squares in a frontal picture: which are bare, and a ground without them."""

from __future__ import annotations

import math

import cv2
import numpy as np
from numpy.typing import NDArray

from profiletool.image.sheet.board import Board, ink_picture
from profiletool.records.units import FloatArray

RIM_MM = 2.0  # shown round the frame; the bars and the lettering begin beyond it
_PX_PER_MM = 4.0  # squares are told from what hides them at this resolution
_ABOUT_MM = 1.5  # looked at round a square: a black one shows against its neighbours
_LIKENESS = 0.75  # correlation with what was printed
_STRANGE_SHARE = 0.01  # of a bare square that may look different nevertheless
_WHITE = 0.02  # ink near a pixel of paper
_BLUR_MM = 0.4
# Paper is taken from near by, and from farther off where there is none.
_PAPER_MM, _FAR_MM, _FAR_WEIGHT = 6.0, 60.0, 1e-3
_SHADE = 0.7
_TOLERANCE = 40.0  # of 255, by which what is printed may look different from what it should
_LINE_PX, _SPECK_PX, _MARGIN_PX = 7, 5, 7  # closed, dropped, and kept clear of when asked of paper
_SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])

_Image = NDArray[np.float32]
_Mask = NDArray[np.bool_]


def without_squares(
    board: Board, rgb: NDArray[np.uint8], turn: int, shown: _Mask
) -> tuple[list[FloatArray], NDArray[np.uint8]]:
    """Find the squares that look as printed, and paint the frame over.

    Parameters
    ----------
    board : Board
    rgb : (H, W, 3)
        The frame and ``RIM_MM`` round it, seen squarely.
    turn : int
        Quarter turns, counter-clockwise, that bring it as the sheet was printed.
    shown : bool, as `places_mm`
        Where there is something in the photograph.

    Returns
    -------
    squares : list of (4, 2) mm
        Corners of the bare squares, board frame.
    plain : (H, W, 3)
        The picture with all of the frame that has the colour that was printed there, and all that
        the photograph does not show, as white paper: the mean of the white about, so that light
        and shade go on.
    """
    small = _reduced(board, rgb, turn)
    ink = cv2.GaussianBlur(
        ink_picture(board, _PX_PER_MM, RIM_MM), (0, 0), _BLUR_MM * _PX_PER_MM
    ).astype(np.float32)
    frame = _painted(board, board.squares(), RIM_MM)
    like = [place for place in board.squares() if _looks_printed(board, place, small, ink)]
    known = _painted(board, like, 0.0) & shown
    strange = _strange(small, ink, known)
    # What hides a square in part has told its own colour for paper's: once more without it.
    clear = cv2.dilate(strange.view(np.uint8), np.ones((_MARGIN_PX, _MARGIN_PX), np.uint8)) == 0
    strange = _strange(small, ink, known & clear) & frame
    bare = [
        np.array(place) * board.square_mm
        for place in like
        if strange[_window(board, place, 0.0)].mean() < _STRANGE_SHARE
    ]
    covered = ~shown | (frame & ~strange)
    plain = _laid_over(rgb, _paper(small, ink, known & clear), covered, turn)
    return [low + board.square_mm * _SQUARE for low in bare], plain


def places_mm(board: Board) -> FloatArray:
    """Give the places of the pixels that are looked at, (H, W, 2) mm, board frame."""
    width, height = _size(board)
    x, y = (np.arange(count) + 0.5 for count in (width, height))
    return np.stack(np.meshgrid(x, y), axis=-1) / _PX_PER_MM - RIM_MM


def _size(board: Board) -> tuple[int, int]:
    width, height = (round((side + 2.0 * RIM_MM) * _PX_PER_MM) for side in board.size_mm)
    return width, height


def _reduced(board: Board, rgb: NDArray[np.uint8], turn: int) -> _Image:
    """Bring a frontal picture to the size of `ink_picture`, upright as the sheet was printed."""
    turned = np.ascontiguousarray(np.rot90(rgb, turn))
    return cv2.resize(turned, _size(board), interpolation=cv2.INTER_AREA).astype(np.float32)


def _window(board: Board, place: tuple[int, int], margin: float) -> tuple[slice, slice]:
    """Rows and columns of the reduced picture that a square and a margin round it take."""
    low = np.array(place) * board.square_mm + RIM_MM
    first = np.maximum(0, np.round((low - margin) * _PX_PER_MM)).astype(int)
    last = np.round((low + board.square_mm + margin) * _PX_PER_MM).astype(int)
    return slice(first[1], last[1]), slice(first[0], last[0])


def _painted(board: Board, places: list[tuple[int, int]], margin: float) -> _Mask:
    width, height = _size(board)
    mask = np.zeros((height, width), bool)
    for place in places:
        mask[_window(board, place, margin)] = True
    return mask


def _looks_printed(board: Board, place: tuple[int, int], small: _Image, ink: _Image) -> bool:
    window = _window(board, place, _ABOUT_MM)
    one, other = -small[window].mean(axis=2), ink[window]
    one, other = one - one.mean(), other - other.mean()
    scale = math.sqrt(float((one**2).sum() * (other**2).sum()))
    return bool(scale > 0.0 and float((one * other).sum()) > _LIKENESS * scale)


def _paper(small: _Image, ink: _Image, known: _Mask) -> _Image:
    """Spread the colour of the white in known squares over all the rest."""
    white = (ink < _WHITE) & known
    far = _spread(_weighted(small, white), _FAR_MM)
    usual = far[..., :3].sum(axis=2) / np.maximum(far[..., 3], 1e-12)
    # Paper in a shadow is still lighter than most of what may hide it.
    near = _spread(_weighted(small, white & (small.sum(axis=2) > _SHADE * usual)), _PAPER_MM)
    total = near + np.float32(_FAR_WEIGHT) * far
    return np.asarray(total[..., :3] / np.maximum(total[..., 3:], 1e-12), np.float32)


def _weighted(small: _Image, mask: _Mask) -> _Image:
    weight = mask.astype(np.float32)[..., None]
    return np.concatenate([small * weight, weight], axis=2)


def _spread(layers: _Image, size_mm: float) -> _Image:
    """Blur, at a tenth of the resolution: nothing finer is left."""
    height, width = layers.shape[:2]
    small = cv2.resize(layers, (width // 10, height // 10), interpolation=cv2.INTER_AREA)
    blurred = cv2.GaussianBlur(small, (0, 0), size_mm * _PX_PER_MM / 10.0)
    return np.asarray(cv2.resize(blurred, (width, height)), np.float32)


def _strange(small: _Image, ink: _Image, known: _Mask) -> _Mask:
    """Tell what has not the colour that it should have as part of the sheet."""
    black = small[known & (ink > 1.0 - _WHITE)]
    if len(black) == 0:
        return np.ones(ink.shape, bool)
    dark = np.median(black, axis=0).astype(np.float32)
    light = _paper(small, ink, known) - dark
    # Every colour between ink's and paper's is one share of ink, and that is nearly known.
    share = 1.0 - ((small - dark) * light).sum(axis=2) / (light**2).sum(axis=2)
    aside = np.linalg.norm(small - dark - (1.0 - share)[..., None] * light, axis=2)
    about = np.ones((3, 3), np.uint8)  # the print's edges may lie a little off
    slack = _TOLERANCE / np.linalg.norm(light, axis=2)
    beside = (share < cv2.erode(ink, about) - slack) | (share > cv2.dilate(ink, about) + slack)
    off = np.asarray((aside > _TOLERANCE) | beside, np.uint8)
    for kind, width in (
        (cv2.MORPH_OPEN, 3),
        (cv2.MORPH_CLOSE, _LINE_PX),
        (cv2.MORPH_OPEN, _SPECK_PX),
    ):
        disc = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (width, width))
        off = np.asarray(cv2.morphologyEx(off, kind, disc), np.uint8)
    return np.asarray(off > 0)


def _laid_over(
    rgb: NDArray[np.uint8], paper: _Image, covered: _Mask, turn: int
) -> NDArray[np.uint8]:
    """Lay paper over what is covered of the frontal picture."""
    height, width = rgb.shape[:2]
    light, mask = (
        cv2.resize(np.ascontiguousarray(np.rot90(layer, -turn)), (width, height))
        for layer in (paper, covered.astype(np.float32))
    )
    laid = np.where(mask[..., None] > 0.5, np.round(light), rgb)
    return np.asarray(np.clip(laid, 0, 255), np.uint8)
