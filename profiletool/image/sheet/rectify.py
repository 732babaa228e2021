"""A picture of an object on the printed sheet, seen squarely and with a scale to trust."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from profiletool.image.sheet.bare import RIM_MM, places_mm, without_squares
from profiletool.image.sheet.board import Board, corners_of, find_board
from profiletool.image.sheet.lens import View, fit_view
from profiletool.image.sheet.parallax import PRINT_SHARE, Camera
from profiletool.records.picture import Picture, Silhouette
from profiletool.records.units import FloatArray

MAX_PIXELS = 24_000_000
_STRIP = 256  # rows warped at a time: the maps of a whole picture take 200 MB
_NEAR_MM, _TILT_DEG, _COARSE_PX_PER_MM, _FEW_SHARE = 350.0, 20.0, 2.0, 0.5
_SURE_SHARE = 0.15


@dataclass(frozen=True)
class SheetFrame:
    """A frontal picture's place on the board: its middle, and where right and down point."""

    middle: FloatArray
    right: FloatArray
    down: FloatArray
    mm_per_px: float
    width: int
    height: int

    def board_mm(self, px: FloatArray) -> FloatArray:
        """Points (..., 2) px of the picture on the board, mm."""
        off = (px - self._middle_px) * self.mm_per_px
        return np.asarray(self.middle + off[..., :1] * self.right + off[..., 1:] * self.down)

    def px(self, mm: FloatArray) -> FloatArray:
        """Points (..., 2) mm of the board in the picture, px."""
        off = (mm - self.middle) / self.mm_per_px
        return np.stack([off @ self.right, off @ self.down], axis=-1) + self._middle_px

    @property
    def turn(self) -> int:
        """Quarter turns, counter-clockwise, that bring the picture as the sheet was printed."""
        turns = {(0, 1): 0, (1, 0): 1, (0, -1): 2, (-1, 0): 3}
        return turns[(int(self.down[0]), int(self.down[1]))]

    @property
    def _middle_px(self) -> FloatArray:
        return (np.array([self.width, self.height], float) - 1.0) / 2.0


@dataclass(frozen=True)
class Rectified:
    """A frontal view of the sheet.

    Attributes
    ----------
    picture : Picture
        The frame and 2 mm round it, with ``mm_per_px`` in the sheet's plane; what the photograph
        does not show goes on as its edge. Up is nearly where it was in the photograph.
    board : str
        Which sheet it is.
    plain : Picture
        The same with the frame painted over as paper where nothing hides it: the ground to find
        the object on.
    squares : tuple of (4, 2)
        The frame's squares that are not hidden, in the new picture's frame: no part of the object.
    hidden : int
        How many of its squares are hidden, or not in the photograph.
    reprojection_px : float
        Root mean square distance of the corners to where they should be in the photograph.
    camera : Camera
        Where the camera stood, in the new picture's frame.
    distance_mm : float
        From the camera to the sheet's middle.
    tilt_deg : float
        Between the camera's axis and the sheet's normal.
    lens_terms : int
        Terms of radial distortion that the corners support: 0, 1 or 2.
    corners_seen, corners_total : int
    error_share : float
        Standard deviation of the scale in the sheet's plane, relative: the print's, the
        corners' and the lens's together.
    warnings : tuple of str
    frame : SheetFrame
        Where the frontal picture lies on the board.
    view : View
        The photograph's.
    """

    picture: Picture
    board: str
    plain: Picture
    squares: tuple[FloatArray, ...]
    hidden: int
    reprojection_px: float
    camera: Camera
    distance_mm: float
    tilt_deg: float
    lens_terms: int
    corners_seen: int
    corners_total: int
    error_share: float
    warnings: tuple[str, ...]
    frame: SheetFrame
    view: View

    def photo_of(self, px: FloatArray) -> FloatArray:
        """Bring points (..., 2) px of the frontal picture to the photograph."""
        return self.view.picture_of(self.frame.board_mm(px))

    def frontal_of(self, px: FloatArray) -> FloatArray:
        """Bring points (..., 2) px of the photograph to the frontal picture."""
        return self.frame.px(self.view.sheet_of(px))

    def mask_of(self, mask: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Bring a mask of the photograph to the frontal picture."""
        return _warped(mask.view(np.uint8) * 255, self.view, self.frame) > 127

    def photo_mask_of(self, mask: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Bring a mask of the frontal picture to the photograph."""
        outlines, _ = cv2.findContours(
            mask.view(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE
        )
        made = np.zeros((2.0 * self.view.middle[::-1] + 1.0).round().astype(int), np.uint8)
        there = [self.photo_of(line[:, 0].astype(float)) for line in outlines]
        cv2.fillPoly(made, [np.round(line).astype(np.int32) for line in there], 1)
        return made.view(bool)


def rectify(picture: Picture) -> Rectified | None:
    """Find the printed sheet in a picture and show it from straight above.

    Parameters
    ----------
    picture : Picture
        ``focal_px``, where the file has it, makes the camera's distance surer.

    Returns
    -------
    Rectified or None
        None where no sheet is found, or too little of it to tell its plane.
    """
    seen = find_board(picture)
    if seen is None:
        return None
    height, width = picture.rgb.shape[:2]
    view = fit_view(seen.px, seen.mm, (width, height), picture.focal_px)
    if not view.camera_mm[2] > 0.0:
        return None
    frame = _frame_for(seen.board, view)
    rgb = _warped(picture.rgb, view, frame)
    alpha = None if picture.alpha is None else _warped(picture.alpha, view, frame)
    spots = view.picture_of(places_mm(seen.board))
    inside = (spots >= -0.5) & (spots <= np.array([width, height]) - 0.5)
    shown = np.asarray(inside.all(axis=-1))
    squares, plain = without_squares(seen.board, rgb, frame.turn, shown)
    x, y, up = view.camera_mm
    foot = frame.px(np.array([x, y]))
    middle = np.array(seen.board.size_mm) / 2.0
    distance = math.hypot(*(middle - (x, y)), up)
    fit_share = view.size_share(_field_points(seen.board))
    made = Rectified(
        picture=Picture(rgb, alpha, frame.mm_per_px, picture.format),
        board=seen.board.name,
        plain=Picture(plain, alpha, frame.mm_per_px, picture.format),
        squares=tuple(frame.px(square) for square in squares),
        hidden=len(seen.board.squares()) - len(squares),
        reprojection_px=view.rms_px,
        camera=Camera((float(foot[0]), float(foot[1])), float(up), view.height_share),
        distance_mm=distance,
        tilt_deg=view.tilt_deg,
        lens_terms=view.terms,
        corners_seen=int(view.kept.sum()),
        corners_total=corners_of(seen.board),
        error_share=math.hypot(PRINT_SHARE, fit_share),
        warnings=(),
        frame=frame,
        view=view,
    )
    return replace(made, warnings=_warnings(made, seen.board, view, (width, height), seen.others))


def _field_points(board: Board) -> FloatArray:
    """Points all over the white field, (25, 2) mm."""
    shares = np.linspace(-0.5, 0.5, 5)
    grid = np.stack(np.meshgrid(shares, shares), axis=-1).reshape(-1, 2)
    return np.asarray(np.array(board.size_mm) / 2.0 + grid * board.field_mm)


def _corner_points(board: Board) -> FloatArray:
    return np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]) * board.size_mm


