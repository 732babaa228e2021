"""A drawn profile as a design takes it: sized, turned, and judged for what its size can be."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from profiletool.errors import NoObject, NoScale, UsageError
from profiletool.profile.target import Reach, profile_of_line, profile_of_object
from profiletool.records.picture import Scale
from profiletool.records.profile import DrawnLine, DrawnUnit, Profile
from profiletool.records.request import Look, ScaleRequest
from profiletool.records.units import FloatArray
from profiletool.subject.photo import changed, turn_of

_SIZES_MM = (10.0, 1000.0)  # of what a tube can follow: beyond, the unit must be wrong
_APART = 0.02  # share by which sizes differ that cannot both be right


@dataclass(frozen=True)
class SeenLine:
    """A drawn line, (N, 2) mm, y up, turned as asked, with its scale.

    ``scale`` is the millimetres of each millimetre that the drawing's own unit gives.
    """

    points: FloatArray
    closed: bool
    scale: Scale
    rotated_deg: float
    unit: DrawnUnit
    notes: tuple[str, ...]

    def profile(self, reach: Reach) -> Profile:
        """Give the profile that a tube follows.

        Raises
        ------
        NoObject
            There is none; where the file's unit may be why, the message names it.
        """
        make = profile_of_object if self.closed else profile_of_line
        try:
            return make(self.points, reach)
        except NoObject as error:
            if self.scale.source != "vector" or not self.unit.source:
                raise
            raise NoObject(f"{error} ({self.unit.source}; `height_mm` overrides it)") from None

    def told(self, profile: Profile) -> str:
        """Say what is followed of it."""
        kind = "closed outline" if self.closed else "open profile"
        width, height = np.ptp(self.points, axis=0)
        x, y = profile.points[0]
        return (
            f"drawing: {kind}, {width:.1f} x {height:.1f} mm, {profile.length_mm:.1f} mm to follow "
            f"from ({x:.1f}, {y:.1f}) down"
        )


def see_drawing(drawn: DrawnLine, asked: ScaleRequest, look: Look) -> SeenLine:
    """Turn a drawing as asked and settle its size: the user's, else the file's.

    Raises
    ------
    NoScale
        The file has no size, or one that no object has by its unit, and none is given.
    NoObject, UsageError
        It cannot be turned or averaged as asked.
    """
    if not drawn.closed and (look.rotate == "auto" or look.symmetric):
        raise UsageError("`rotate` auto and `symmetric` need an object; this is an open profile")
    turn = turn_of(drawn.points, look.rotate)
    points = changed(drawn.points, turn, look.symmetric)
    size = np.ptp(points, axis=0)
    scale = _scale(size, drawn.unit, asked)
    size = size * scale.mm_per_px
    if scale.source == "vector":
        _check_size(size, drawn.unit)
    own = drawn.notes
    if abs(scale.mm_per_px - 1.0) > _APART:
        own = tuple(f"{note} (as the drawing's own unit has it)" for note in own)
    notes = (*own, *_contradictions(size, scale, drawn.unit, asked))
    if scale.source == "vector" and drawn.unit.assumed:
        notes = (f"{drawn.unit.source}; `height_mm` or `width_mm` settle it", *notes)
    return SeenLine(points * scale.mm_per_px, drawn.closed, scale, turn, drawn.unit, notes)


def _scale(size: FloatArray, unit: DrawnUnit, asked: ScaleRequest) -> Scale:
    width, height = (float(side) for side in size)
    if asked.height_mm is not None and height > 0.0:
        return Scale(asked.height_mm / height, "height")
    if asked.width_mm is not None and width > 0.0:
        return Scale(asked.width_mm / width, "width")
    if asked.mm_per_px is not None:
        return Scale(asked.mm_per_px / unit.mm, "mm-per-px")
    if not unit.sized:
        raise NoScale(f"{unit.source}; give `height_mm` or `width_mm` of what is drawn")
    return Scale(1.0, "vector")


def _check_size(size: FloatArray, unit: DrawnUnit) -> None:
    """Refuse a size that must be a wrong unit's."""
    if unit.source and not _SIZES_MM[0] <= float(size.max()) <= _SIZES_MM[1]:
        width, height = size
        raise NoScale(
            f"{unit.source}, which makes the profile {width:.4g} x {height:.4g} mm; give its "
            "`height_mm` or `width_mm`, or the millimetres of a unit as `mm_per_px`"
        )


def sides_apart(width_mm: float, asked: ScaleRequest) -> Iterator[str]:
    """Say where a width that is given does not fit the one that the height gives."""
    height, width = asked.height_mm, asked.width_mm
    if height is not None and width is not None and abs(width / width_mm - 1.0) > _APART:
        yield (
            f"`width_mm` is {width:g} mm, but at a `height_mm` of {height:g} mm the object is "
            f"{width_mm:.1f} mm wide: the height was taken"
        )


def _contradictions(
    size: FloatArray, scale: Scale, unit: DrawnUnit, asked: ScaleRequest
) -> Iterator[str]:
    """Say where what is given does not fit what is drawn."""
    width, height = size
    yield from sides_apart(float(width), asked)
    doubted = unit.assumed or not unit.sized
    if scale.source != "vector" and not doubted and abs(scale.mm_per_px - 1.0) > _APART:
        own, given = size / scale.mm_per_px, scale.source
        yield (
            f"the drawing itself is {own[0]:.4g} x {own[1]:.4g} mm: the {given} that is given "
            f"makes it {width:.1f} x {height:.1f} mm"
        )
