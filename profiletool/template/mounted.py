"""A tube mounted beside its object: clamp, palm and fingers, and what the bench must know."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import shapely

from profiletool.profile.side import top_middle
from profiletool.profile.symmetry import Symmetry, symmetry_of
from profiletool.records.design import Design
from profiletool.records.frames import Shape
from profiletool.records.profile import Profile
from profiletool.records.units import FloatArray
from profiletool.template.fingers import clamped, in_object, obstacle, palm_of, start_for
from profiletool.template.palm import ClampedTube, Palm

PLATE_MM = 5.0  # the palm is drawn so thick; whatever is stiff will do
_INCLINED_DEG = 0.5  # clamps less inclined than this lie on the palm
_BRACKET_DEG = 60.0  # from here on no wedge
_OVERLAP_MM2 = 1.0  # what shapes that only touch may share
_FINGERS = 3


@dataclass(frozen=True)
class Mounted:
    """What the drawing shows: a design, its tube at rest and under pressure, clamp and palm.

    ``symmetry`` is the outline's, where there is one; ``stretch_pct`` where the profile starts and
    ends on its side, %.
    """

    design: Design
    profile: Profile
    straight: Shape
    bent: Shape
    symmetry: Symmetry | None
    clamp: ClampedTube
    palm: Palm
    stretch_pct: tuple[float, float] = (0.0, 100.0)

    @property
    def datum(self) -> FloatArray:
        """What the base is measured from, (2,): the object's top middle, or the profile's top."""
        outline = self.profile.outline
        return self.profile.points[0] if outline is None else top_middle(outline)

    @property
    def body(self) -> FloatArray:
        """The object's outline, or the profile that was drawn instead, (N, 2)."""
        outline = self.profile.outline
        return self.profile.points if outline is None else outline


def mounted_of(
    design: Design,
    profile: Profile,
    straight: Shape,
    bent: Shape,
    stretch_pct: tuple[float, float] = (0.0, 100.0),
) -> Mounted:
    """Mount a tube, and as many fingers on one palm as find room.

    Parameters
    ----------
    design : Design
    profile : Profile
        The target, with the object's outline where there is one.
    straight, bent : Shape
        The tube at rest and under pressure, object frame.
    stretch_pct : (float, float)
        Where the profile starts and ends on its side, %.
    """
    clamp = clamped(design.base_pose, design, -profile.sign)
    outline = profile.outline
    symmetry = None if outline is None else symmetry_of(outline)
    palm = palm_of(clamp, outline, symmetry)
    return Mounted(design, profile, straight, bent, symmetry, clamp, palm, stretch_pct)


def plates_of(palm: Palm) -> tuple[FloatArray, ...]:
    """Return the palm in the side view, (4, 2) mm; in two pieces where it has an opening."""
    (low, high), hole = palm.reach_mm, palm.opening_mm
    spans = ((low, -hole), (hole, high)) if hole else ((low, high),)
    return tuple(
        np.array([palm.at(*p) for p in ((a, 0.0), (b, 0.0), (b, PLATE_MM), (a, PLATE_MM))])
        for a, b in spans
    )


def mounting_warnings(mounted: Mounted) -> Iterator[str]:
    """Say what needs the bench's attention, fields in backticks."""
    clamp, palm, outline = mounted.clamp, mounted.palm, mounted.profile.outline
    symmetry = mounted.symmetry
    round_body = symmetry is not None and symmetry.of_revolution
    if outline is not None and symmetry is not None and round_body and palm.fingers < _FINGERS:
        yield _fewer_fingers(mounted, outline, symmetry.axis_x_mm)
    if outline is not None and in_object(clamp, outline):
        yield "the object is in the way of the clamp: start elsewhere with `start_pct`"
    slope = abs(clamp.slope_deg)
    if palm.fingers > 1 and slope >= _INCLINED_DEG:
        how = "a wedge of that angle" if slope < _BRACKET_DEG else "an angle bracket"
        yield (
            f"the clamps are inclined {slope:.1f}° to the palm: set each on {how}; the plan shows "
            "them projected"
        )
    if palm.fitting_mm is not None:
        yield f"air fittings run into the palm: bore for them at r = {palm.fitting_mm:.1f} mm"
    if palm.fittings_meet:
        yield "air fittings meet at the axis: take elbows, up through the palm"
    if _in_the_way(mounted):
        yield "the tube under pressure runs into the palm: cut the palm away there"


def _fewer_fingers(mounted: Mounted, outline: FloatArray, axis: float) -> str:
    """Say why there are no three fingers, and where to start for them."""
    why = obstacle(mounted.clamp, axis, _FINGERS, outline)
    laid = "one is" if mounted.palm.fingers == 1 else "two opposite ones are"
    start = start_for(_FINGERS, mounted.design, mounted.profile, axis, mounted.stretch_pct)
    help_ = (
        "no start farther down has room for three of this tube (`outer_diameter_mm`)"
        if start is None
        else f"three find room with `start_pct` {start}"
    )
    return f"three fingers cannot share a palm: {why}; {laid} laid out; {help_}"


def _in_the_way(mounted: Mounted) -> bool:
    """Tell whether the tube under pressure needs room where the palm is."""
    bent = mounted.bent
    tube = shapely.Polygon(np.concatenate([bent.facing, bent.far[::-1]])).buffer(0.0)
    plates = map(shapely.Polygon, plates_of(mounted.palm))
    return any(tube.intersection(plate).area > _OVERLAP_MM2 for plate in plates)