def _frame_for(board: Board, view: View) -> SheetFrame:
    """Choose the frontal picture: as fine as the photograph's finest place, up where it was."""
    middle = np.array(board.size_mm) / 2.0
    axes = np.array([[1.0, 0.0], [0.0, 1.0]])
    turned = view.picture_of(middle + axes) - view.picture_of(middle - axes)
    # Of the board's four directions, down is the one that points most downwards in the picture.
    k = int(np.argmax(np.abs(turned[:, 1])))
    down = axes[k] * np.sign(turned[k, 1])
    right = np.array([down[1], -down[0]])
    sides = np.array(board.size_mm) + 2.0 * RIM_MM
    across, along = (float(np.abs(axis) @ sides) for axis in (right, down))
    corners = np.concatenate([_corner_points(board), _field_points(board)])
    moved = [view.picture_of(corners + a) - view.picture_of(corners - a) for a in 0.5 * axes]
    px_per_mm = float(np.linalg.svd(np.stack(moved, axis=-1), compute_uv=False).max())
    px_per_mm = min(px_per_mm, math.sqrt(MAX_PIXELS / (across * along)))
    size = math.ceil(across * px_per_mm), math.ceil(along * px_per_mm)
    return SheetFrame(middle, right, down, 1.0 / px_per_mm, *size)


def _warped(image: NDArray[np.uint8], view: View, frame: SheetFrame) -> NDArray[np.uint8]:
    made = np.empty((frame.height, frame.width, *image.shape[2:]), np.uint8)
    columns = np.arange(frame.width, dtype=float)
    no_second_map = np.empty(0, np.float32)
    for top in range(0, frame.height, _STRIP):
        rows = np.arange(top, min(top + _STRIP, frame.height), dtype=float)
        places = np.stack(np.meshgrid(columns, rows), axis=-1)
        source = view.picture_of(frame.board_mm(places)).astype(np.float32)
        made[top : top + len(rows)] = cv2.remap(
            image, source, no_second_map, cv2.INTER_CUBIC, borderMode=cv2.BORDER_REPLICATE
        )
    return made


def _warnings(
    made: Rectified, board: Board, view: View, size: tuple[int, int], others: bool
) -> tuple[str, ...]:
    corners = view.picture_of(_corner_points(board))
    outside = ((corners < -0.5) | (corners > np.array(size) - 0.5)).any()
    said = {
        "the sheet runs out of the picture; show all of its frame": outside,
        f"only {made.corners_seen} of the sheet's {made.corners_total} corners are seen; "
        "hide less of its frame": made.corners_seen < _FEW_SHARE * made.corners_total,
        f"the sheet is seen at a slant of {made.tilt_deg:.0f} degrees; photograph it from "
        "straight above": made.tilt_deg > _TILT_DEG,
        f"the camera was only about {made.distance_mm:.0f} mm away; from farther off a thick "
        "object is measured more surely": made.distance_mm < _NEAR_MM,
        "the sheet is small in the picture; go nearer or zoom in": (
            made.picture.mm_per_px is not None and made.picture.mm_per_px * _COARSE_PX_PER_MM > 1.0
        ),
        "the camera's distance is little sure (no focal length in the file); give "
        "`camera_distance_mm`": made.camera.height_share > _SURE_SHARE,
        "markers of a second sheet are seen; only one was used": others,
    }
    return tuple(text for text, holds in said.items() if holds)


def edge_warnings(made: Rectified, silhouette: Silhouette) -> tuple[str, ...]:
    """Say where the object meets what it should keep clear of.

    Parameters
    ----------
    made : Rectified
    silhouette : Silhouette
        Found in ``made.plain``.
    """
    said = {
        "the object reaches the edge of the sheet's frame; what lies beyond is not seen": bool(
            silhouette.touches
        ),
        f"the object hides {made.hidden} squares of the sheet's frame; its outline is uncertain "
        "there": made.hidden > 0,
    }
    return tuple(text for text, holds in said.items() if holds)
