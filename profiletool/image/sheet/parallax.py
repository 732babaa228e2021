"""Parallax of what stands above the sheet: its size, and what of it stays unknown.

Frames: plan coordinates in mm on the sheet, as in the picture x to the right, y down; heights
count up from the sheet. The camera stands at height H over its foot.

What lies in a plane at height t is seen on the sheet larger by H/(H - t), about the foot: a
similarity, whatever the camera's tilt. A body of revolution that lies on the sheet has its axis
at the height t of its largest radius. Seen straight on, the sheet, the two tangents from the
camera and the circle of that radius make a triangle with its incircle, so that the half width R
seen on the sheet belongs to

    t = R (sqrt(1 + (R/H)^2) - R/H),        from R = t / sqrt(1 - 2 t/H).

Scaled by (H - t)/H the width is still too large by 1/sqrt(1 - (t/(H - t))^2), since the tangents
touch the body above its axis; a sphere is the same in both directions.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

SHAPE_SHARE = 0.3  # by which t may be off: an unknown object need not be round
LARGEST_SHARE = 1.0 / 3.0  # of the camera's height that an object's axis may have
PRINT_SHARE = 0.002  # a printer's own error, and paper that does not lie quite flat
USUAL_FOCAL = 0.85  # of the longer side, where the file does not tell it
DISTANCE_SHARE = 0.02  # of a camera's distance that was measured, one standard deviation


@dataclass(frozen=True)
class Camera:
    """Where the camera stood.

    Attributes
    ----------
    foot_px : (x, y)
        The place on the sheet straight below it, in the frontal picture.
    height_mm : float
        Its lens's height above the sheet.
    height_share : float
        Standard deviation of that, relative.
    """

    foot_px: tuple[float, float]
    height_mm: float
    height_share: float = DISTANCE_SHARE


def axis_height(half_width_mm: float, distance_mm: float) -> float:
    """Radius of a lying body of revolution from its half width on the sheet, mm.

    For a sphere or a cylinder straight below the camera at ``distance_mm`` from the sheet.
    """
    ratio = half_width_mm / distance_mm
    return half_width_mm / (math.sqrt(1.0 + ratio**2) + ratio)


def shrinkage(t_mm: float, distance_mm: float) -> float:
    """Give (H - t)/H, by which a scale on the sheet is made one at the height t."""
    return (distance_mm - t_mm) / distance_mm


@dataclass(frozen=True)
class Remaining:
    """Relative errors that a scale keeps after `shrinkage`, about two standard deviations.

    Attributes
    ----------
    distance : float
        From the camera's distance.
    shape : float
        From what is not known of the object: how thick it is, and how round.
    """

    distance: float
    shape: float


def remaining(t_mm: float, camera: Camera, aside_mm: float, section: bool) -> Remaining:
    """Tell what stays uncertain of a size at the height t.

    Parameters
    ----------
    t_mm : float
        The height that was taken; 30 % of it may be wrong.
    camera : Camera
    aside_mm : float
        From the camera's foot to the object's middle.
    section : bool
        Whether the outline was made that of a body of revolution. If not, its roundness stays in
        the outline: 1/sqrt(1 - (t/(H - t))^2), and 1/cos of the angle that it is seen at.
    """
    depth = camera.height_mm - t_mm
    above = t_mm / depth
    roundness = 1.0 / math.sqrt(max(1e-3, 1.0 - above**2)) - 1.0
    slant = math.hypot(1.0, aside_mm / depth) - 1.0
    share = SHAPE_SHARE if section else 1.0
    return Remaining(
        2.0 * camera.height_share * above,
        math.hypot(SHAPE_SHARE * above, share * roundness, share * slant),
    )
