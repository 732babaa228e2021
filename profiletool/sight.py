"""The object in a picture as a design takes it: found, turned upright, measured."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Literal

import numpy as np

from profiletool.errors import NoObject, NoScale, Unsure, UsageError
from profiletool.image.hint import LEAST_PX, Box, Hint, check_hint
from profiletool.image.load import load_mask, load_picture
from profiletool.image.marker import find_markers
from profiletool.image.measure import measure
from profiletool.image.rectify import Rectified, edge_warnings, rectify
from profiletool.image.region import Point
from profiletool.image.scale import ScaleRequest, marker_scale, scale_of
from profiletool.image.silhouette import find_silhouette
from profiletool.profile.symmetry import LARGEST_MISMATCH, mirrored_mean, symmetry_of
from profiletool.profile.upright import turned, upright_of
from profiletool.records import FloatArray, Picture, Scale, Silhouette

_MEAN_STEPS = 600  # of an outline's longer side, in which its two sides are averaged
_LEANING_DEG, _LEANING_SHARE = 3.0, 0.5  # a lean that is told, and what upright then gains
_ALONG_PX, _ALONG_SHARE = 1.5, 0.05  # of a contour along a box: what a box may cut
_INEXACT = 0.02  # of a scale: an error that is told
_UNDOUBTED, _UNFIT = 0.8, 0.1  # confidences: one that needs no word, one of a wrong mask
_OUTWARD = {"left": (-1.0, 0.0), "right": (1.0, 0.0), "top": (0.0, 1.0), "bottom": (0.0, -1.0)}
_FACES = np.cos(np.radians(67.5))  # of a frame's edge once turned: what still counts as a side


@dataclass(frozen=True)
class Look:
    """How to look at a picture.

    Attributes
    ----------
    box : (x, y, w, h), or None
        Pixels of the picture, upright; everything outside is ground.
    point : (x, y), or None
        Pixels; inside the object.
    mask : Path, or None
        A picture of the object in white on black, or with transparent ground.
    rotate : float or "auto"
        Degrees counter-clockwise to turn the object by.
    symmetric : bool
        Whether to take the mean of the object's two sides.
    """

    box: Box | None = None
    point: Point | None = None
    mask: Path | None = None
    rotate: float | Literal["auto"] = 0.0
    symmetric: bool = False


@dataclass(frozen=True)
class Seen:
    """An object in a picture.

    Attributes
    ----------
    picture : Picture
        The photograph, or its frontal view where the object lies on the printed sheet.
    silhouette : Silhouette
        Its contour and ``touches`` are those of the upright object, its mask that of the
        photograph.
    scale : Scale
    rotated_deg : float
        By which the object was turned, counter-clockwise about the picture's middle.
    notes : tuple of str
        What the user should know.
    """

    picture: Picture
    silhouette: Silhouette
    scale: Scale
    rotated_deg: float = 0.0
    notes: tuple[str, ...] = field(default=())


def see(file: Path, asked: ScaleRequest, look: Look, say: Callable[[str], None]) -> Seen:
    """Read a picture and find the object in it, its way up and its size.

    Raises
    ------
    UnreadableInput, UsageError, NoScale, NoObject
    Unsure
        Its candidates are masks of the photograph, which it carries too.
    """
    picture = load_picture(file)
    hint = _hint(look, picture)
    sheet = rectify(picture)
    if sheet is not None:
        _check_said(asked)
        say(_sheet_line(sheet))
    silhouette = _found(picture, sheet, hint, asked)
    frontal = picture if sheet is None else sheet.picture
    notes = (
        [*_box_note(look.box, silhouette)]
        if sheet is None
        else [*sheet.warnings, *edge_warnings(sheet, silhouette)]
    )
    scale = None
    if sheet is not None and asked.height_mm is None and asked.width_mm is None:
        silhouette, scale = _measured(sheet, silhouette, asked)
    turn = turn_of(_y_up(silhouette.contour_px), look.rotate)
    if look.rotate == "auto" and turn:
        say(f"turned upright by {turn:.1f} deg counter-clockwise; --rotate DEG turns it otherwise")
    upright = _upright(silhouette, turn, _middle(frontal))
    if look.symmetric:
        upright = _symmetric(upright)
    if scale is None:
        scale = scale_of(frontal, upright, asked)
    if sheet is not None:
        upright = replace(upright, mask=sheet.photo_mask_of(upright.mask))
    notes += _notes(upright, scale, look)
    return Seen(frontal, upright, scale, turn, tuple(notes))


# --- on the printed sheet -------------------------------------------------------------------


def _check_said(asked: ScaleRequest) -> None:
    if asked.mm_per_px is not None:
        raise UsageError(
            "the picture shows a printed sheet, which tells its scale: leave --mm-per-px away, or "
            "crop the sheet out"
        )


def _measured(
    sheet: Rectified, silhouette: Silhouette, asked: ScaleRequest
) -> tuple[Silhouette, Scale]:
    """Measure an object whatever its way up: with its axis upright, then turned back.

    A marker in the sheet's field sets the size of its print right.
    """
    distance_mm = asked.camera_distance_mm
    middle = _middle(sheet.picture)
    turn = upright_of(_y_up(silhouette.contour_px)).turn_deg
    foot = _turned_px(np.array(sheet.camera.foot_px), turn, middle)
    camera = replace(sheet.camera, foot_px=(float(foot[0]), float(foot[1])))
    stands = replace(silhouette, contour_px=_turned_px(silhouette.contour_px, turn, middle))
    turned_sheet = replace(sheet, camera=camera)
    made = measure(turned_sheet, stands, distance_mm)
    # A slanting view spoils the symmetry of what is seen, not that of a round body's section.
    if made.round and upright_of(_y_up(made.silhouette.contour_px)).mismatch > LARGEST_MISMATCH:
        made = measure(turned_sheet, stands, distance_mm, revolved=False)
    contour = _turned_px(made.silhouette.contour_px, -turn, middle)
    scale = made.scale
    if asked.marker_mm is not None:
        flat = marker_scale(sheet.picture, asked.marker_mm)
        share = math.hypot(flat.error_share or 0.0, scale.error_share or 0.0)
        size = flat.mm_per_px / (sheet.picture.mm_per_px or 1.0)
        scale = Scale(size * scale.mm_per_px, "marker", share)
    return replace(silhouette, contour_px=contour), scale


def _sheet_line(sheet: Rectified) -> str:
    return (
        f"sheet: {sheet.board}, {sheet.corners_seen} of {sheet.corners_total} corners within "
        f"{sheet.reprojection_px:.2f} px, camera {sheet.distance_mm:.0f} mm away at a slant of "
        f"{sheet.tilt_deg:.0f} deg"
    )


# --- finding it -----------------------------------------------------------------------------


def _hint(look: Look, picture: Picture) -> Hint:
    shape = picture.rgb.shape[:2]
    mask = None if look.mask is None else load_mask(look.mask, shape)
    hint = Hint(look.box, look.point, mask)
    check_hint(hint, shape)
    return hint


def _found(
    picture: Picture, sheet: Rectified | None, hint: Hint, asked: ScaleRequest
) -> Silhouette:
    if sheet is None:
        markers = find_markers(picture) if asked.marker_mm is not None else []
        return find_silhouette(picture, markers, hint)
    markers = find_markers(sheet.plain) if asked.marker_mm is not None else []
    unsized = asked.height_mm is None and asked.width_mm is None
    if asked.marker_mm is not None and not markers and unsized:
        raise NoScale(
            "no ArUco DICT_4X4_50 marker lies in the printed sheet's field; leave --marker-mm "
            "away: the sheet tells the scale"
        )
    try:
        return find_silhouette(sheet.plain, markers, _frontal_hint(hint, sheet))
    except Unsure as unsure:
        masks = [(sheet.photo_mask_of(mask), c, how) for mask, c, how in unsure.candidates]
        raise Unsure(str(unsure), tuple(masks), picture.rgb) from None


def _frontal_hint(hint: Hint, sheet: Rectified) -> Hint:
    """Say where a hint for the photograph lies in the frontal view.

    Raises
    ------
    UsageError
        Outside the sheet.
    """
    size = np.array([sheet.frame.width, sheet.frame.height], float)
    box, point = None, None
    if hint.point is not None:
        x, y = sheet.frontal_of(np.array(hint.point, float)).tolist()
        if not (0.0 <= x < size[0] and 0.0 <= y < size[1]):
            raise UsageError("--point lies outside the printed sheet; give a point on it")
        point = x, y
    if hint.box is not None:
        left, top, w, h = hint.box
        corners = np.array(
            [[left, top], [left + w, top], [left + w, top + h], [left, top + h]], float
        )
        there = np.clip(sheet.frontal_of(corners), 0.0, size)
        low, high = there.min(axis=0), there.max(axis=0)
        if min(high - low) < LEAST_PX:
            raise UsageError("--box lies outside the printed sheet; the object must lie on it")
        box = (*low.tolist(), *(high - low).tolist())
    mask = None if hint.mask is None else sheet.mask_of(hint.mask)
    if mask is not None and not mask.any():
        raise UsageError("the mask lies outside the printed sheet; the object must lie on it")
    return Hint(box, point, mask)


# --- turning it -----------------------------------------------------------------------------


def _middle(picture: Picture) -> FloatArray:
    return 0.5 * (np.array(picture.rgb.shape[1::-1], float) - 1.0)


def _y_up(px: FloatArray) -> FloatArray:
    return px * [1.0, -1.0]


def _turned_px(px: FloatArray, rotated_deg: float, middle: FloatArray) -> FloatArray:
    """Turn points (..., 2) of a picture about its middle, counter-clockwise as seen."""
    return _y_up(turned(_y_up(px - middle), rotated_deg)) + middle


def turn_of(outline: FloatArray, rotate: float | Literal["auto"]) -> float:
    """Give the degrees, counter-clockwise, to turn an outline (N, 2), y up, by.

    Raises
    ------
    NoObject
        It has no axis to be turned upright by.
    """
    if rotate != "auto":
        return rotate
    found = upright_of(outline)
    if found.mismatch > LARGEST_MISMATCH:
        raise NoObject(
            f"no axis is found to turn the object upright by: it and its mirror image differ by "
            f"{100.0 * found.mismatch:.0f} % of its area at best; say by how much, --rotate DEG"
        )
    return found.turn_deg


def _upright(silhouette: Silhouette, rotated_deg: float, middle: FloatArray) -> Silhouette:
    if rotated_deg == 0.0:
        return silhouette
    touched = [turned(np.array(_OUTWARD[edge]), rotated_deg) for edge in sorted(silhouette.touches)]
    touches = frozenset(
        edge
        for edge, outward in _OUTWARD.items()
        if any(float(faced @ outward) > _FACES for faced in touched)
    )
    contour = _turned_px(silhouette.contour_px, rotated_deg, middle)
    return replace(silhouette, contour_px=contour, touches=touches)


def averaged(outline: FloatArray, least_step: float = 0.0) -> FloatArray:
    """Give the mean of an outline's two sides.

    Parameters
    ----------
    outline : (N, 2), y up
    least_step : float
        Nothing of it is finer than this.

    Raises
    ------
    NoObject
        They are not alike.
    """
    found = symmetry_of(outline)
    if not found.of_revolution:
        raise NoObject(
            f"the object's two sides differ by {100.0 * found.mismatch:.0f} % of its area, too "
            "much for --symmetric; try --rotate auto too, or leave --symmetric away"
        )
    step = max(least_step, float(np.ptp(outline, axis=0).max()) / _MEAN_STEPS)
    return mirrored_mean(outline, found.axis_x_mm, step)


def changed(points: FloatArray, turn_deg: float, symmetric: bool) -> FloatArray:
    """Turn a drawing, (N, 2) mm, about its origin, and take the mean of its sides where asked."""
    points = turned(points, turn_deg) if turn_deg else points
    return averaged(points) if symmetric else points


def _symmetric(silhouette: Silhouette) -> Silhouette:
    cut = sorted(silhouette.touches - {"bottom"})
    if cut:
        raise NoObject(
            f"the object runs out of the frame ({', '.join(cut)}), so --symmetric has no two "
            "sides to average"
        )
    mean = averaged(_y_up(silhouette.contour_px), least_step=1.0)
    return replace(silhouette, contour_px=_y_up(mean))


# --- what to say ----------------------------------------------------------------------------


def _notes(silhouette: Silhouette, scale: Scale, look: Look) -> Iterator[str]:
    if look.mask is not None and silhouette.confidence < _UNFIT:
        yield "the mask's edge follows nothing that is seen in the picture: look at overlay.png"
    elif look.mask is None and silhouette.confidence < _UNDOUBTED:
        yield (
            f"the silhouette is sure to {100.0 * silhouette.confidence:.0f} % only: look at it in "
            "overlay.png; --box, --point or --mask say where the object is"
        )
    error = scale.measured_error
    if error is not None and error > _INEXACT:
        surer = "from farther off" if scale.source == "sheet" else "with --camera-distance"
        yield (
            f"the scale from the {scale.source} may be {100.0 * error:.1f} % off: it is surer "
            f"{surer}, and --height or --width settle it"
        )
    if look.rotate == 0.0:
        yield from _lean(silhouette)


def _box_note(box: Box | None, silhouette: Silhouette) -> Iterator[str]:
    if box is None:
        return
    x, y = silhouette.contour_px.T
    left, top, w, h = box
    off = np.abs(np.stack([x - left, x - left - w, y - top, y - top - h])).min(axis=0)
    if np.mean(off < _ALONG_PX) > _ALONG_SHARE:
        yield "the silhouette runs along --box, which may cut the object: look at overlay.png"


def _lean(silhouette: Silhouette) -> Iterator[str]:
    outline = _y_up(silhouette.contour_px)
    found = upright_of(outline)
    if found.mismatch > 0.5 * LARGEST_MISMATCH or abs(found.turn_deg) < _LEANING_DEG:
        return
    if found.mismatch < _LEANING_SHARE * symmetry_of(outline).mismatch:
        yield (
            f"the object stands {abs(found.turn_deg):.0f} deg off upright: --rotate auto turns it"
        )
