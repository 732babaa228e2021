"""Whether an object may be taken for a body of revolution: how well its outline mirrors itself."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from shapely import affinity

from profiletool.records import FloatArray

# Bulbs, bottles, vases and pears as photographed differ from their mirror images by up to 6 % of
# their area, what has a handle by 20 % and more. At 10 % the two sides lie a twentieth of the
# width apart, which a hand that centres itself on the object forgives.
LARGEST_MISMATCH = 0.10
_GOLDEN = 0.5 * (np.sqrt(5.0) - 1.0)
_AXIS_SHARE = 1e-4  # of the width: how closely the axis is found
_COARSE_SHARE = 5e-4  # of the width: what the outline may be thinned by


@dataclass(frozen=True)
class Symmetry:
    """How well an outline mirrors itself about an upright axis.

    Attributes
    ----------
    axis_x_mm : float
        Where the axis stands that leaves the least mismatch, mm, object frame.
    mismatch : float
        Area that the outline and its mirror image do not share, over the outline's area; 0 for
        a perfect mirror image, 2 for none at all.
    """

    axis_x_mm: float
    mismatch: float

    @property
    def of_revolution(self) -> bool:
        """Whether the object may be taken for a body of revolution."""
        return self.mismatch <= LARGEST_MISMATCH


def symmetry_of(outline: FloatArray) -> Symmetry:
    """Find the upright axis about which an outline mirrors itself best.

    Parameters
    ----------
    outline : (N, 2) array, mm, closed, first point not repeated

    Returns
    -------
    Symmetry

    Raises
    ------
    ValueError
        The outline encloses no area.
    """
    width = float(np.ptp(outline[:, 0]))
    body = shapely.Polygon(outline).buffer(0.0).simplify(_COARSE_SHARE * width)
    if not body.area > 0.0:
        raise ValueError("an outline without area has no axis")
    shapely.prepare(body)
    middle = 0.5 * (outline[:, 0].min() + outline[:, 0].max())

    def mismatch(axis: float) -> float:
        mirrored = affinity.scale(body, xfact=-1.0, origin=(axis, 0.0))
        return 2.0 * float(1.0 - body.intersection(mirrored).area / body.area)

    # Each level stretch of the body adds a share that grows with the axis' distance from its
    # middle: one valley, which the golden section cannot miss.
    low, high = middle - 0.25 * width, middle + 0.25 * width
    while high - low > _AXIS_SHARE * width:
        a, b = high - _GOLDEN * (high - low), low + _GOLDEN * (high - low)
        low, high = (low, b) if mismatch(a) <= mismatch(b) else (a, high)
    axis = 0.5 * (low + high)
    return Symmetry(axis, mismatch(axis))
