"""A picture, the silhouette in it, and its scale."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from profiletool.records.units import FloatArray


@dataclass(frozen=True)
class Picture:
    """A decoded picture, upright.

    Attributes
    ----------
    rgb : (H, W, 3) uint8
    alpha : (H, W) uint8, or None
        None where the file has no alpha channel, or one that is opaque everywhere.
    mm_per_px : float or None
        The resolution stored in the file, where it means something.
    format : str
        As Pillow names it: "PNG", "JPEG", ...
    focal_px : float or None
        Focal length in pixels, where the file tells its 35 mm equivalent; some per cent off.
    notes : tuple of str
        What the user should know of how the file was read.
    """

    rgb: NDArray[np.uint8]
    alpha: NDArray[np.uint8] | None
    mm_per_px: float | None
    format: str
    focal_px: float | None = None
    notes: tuple[str, ...] = ()

    @property
    def middle(self) -> FloatArray:
        """Its middle in the picture frame, (2,) px."""
        return np.asarray(0.5 * (np.array(self.rgb.shape[1::-1], float) - 1.0))


@dataclass(frozen=True)
class Silhouette:
    """The outline of the one object in a picture.

    Attributes
    ----------
    contour_px : (N, 2)
        Closed polygon (first point not repeated) in the picture frame, sub-pixel, ordered so
        that it runs counter-clockwise as seen (down the left side).
    mask : (H, W) bool
        The object, holes filled.
    method : str
        What found it: "alpha matte", "plain ground", "grabcut", ..., or the user's own "mask".
    noise_px : float
        Standard deviation of the contour's position, normal to itself.
    touches : frozenset of {"left", "right", "top", "bottom"}
        The edges of the frame that the object runs into.
    confidence : float
        How far the mask deserves to be believed, 0 to 1; a matte is believed wholly.
    held : bool
        Whether a hand seems to hide part of the object.
    doubt : str
        What of it may be a shadow, a reflection or a neighbour; empty where nothing is.
    """

    contour_px: FloatArray
    mask: NDArray[np.bool_]
    method: str
    noise_px: float
    touches: frozenset[str]
    confidence: float = 1.0
    held: bool = False
    doubt: str = ""


@dataclass(frozen=True)
class Scale:
    """Millimetres per pixel, and where that number comes from.

    Attributes
    ----------
    mm_per_px : float
    source : str
    error_share : float or None
        By how much of itself the number may be off, about two standard deviations; None where
        nothing is known of it.
    round_mm : float or None
        Thickness of the round body that the object was taken for; None where that did not matter.
    flat_share : float
        By how much of itself a flat object is larger.
    """

    mm_per_px: float
    source: Literal["height", "width", "mm-per-px", "marker", "sheet", "resolution", "vector"]
    error_share: float | None = None
    round_mm: float | None = None
    flat_share: float = 0.0

    @property
    def measured_error(self) -> float | None:
        """``error_share`` of a scale that the picture tells; None where the user answers for it."""
        return self.error_share if self.source in ("marker", "sheet") else None
