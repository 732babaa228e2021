"""The object in a picture as a design takes it: found, turned upright, measured."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from profiletool.errors import NoObject
from profiletool.image.find.hint import Hint, check_hint
from profiletool.image.find.silhouette import find_silhouette
from profiletool.image.load import load_mask
from profiletool.image.scale import markers_for, scale_of
from profiletool.image.sheet.rectify import Rectified, edge_warnings, rectify
from profiletool.profile.symmetry import LARGEST_MISMATCH, mirrored_mean, symmetry_of
from profiletool.profile.upright import turned, turned_px, upright_of, y_up
from profiletool.records.picture import Picture, Scale, Silhouette
from profiletool.records.request import Box, Look, ScaleRequest
from profiletool.records.units import FloatArray
from profiletool.subject.sheet import distance_note, find_on_sheet, measure_on_sheet, told, unsized

_MEAN_STEPS = 600  # of an outline's longer side, in which its two sides are averaged
_LEANING_DEG, _LEANING_SHARE = 3.0, 0.5  # a lean that is told, and what upright then gains
_ALONG_PX, _ALONG_SHARE = 1.5, 0.05  # of a contour along a box: what a box may cut
_INEXACT = 0.02  # of a scale: an error that is told
_UNDOUBTED, _UNFIT = 0.8, 0.1  # confidences: one that needs no word, one of a wrong mask
_OUTWARD = {"left": (-1.0, 0.0), "right": (1.0, 0.0), "top": (0.0, 1.0), "bottom": (0.0, -1.0)}
_FACES = np.cos(np.radians(67.5))  # of a frame's edge once turned: what still counts as a side


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


def see(picture: Picture, asked: ScaleRequest, look: Look, say: Callable[[str], None]) -> Seen:
    """Find the object in a picture, its way up and its size.

    Raises
    ------
    UnreadableInput, UsageError, NoScale, NoObject
    Unsure
        Its candidates are masks of the photograph, which it carries too.
    """
    hint = _hint(look, picture)
    sheet = rectify(picture)
    if sheet is not None:
        say(told(sheet))
    silhouette = _found(picture, sheet, hint, asked)
    frontal = picture if sheet is None else sheet.picture
    notes = (
        [*_box_note(look.box, silhouette)]
        if sheet is None
        else [*sheet.warnings, *edge_warnings(sheet, silhouette), *distance_note(sheet, asked)]
    )
    scale = None
    if sheet is not None and unsized(asked):
        silhouette, scale = measure_on_sheet(sheet, silhouette, asked, look.flat)
    turn = turn_of(y_up(silhouette.contour_px), look.rotate)
    if look.rotate == "auto" and turn:
        say(f"turned upright by {turn:.1f} deg counter-clockwise; `rotate` DEG turns it otherwise")
    upright = _upright(silhouette, turn, frontal.middle)
    if look.symmetric:
        upright = _symmetric(upright)
    if scale is None:
        scale = scale_of(frontal, upright, asked, look.flat)
    if sheet is not None:
        upright = replace(upright, mask=sheet.photo_mask_of(upright.mask))
    notes += _notes(upright, scale, look)
    return Seen(frontal, upright, scale, turn, tuple(notes))


# --- finding it -----------------------------------------------------------------------------


def _hint(look: Look, picture: Picture) -> Hint:
    shape = picture.rgb.shape[:2]
    mask = None if look.mask is None else load_mask(look.mask, shape)
    hint = Hint(look.box, look.point, mask, look.candidate)
    check_hint(hint, shape)
    return hint


def _found(
    picture: Picture, sheet: Rectified | None, hint: Hint, asked: ScaleRequest
) -> Silhouette:
    if sheet is None:
        return find_silhouette(picture, markers_for(picture, asked), hint)
    return find_on_sheet(picture, sheet, hint, asked)


# --- turning it -----------------------------------------------------------------------------


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
            f"{100.0 * found.mismatch:.0f} % of its area at best; say by how much, `rotate` DEG"
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
    contour = turned_px(silhouette.contour_px, rotated_deg, middle)
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
            "much for `symmetric`; try `rotate` auto too, or leave `symmetric` away"
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
            f"the object runs out of the frame ({', '.join(cut)}), so `symmetric` has no two "
            "sides to average"
        )
    mean = averaged(y_up(silhouette.contour_px), least_step=1.0)
    return replace(silhouette, contour_px=y_up(mean))


# --- what to say ----------------------------------------------------------------------------


def _notes(silhouette: Silhouette, scale: Scale, look: Look) -> Iterator[str]:
    if look.mask is not None and silhouette.confidence < _UNFIT:
        yield "the mask's edge follows nothing that is seen in the picture: look at overlay.png"
    elif look.mask is None and silhouette.confidence < _UNDOUBTED:
        yield (
            f"the silhouette is sure to {100.0 * silhouette.confidence:.0f} % only: look at it in "
            "overlay.png; `box`, `point` or `mask` say where the object is"
        )
    if silhouette.doubt:
        yield silhouette.doubt
    if silhouette.held:
        yield "a hand seems to hide part of the object: look at its outline in overlay.png"
    error = scale.measured_error
    if error is not None and error > _INEXACT:
        surer = "from farther off" if scale.source == "sheet" else "with `camera_distance_mm`"
        yield (
            f"the scale from the {scale.source} may be {100.0 * error:.1f} % off: it is surer "
            f"{surer}, and `height_mm` or `width_mm` settle it"
        )
    if scale.round_mm is not None:
        yield (
            f"the object was taken for a round one, {scale.round_mm:.0f} mm thick: if it is flat, "
            f"it is {100.0 * scale.flat_share:.1f} % larger, which `flat` says"
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
        yield "the silhouette runs along `box`, which may cut the object: look at overlay.png"


def _lean(silhouette: Silhouette) -> Iterator[str]:
    outline = y_up(silhouette.contour_px)
    found = upright_of(outline)
    if found.mismatch > 0.5 * LARGEST_MISMATCH or abs(found.turn_deg) < _LEANING_DEG:
        return
    if found.mismatch < _LEANING_SHARE * symmetry_of(outline).mismatch:
        yield (
            f"the object stands {abs(found.turn_deg):.0f} deg off upright: `rotate` auto turns it"
        )
