"""An object on the printed sheet: found, and measured, as the photograph's user speaks of it."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from profiletool.errors import NoScale, Unsure, UsageError
from profiletool.image.find.hint import LEAST_PX, Hint
from profiletool.image.find.silhouette import find_silhouette
from profiletool.image.marker import find_markers
from profiletool.image.scale import marker_scale
from profiletool.image.sheet.measure import measure
from profiletool.image.sheet.rectify import Rectified
from profiletool.profile.symmetry import LARGEST_MISMATCH
from profiletool.profile.upright import turned_px, upright_of, y_up
from profiletool.records.picture import Picture, Scale, Silhouette
from profiletool.records.request import ScaleRequest

_ROUND_MISMATCH = 0.012  # of a body of revolution's section, which noise and blur make
_DISTANT = 0.1  # share by which a measured distance may be off what the sheet shows


def told(sheet: Rectified) -> str:
    """Say how the sheet is seen."""
    return (
        f"sheet: {sheet.board}, {sheet.corners_seen} of {sheet.corners_total} corners within "
        f"{sheet.reprojection_px:.2f} px, camera {sheet.distance_mm:.0f} mm away at a slant of "
        f"{sheet.tilt_deg:.0f} deg"
    )


def distance_note(sheet: Rectified, asked: ScaleRequest) -> Iterator[str]:
    """Say where a measured distance is not what the sheet shows."""
    given, seen = asked.camera_distance_mm, sheet.camera
    if given is None or not unsized(asked):
        return
    if abs(given / seen.height_mm - 1.0) > max(_DISTANT, 3.0 * seen.height_share):
        yield (
            f"`camera_distance_mm` is {given:g} mm, which was used; the sheet shows the camera "
            f"about {seen.height_mm:.0f} mm above it"
        )


def unsized(asked: ScaleRequest) -> bool:
    """Whether the object's own size is not given."""
    return asked.height_mm is None and asked.width_mm is None


def find_on_sheet(
    picture: Picture, sheet: Rectified, hint: Hint, asked: ScaleRequest
) -> Silhouette:
    """Find the object in the frontal view; ``hint`` is for the photograph.

    Raises
    ------
    NoObject, NoScale
    Unsure
        Its candidates are masks of the photograph.
    UsageError
        A hint lies outside the sheet, or a scale is given that the sheet tells.
    """
    if asked.mm_per_px is not None and unsized(asked):
        raise UsageError(
            "the picture shows a printed sheet, which tells its scale: leave `mm_per_px` away, or "
            "crop the sheet out"
        )
    markers = find_markers(sheet.plain) if asked.marker_mm is not None else []
    if asked.marker_mm is not None and not markers and unsized(asked):
        raise NoScale(
            "no ArUco DICT_4X4_50 marker lies in the printed sheet's field; leave `marker_mm` "
            "away: the sheet tells the scale"
        )
    try:
        return find_silhouette(sheet.plain, markers, _frontal_hint(hint, sheet))
    except Unsure as unsure:
        masks = [(sheet.photo_mask_of(mask), c, how) for mask, c, how in unsure.candidates]
        raise Unsure(str(unsure), tuple(masks), picture.rgb) from None


def measure_on_sheet(
    sheet: Rectified, silhouette: Silhouette, asked: ScaleRequest, flat: bool = False
) -> tuple[Silhouette, Scale]:
    """Measure an object whatever its way up: with its axis upright, then turned back.

    A marker in the sheet's field sets the size of its print right.

    Raises
    ------
    NoScale, UsageError
        As `measure`.
    """
    distance_mm = asked.camera_distance_mm
    middle = sheet.picture.middle
    turn = upright_of(y_up(silhouette.contour_px)).turn_deg
    foot = turned_px(np.array(sheet.camera.foot_px), turn, middle)
    camera = replace(sheet.camera, foot_px=(float(foot[0]), float(foot[1])))
    stands = replace(silhouette, contour_px=turned_px(silhouette.contour_px, turn, middle))
    turned_sheet = replace(sheet, camera=camera)
    made = measure(turned_sheet, stands, distance_mm, flat=flat)
    # A slanting view spoils the symmetry of what is seen, not that of a round body's section.
    mismatch = upright_of(y_up(made.silhouette.contour_px)).mismatch if made.round else 1.0
    if made.round and mismatch > LARGEST_MISMATCH:
        made = measure(turned_sheet, stands, distance_mm, revolved=False)
    contour = turned_px(made.silhouette.contour_px, -turn, middle)
    scale = made.scale
    if mismatch > _ROUND_MISMATCH and not flat:  # hardly a round body: its thickness is anyone's
        share = math.hypot(made.measured_share, max(made.shape_share, scale.flat_share))
        scale = replace(scale, error_share=share)
    if asked.marker_mm is not None:
        printed = marker_scale(sheet.picture, asked.marker_mm)
        share = math.hypot(printed.error_share or 0.0, scale.error_share or 0.0)
        size = printed.mm_per_px / (sheet.picture.mm_per_px or 1.0)
        scale = replace(scale, mm_per_px=size * scale.mm_per_px, source="marker", error_share=share)
    return replace(silhouette, contour_px=contour), scale


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
            raise UsageError("`point` lies outside the printed sheet; give a point on it")
        point = x, y
    if hint.box is not None:
        left, top, w, h = hint.box
        corners = np.array(
            [[left, top], [left + w, top], [left + w, top + h], [left, top + h]], float
        )
        there = np.clip(sheet.frontal_of(corners), 0.0, size)
        low, high = there.min(axis=0), there.max(axis=0)
        if min(high - low) < LEAST_PX:
            raise UsageError("`box` lies outside the printed sheet; the object must lie on it")
        box = (*low.tolist(), *(high - low).tolist())
    mask = None if hint.mask is None else sheet.mask_of(hint.mask)
    if mask is not None and not mask.any():
        raise UsageError("the mask lies outside the printed sheet; the object must lie on it")
    return Hint(box, point, mask, hint.candidate)
